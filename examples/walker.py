# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamplighter made of its PNGs, hung together, posed and filled in by the add-on's operators; a film."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector
from PIL import Image

import attached
import contact_sheet
import cutout
import film
import mouse
import night
import planar_native
import puppet
import walk
from contact_sheet import View
from planar_deform import compat
from walk import LIMBS, Moment

NAME = "Lamplighter"
SPACING = 0.085
PIXELS = 170.0  # of the drawings, for a unit
STEPS = 4
APART = 4  # frames from one keyed pose to the next
LAST = 1 + APART * len(walk.NAMES) * STEPS
STRIDE = len(walk.NAMES) * 2  # poses after which the walk repeats itself
VIEW = View.around(1.55, -0.38, 4.7, 704, 416)
STRIP = 2  # frames from one picture of the strip to the next
STANDING = ("Near Heel", "Near Toe", "Far Heel", "Far Toe")
# The cap's tip: what it swings about, as drawn, and by how many degrees in each pose of a step.
BEND, SWING = (-0.10, 3.42), (8.0, -14.0, -7.0, 12.0)
GLOW = 1.25  # half as wide as the light
CELL = View.around(-0.1, -0.3, 4.5, 290, 330)  # of the pictures, about where the walker is
GROUND = (196, 190, 214)
SMALL = 48.0  # pixels for a unit of what shows the layers

Cell = tuple[str, str, Image.Image]  # label, note, picture


def perform(with_pictures: bool) -> list[list[Cell]]:
    """Builds, poses and fills in the walker in a scene of its own, which becomes the context's.

    Prints figures. Gives rows of pictures of it on the way, if wished: its layers, and the poses of a step.
    """
    scene = bpy.data.scenes.new("Walk")
    bpy.context.window.scene = scene
    contact_sheet.prepare_scene(scene)
    scene.frame_start, scene.frame_end, scene.render.fps = 1, LAST, film.FPS
    start = time.perf_counter()
    obj = build()
    made = time.perf_counter()
    rows = [_layers(), [("Attached, with pins", "", _picture(obj, 0.0))]] if with_pictures else []
    plan = walk.moments(STEPS)
    drags = _key(obj, plan)
    keyed = time.perf_counter()
    bpy.ops.planar.generate_inbetweens()
    filled = time.perf_counter()
    _swing(obj, plan)
    if with_pictures:
        for number, moment in enumerate(plan[: len(walk.NAMES)]):
            scene.frame_set(1 + APART * number)
            rows[1].append((moment.name[:-2], f"frame {scene.frame_current}", _picture(obj, moment.shift[0])))
    counts = [
        f"{len(obj.data.vertices)} vertices",
        f"{len(mouse.layers())} layers and a lantern",
        f"{len(_joints(obj))} joints",
    ]
    print(
        f"{NAME}: {', '.join(counts)}, {len(mouse.PINS)} pins; drawn, attached and pinned in "
        f"{made - start:.1f} s, {len(plan)} poses by {drags} drags in {keyed - made:.1f} s, filled in "
        f"{filled - keyed:.1f} s"
    )
    print(f"  {_figures(obj, plan)}")
    return rows


def _layers() -> list[Cell]:
    """The drawings, from back to front, each on all of the canvas."""
    drawings = [*mouse.layers(), mouse.lantern()]
    bounds, cells = cutout.canvas(drawings, SMALL), []
    for layer in drawings:
        painted = layer.paint(bounds, SMALL)
        sheet = Image.new("RGB", painted.size, GROUND)
        sheet.paste(painted, mask=painted.getchannel("A"))
        cells.append((layer.name, "", sheet))
    return cells


def _picture(obj: bpy.types.Object, x: float) -> Image.Image:
    """The walker with its pins and joints, where it has come to."""
    view = View(CELL.left + x, CELL.bottom, CELL.unit, CELL.width, CELL.height)
    return attached.picture(obj, _joints(obj), view, GROUND)


def build() -> bpy.types.Object:
    """The mouse of its layers, hung together and pinned, with the lantern in its hand; the active object."""
    layers, held = mouse.layers(), mouse.lantern()
    lantern = cutout.build(held.name, [held], SPACING, PIXELS)
    handle = Vector((mouse.HANDLE[0], held.depth, mouse.HANDLE[1]))
    lantern.data.transform(Matrix.Translation(-handle))
    lantern.location = handle
    obj = cutout.build(NAME, layers, SPACING, PIXELS)
    bpy.ops.planar.attach()
    lantern.select_set(True)
    bpy.ops.planar.attach_to()
    lantern.select_set(False)
    puppet.add_pins(obj, layers, mouse.PINS)
    _select(obj, ["Cap Tip"])
    bpy.ops.planar.set_depth(depth=2.0)  # before the ear, where it swings there
    return obj


def _key(obj: bpy.types.Object, plan: Sequence[Moment]) -> int:
    """Keys the poses, those of the first two steps by turning limbs, the others as copies; counts drags."""
    scene, drags = bpy.context.scene, 0
    before = Moment("Rest", np.zeros(2), dict.fromkeys((limb.name for limb in LIMBS), 0.0))
    for number, moment in enumerate(plan):
        repeated = number - STRIDE
        if repeated >= 1:
            scene.frame_set(1 + APART * repeated)
            bpy.ops.planar.copy_pose()
        scene.frame_set(1 + APART * number)
        if repeated >= 1:
            bpy.ops.planar.paste_pose()
            bpy.ops.planar.select_pins(action="ALL")
            bpy.ops.planar.drag_pins(offset=moment.shift - plan[repeated].shift)
            drags += 1
        else:
            drags += _turn(obj, before, moment)
        bpy.ops.planar.key_pose()
        obj.planar.poses[obj.planar.active_pose].name = moment.name
        before = moment
    return drags


def _turn(obj: bpy.types.Object, before: Moment, after: Moment) -> int:
    """Takes the drawing from a pose to the next: all of it first, then limb by limb; drags that it took."""
    bpy.ops.planar.select_pins(action="ALL")
    bpy.ops.planar.drag_pins(offset=after.shift - before.shift)
    drags, turns = 1, dict(before.turns)
    for limb in LIMBS:
        angle = after.turns[limb.name] - turns[limb.name]
        if abs(angle) < 1e-6:
            continue
        carried = _carried(limb.name)
        _select(obj, [pin for other in LIMBS if other.name in carried for pin in other.pins])
        x, z = walk.joints(after)[limb.name]  # what carries it has its turn already
        bpy.ops.planar.rotate_pins(angle=angle, pivot=obj.matrix_world @ Vector((x, 0.0, z)))
        turns |= {name: turns[name] + angle for name in carried}
        drags += 1
    return drags


def _carried(name: str) -> set[str]:
    """A limb and all that hang on it."""
    found = {name}
    for limb in LIMBS:
        if limb.parent in found:
            found.add(limb.name)
    return found


def _select(obj: bpy.types.Object, names: Iterable[str]) -> None:
    wanted = set(names)
    for pin in obj.planar.pins:
        pin.select = pin.name in wanted


def _swing(obj: bpy.types.Object, plan: Sequence[Moment]) -> None:
    """Lets the lantern swing in its hand, and the cap's tip follow an Empty that swings with the head."""
    _select(obj, ["Cap Tip"])
    bpy.context.scene.frame_set(1)
    bpy.ops.planar.add_controls()
    control, lantern = obj.planar.pins["Cap Tip"].follow, bpy.data.objects["Lantern"]
    pivot = bpy.data.objects.new("Cap", None)
    pivot.empty_display_size = 0.2
    bpy.context.scene.collection.objects.link(pivot)
    head = next(limb for limb in LIMBS if limb.name == "Head")
    arm = np.subtract(BEND, head.joint)  # to where the cap bends
    control.parent = pivot
    for number, moment in enumerate(plan):
        frame, turns = 1 + APART * number, moment.turns
        x, z = walk.joints(moment)["Head"] + walk.turned(arm, turns["Head"])
        pivot.location, pivot.rotation_euler.y = (x, 0.0, z), -turns["Head"]
        if number == 0:  # parented as the head is posed, without the swing
            control.matrix_parent_inverse = pivot.matrix_basis.inverted()
        pivot.rotation_euler.y -= np.radians(SWING[number % len(SWING)])
        lantern.rotation_euler.y = turns["Far Forearm"] - turns["Lantern"]
        pivot.keyframe_insert("location", frame=frame)
        for thing in (pivot, lantern):
            thing.keyframe_insert("rotation_euler", index=1, frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.context.view_layer.objects.active = obj


def _joints(obj: bpy.types.Object) -> list[str]:
    return [pin.group for pin in obj.planar.pins if pin.kind in {"HINGE", "WELD"}]


def _figures(obj: bpy.types.Object, plan: Sequence[Moment]) -> str:
    """How far planted pins slide, and how distorted frames are against the poses beside them, in words."""
    rest, faces = puppet.rest_points(obj), np.array([tuple(face.vertices) for face in obj.data.polygons])
    angles, flipped, places = [], 0, []
    for frame in range(1, LAST + 1):
        bpy.context.scene.frame_set(frame)
        measure = planar_native.distortion(rest, puppet.shown_points(obj), faces)
        angles.append(measure.angle)
        flipped = max(flipped, measure.flipped)
        places.append(puppet.pin_points(obj))
    stretches = [angles[start : start + APART + 1] for start in range(0, LAST - 1, APART)]
    worse = max(max(stretch) / max(stretch[0], stretch[-1]) for stretch in stretches)
    diagonal = np.hypot(*np.ptp(rest, axis=0))
    slides = [_slide(places, plan, pin) for pin in STANDING]
    return (
        f"planted heels and toes slide by up to {100 * max(slides) / diagonal:.4f} % of the diagonal; "
        f"angle distortion up to {max(angles):.4f}, of a frame at most {worse:.4f} times that of the worse "
        f"pose beside it; {flipped} flipped"
    )


def _slide(places: Sequence[Mapping[str, np.ndarray]], plan: Sequence[Moment], pin: str) -> float:
    """How far a pin is from where it was set down, at most, as long as it stands in the plan."""
    at = [walk.pin_places(moment)[pin] for moment in plan]
    slides, down = [0.0], None
    for number, (here, there) in enumerate(itertools.pairwise(at)):
        if np.hypot(*(here - there)) > 1e-6:
            down = None
            continue
        stretch = np.array([frame[pin] for frame in places[APART * number : APART * (number + 1) + 1]])
        down = stretch[0] if down is None else down
        slides.append(float(np.hypot(*(stretch - down).T).max()))
    return max(slides)


def shoot(path: Path) -> Image.Image:
    """Renders the walk through a street at dusk; a strip of its frames."""
    scene = bpy.context.scene
    paper = night.backdrop(VIEW)
    light = film.picture("Light", night.glow(), (-GLOW, -GLOW, GLOW, GLOW), 0.0)
    shade = film.picture("Shadow", night.shadow(), (-1.0, -0.16, 1.0, 0.16), 0.0)
    for thing in (film.picture_of(VIEW, "Street", paper), light, shade):
        scene.collection.objects.link(thing)
    light.parent, light.location = bpy.data.objects["Lantern"], (0.0, -0.5, -0.64)
    shade.location = (0.0, 0.5, 0.0)
    for frame in (1, LAST):
        shade.location.x = walk.moments(STEPS)[(frame - 1) // APART].shift[0] + 0.1
        shade.keyframe_insert("location", frame=frame)
    for curve in compat.curves_of(shade.animation_data):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    film.prepare(scene, VIEW)
    frames = film.shoot(scene, path, STRIP)
    stride = {frame: image for frame, image in frames.items() if frame <= 1 + APART * STRIDE}
    marks = {1 + APART * number: moment.name for number, moment in enumerate(walk.moments(STEPS))}
    return film.sheet("Two steps: keyed poses, and the frames between them", stride, marks, columns=6)
