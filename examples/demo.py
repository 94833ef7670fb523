# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws three characters, pins and poses them in Blender with the add-on's operators, and renders them.

One of them is posed by each method, to compare them. Poses are keyed on the timeline, the frames between them
are generated, and films of them are rendered: two act on a stage, the third, of seven layers, walks. Lattices
bend several objects and a model, and a surface is laid flat.

Run by `make demo`. Writes out/demo.blend, out/contact_sheet.png, the films out/demo.mp4 and out/walk.mp4, and
out/film_sheet.png and out/walk_sheet.png; with --pictures FOLDER also the docs' pictures.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
APART = 24  # frames from one keyed pose to the next
sys.path.insert(0, str(ROOT / "addon"))

import arcs  # noqa: E402
import attached  # noqa: E402
import carried  # noqa: E402
import comparison  # noqa: E402
import contact_sheet  # noqa: E402
import cutout  # noqa: E402
import depths  # noqa: E402
import dragon  # noqa: E402
import feet  # noqa: E402
import film  # noqa: E402
import fox  # noqa: E402
import hood  # noqa: E402
import lattices  # noqa: E402
import outline_sheet  # noqa: E402
import planar_deform  # noqa: E402
import planar_native  # noqa: E402
import puppet  # noqa: E402
import walker  # noqa: E402
from comparison import Trial  # noqa: E402
from contact_sheet import View  # noqa: E402
from drawing import Layer  # noqa: E402

Cell = tuple[str, str, Image.Image]  # label, note, picture
STAGE = View.around(8.9, -0.55, 6.1, 1056, 276)  # what the film shows; the codec wants even sides
SURFACE = 26.0  # where the one stands that is laid flat, out of the film
LATTICES = (13.9, 18.0)  # where those stand that lattices deform
SHEET_STEP = 4  # frames from one picture of the film's sheet to the next


@dataclass(frozen=True)
class Character:
    """A cutout of the demo: its drawing, pins and poses, where it stands, and how its cells look."""

    name: str
    layers: Sequence[Layer]
    pins: Sequence[puppet.PinPlan]
    poses: Sequence[puppet.Pose]
    spacing: float  # the mesh's edge length
    x: float
    view: View  # relative to where it stands
    ground: tuple[int, int, int]
    columns: int
    stance: float  # how wide it stands on the ground
    swing: tuple[int, int]  # the poses between which something swings far, counted from rest
    swinging: Sequence[str]  # pins there
    swing_view: View
    trials: Sequence[Trial] = ()
    trial_view: View | None = None


def characters() -> list[Character]:
    """The cast of the demo."""
    return [
        Character("Lantern Fox", fox.layers(), fox.PINS, fox.POSES, 0.052, 0.0,
                  View.around(0.12, -0.4, 5.9, 420, 560), (205, 228, 224), 4, 2.2,
                  (1, 2), ("Near Hand", "Tail Tip", "Lantern"), View.around(0.05, -0.35, 4.7, 350, 320)),
        Character("River Dragon", dragon.layers(), dragon.PINS, dragon.POSES, 0.060, 7.4,
                  View.around(0.0, -0.45, 6.0, 858, 470), (248, 222, 196), 2, 5.4,
                  (2, 3), ("Tail Fin", "Head"), View.around(-0.35, -0.4, 5.6, 350, 200),
                  dragon.TRIALS, View.around(-0.2, -0.55, 6.6, 554, 300)),
    ]  # fmt: skip


def main() -> None:
    """Runs the demo."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pictures", type=Path, help="also write the docs' pictures into this folder")
    arguments = parser.parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    planar_deform.register()
    try:
        run(arguments.pictures)
    finally:
        planar_deform.unregister()  # the bpy module crashes at exit with classes still registered


def run(pictures: Path | None) -> None:
    """Everything between registering and unregistering the add-on."""
    start = time.perf_counter()
    info = planar_native.build_info()
    print(f"Blender {bpy.app.version_string}, planar_native {info['version']} with {info['backend']}")
    contact_sheet.prepare_scene(bpy.context.scene)
    cast = characters()
    poses = 2 + max(len(character.poses) for character in cast)  # with rest before and behind
    bpy.context.scene.frame_end = 1 + APART * (poses - 1) + film.HOLD

    rows: list[list[Cell]] = []
    compared: list[list[Cell]] = []
    images: dict[str, Image.Image] = {}  # for the docs
    for character in cast:
        obj = build(character)
        if pictures and character.trials:  # of one layer, the tail of which reaches across its body
            view = View.around(character.x + 0.6, -0.6, 5.2, 420, 340)
            way = comparison.arc((4.6, -0.6), 3.0, -215)
            cells = depths.crossing(obj, "Tail Fin", way, ("Tail", "Hind"), view, character.ground)
            images["depth"] = contact_sheet.sheet("One layer, the tail across the body", [cells])
        for trial in character.trials:
            compared += compare(character, obj, trial)
        cells = perform(character, obj)
        rows += [cells[i : i + character.columns] for i in range(0, len(cells), character.columns)]
        fill_in(obj)
        bpy.context.scene.frame_set(1)
        if pictures:
            images[f"arcs_{character.name.split()[-1].lower()}"] = swing(character, obj)
        obj.select_set(False)
        obj.hide_render = True  # until the film: the next one's pictures show what is behind it, too

    if pictures:
        in_parts = contact_sheet.sheet("Layers that hang together", [attached.cells()])
        in_hand = contact_sheet.sheet("A lantern that the hand carries", [carried.cells()])
    in_lattices = bend()
    laid_flat = unroll()
    out = ROOT / "out"
    out.mkdir(exist_ok=True)
    sheet = contact_sheet.sheet(
        "Planar Deform: drawn once, posed by pins", rows + compared + in_lattices + [laid_flat]
    )
    sheet.save(out / "contact_sheet.png", optimize=True)
    film_sheet = make_film(cast, out / "demo.mp4")
    film_sheet.save(out / "film_sheet.png", optimize=True)
    stage = bpy.context.scene
    on_the_way = walker.perform(with_pictures=pictures is not None)
    walk_sheet = walker.shoot(out / "walk.mp4")
    walk_sheet.save(out / "walk_sheet.png", optimize=True)
    bpy.context.window.scene = stage
    show_front_view()
    bpy.context.preferences.filepaths.save_version = 0  # no demo.blend1 beside it
    with contact_sheet.silenced_blender():
        bpy.ops.wm.save_as_mainfile(filepath=str(out / "demo.blend"), compress=True)
    if pictures:
        images |= {"contact_sheet": sheet, "film": film_sheet, "walk": walk_sheet}
        images["character_layers"] = contact_sheet.sheet("Seven layers and a lantern", on_the_way[:1])
        images["character_poses"] = contact_sheet.sheet("Hung together, and a step of it", on_the_way[1:])
        images["cutouts"] = contact_sheet.sheet("Outlines and meshes", outline_sheet.rows(cutout.DRAWINGS))
        images["fox"] = contact_sheet.sheet("Four layers, seventeen pins", rows[:1])
        images["lattices"] = contact_sheet.sheet("Posed by one lattice each", in_lattices)
        images["flatten"] = contact_sheet.sheet("A surface laid flat, and what it is posed by", [laid_flat])
        images["methods"] = contact_sheet.sheet("The same drags by each method", compared)
        images["feet"] = contact_sheet.sheet("Feet held by their middle, and each", feet.rows())
        images["attach"], images["carried"] = in_parts, in_hand
        images["arcs_bar"] = contact_sheet.sheet("A bar rolled up by 300 degrees", arcs.bar_rows(300))
        save_pictures(pictures, images)
    wrote = (
        "demo.blend", "contact_sheet.png", "demo.mp4", "film_sheet.png", "walk.mp4", "walk_sheet.png"
    )  # fmt: skip
    print(f"Wrote {', '.join(f'out/{name}' for name in wrote)}; {time.perf_counter() - start:.1f} s in all")


def bend() -> list[list[Cell]]:
    """Poses and keys what lattices deform; rows of it."""
    end = bpy.context.scene.frame_end - film.HOLD
    pins = {"Near Foot": ("Body", -0.34, 0.12), "Far Foot": ("Body", 0.51, 0.12), "Hips": ("Body", 0.03, 1.7),
            "Head": ("Body", 0.08, 3.4), "Tail": ("Tail", -1.8, 2.45), "Hand": ("Waving Arm", -1.18, 1.34),
            "Lantern": ("Lantern Arm", 1.28, 0.9)}  # fmt: skip
    paper = lattices.layered(fox.layers(), pins, LATTICES[0], 0.08)
    bows = [
        lattices.Act("Bow", {"Head": (0.7, -0.25), "Tail": (-0.1, 0.5), "Hand": (-0.25, 0.45)}),
        lattices.Act("Reach", {"Head": (-0.35, 0.2), "Lantern": (0.25, 0.55), "Tail": (0.1, -0.35)}),
    ]
    rows = [lattices.perform(paper, bows, APART, end)]
    for obj in paper.objects:
        obj.hide_render = True
    ears = {"Chin": (0.0, -0.75), "Brow": (0.0, 0.55), "Left Ear": (-1.2, 0.3), "Right Ear": (1.0, 0.3)}
    bust = lattices.model(LATTICES[1], 1.9, 1.5, {name: (1.5 * x, 1.5 * z) for name, (x, z) in ears.items()})
    ways = [
        lattices.Act("Listen", {"Left Ear": (-0.35, 0.7), "Right Ear": (0.1, 0.9), "Chin": (0.15, 0.0)}),
        lattices.Act("Droop", {"Left Ear": (0.3, -0.8), "Right Ear": (-0.3, -0.8), "Brow": (0.0, 0.35)}),
    ]
    rows.append(lattices.perform(bust, ways, APART, end))
    for lattice in (paper.lattice, bust.lattice):
        lattice.select_set(False)
    return rows


def build(character: Character) -> bpy.types.Object:
    """Draws, meshes and pins a character, and makes it the active object; prints its figures."""
    start = time.perf_counter()
    obj = cutout.build(character.name, character.layers, character.spacing, pixels_per_unit=200)
    obj.location.x = character.x
    puppet.add_pins(obj, character.layers, character.pins)
    angle = cutout.smallest_angle(puppet.shown_points(obj), triangles(obj))
    print(
        f"{character.name}: {size(character, obj)}, no angle below {angle:.0f} degrees; "
        f"drawn and pinned in {time.perf_counter() - start:.1f} s"
    )
    return obj


def size(character: Character, obj: bpy.types.Object) -> str:
    """How large a character is, in words."""
    layers = "1 layer" if len(character.layers) == 1 else f"{len(character.layers)} layers"
    return f"{len(obj.data.vertices)} vertices, {layers}, {len(obj.planar.pins)} pins"


def triangles(obj: bpy.types.Object) -> np.ndarray:
    """The faces, m x 3."""
    return np.array([tuple(face.vertices) for face in obj.data.polygons])


def perform(character: Character, obj: bpy.types.Object) -> list[Cell]:
    """Keys a character's poses; prints their figures."""
    rest = puppet.shown_points(obj)
    puppet.key_rest(obj, frame=1)
    cells = [("Rest", size(character, obj), picture(character, obj, with_mesh=True))]
    for number, pose in enumerate(character.poses, start=1):
        effort = puppet.strike(obj, character.pins, pose, frame=1 + APART * number)
        measure = planar_native.distortion(rest, puppet.shown_points(obj), triangles(obj))
        print(
            f"  {pose.name}: {effort.drags} drags in {effort.seconds:.1f} s, "
            f"{1000 * effort.seconds / effort.drags:.0f} ms for each with settling; "
            f"distortion {words(measure)} (2 is none)"
        )
        cells.append((pose.name, words(measure), picture(character, obj)))
    puppet.key_rest(obj, frame=1 + APART * (1 + len(character.poses)))
    return cells


def fill_in(obj: bpy.types.Object) -> None:
    """Times the keyed poses and generates the frames between them; prints how many and how good they are."""
    film.time_poses(obj)
    blocks = len(obj.data.shape_keys.key_blocks)
    start = time.perf_counter()
    bpy.ops.planar.generate_inbetweens()
    seconds = time.perf_counter() - start
    made = len(obj.data.shape_keys.key_blocks) - blocks
    print(f"  {made} in-betweens generated in {seconds:.2f} s; {travelled(obj)}")


def unroll() -> list[Cell]:
    """Lays a surface flat and poses the flat mesh; cells of it."""
    pins = {"Left": (-2.0, 0.1), "Right": (2.0, 0.1), "Neck": (0.0, 0.4), "Middle": (0.0, -0.7)}
    drags = {"Right": (-0.25, 0.75), "Left": (0.3, 0.35)}
    return hood.perform(hood.build(SURFACE, 0.0), pins, drags)


def travelled(obj: bpy.types.Object) -> str:
    """The worst of all frames in words, beside the worst keyed pose."""
    scene = bpy.context.scene
    scene.frame_set(1)
    rest, faces = puppet.shown_points(obj), triangles(obj)
    keyed, shown, flipped = 2.0, 2.0, 0
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        measure = planar_native.distortion(rest, puppet.shown_points(obj), faces)
        shown, flipped = max(shown, measure.angle), max(flipped, measure.flipped)
        if (frame - 1) % APART == 0:
            keyed = max(keyed, measure.angle)
    return f"angle distortion up to {shown:.3f}, of the keyed poses {keyed:.3f}, {flipped} flipped"


def swing(character: Character, obj: bpy.types.Object) -> Image.Image:
    """The character between two of its poses, blended and generated."""
    rest = puppet.shown_points(obj)
    places = puppet.pin_points(obj)
    marked = [int(np.hypot(*(rest - places[name]).T).argmin()) for name in character.swinging]
    names = [obj.planar.poses[pose].name for pose in character.swing]
    motions = arcs.generated(obj, character.swing)
    view, ground = character.swing_view, character.ground
    rows = arcs.rows(obj, motions, marked, view, ground, rest, triangles(obj))
    return contact_sheet.sheet(f"From {names[0]} to {names[1]}", rows)


def make_film(cast: Sequence[Character], path: Path) -> Image.Image:
    """Renders the film of what is on the timeline; a sheet of its frames."""
    scene = bpy.context.scene
    standing = {character.x: character.stance for character in cast}
    stage = film.build_stage(STAGE, standing | {LATTICES[0]: 2.2, LATTICES[1]: 3.0})
    scene.collection.objects.link(stage)
    for obj in scene.objects:
        obj.hide_render = False
    film.prepare(scene, STAGE)
    frames = film.shoot(scene, path, SHEET_STEP)
    stage.hide_set(True)  # in the viewport, where the characters are posed
    marks = {
        1 + APART * number: " / ".join(names)
        for number, names in enumerate(zip(*(pose_names(character) for character in cast), strict=True))
    }
    return film.sheet("Keyed poses, and the frames generated between them", frames, marks, columns=4)


def pose_names(character: Character) -> list[str]:
    """What a character is keyed in, in the order of time."""
    return ["Rest", *(pose.name for pose in character.poses), "Rest"]


def compare(character: Character, obj: bpy.types.Object, trial: Trial) -> list[list[Cell]]:
    """What each method makes of the same drags from rest, and below how distorted it is; prints figures."""
    seen = replace(character, view=character.trial_view)
    bpy.ops.planar.reset_to_rest()
    rest = puppet.shown_points(obj)
    for pin in obj.planar.pins:
        pin.enabled = pin.group in trial.pins
    posed: list[Cell] = []
    coloured: list[Cell] = []
    for method, label in comparison.METHODS.items():
        obj.planar.method = method
        bpy.ops.planar.reset_to_rest()
        for pin, way in trial.ways:
            puppet.lead(pin, way)
        points = puppet.shown_points(obj)
        measure = planar_native.distortion(rest, points, triangles(obj))
        off = np.hypot(*(points - rest).T).max() / np.hypot(*np.ptp(rest, axis=0))  # of the diagonal
        told = f"up to {100 * off:.1f} % off rest" if trial.returns else "angle distortion"
        print(f"  {trial.name}, {label}: distortion {words(measure)}" + f"; {told}" * trial.returns)
        posed.append((label, words(measure), picture(seen, obj)))
        coloured.append((trial.name, told, comparison.coloured(seen.view, points, triangles(obj), measure)))
    bpy.ops.planar.reset_to_rest()
    obj.planar.method = "HOLD"
    for pin in obj.planar.pins:
        pin.enabled = True
    return [posed, coloured]


def words(measure: planar_native.Distortion) -> str:
    """Distortion in words."""
    return f"area {measure.area:.3f}, angle {measure.angle:.3f}, {measure.flipped} flipped"


def picture(character: Character, obj: bpy.types.Object, with_mesh: bool = False) -> Image.Image:
    """The character as it stands now, with its pins, in its cell."""
    view, ground = character.view, character.ground
    shown = View(view.left + character.x, view.bottom, view.unit, view.width, view.height)
    rendered = contact_sheet.render(bpy.context.scene, shown)
    edges = np.array([edge.vertices[:] for edge in obj.data.edges]) if with_mesh else None
    patches = {pin.group for pin in obj.planar.pins if pin.kind == "PATCH"}
    return contact_sheet.cell(
        rendered, view, puppet.shown_points(obj), puppet.pin_points(obj), patches, ground, edges
    )


def show_front_view() -> None:
    """Makes the saved file open on the characters from the front, their drawing shown, the fox active."""
    objects = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH" and obj.visible_get()]
    for obj in objects:
        obj.select_set(obj == objects[0])
    bpy.context.view_layer.objects.active = objects[0]
    bpy.context.scene.camera.hide_set(True)
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                space = area.spaces.active
                space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "TEXTURE"
                space.overlay.show_cursor = False
                region = space.region_3d
                region.view_rotation = bpy.context.scene.camera.rotation_euler.to_quaternion()
                region.view_perspective = "ORTHO"
                region.view_location = (4.8, 0.0, 2.1)
                region.view_distance = 14.0


def save_pictures(folder: Path, images: Mapping[str, Image.Image]) -> None:
    """Pictures for the docs by name, no wider than a page needs, as JPEG."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, image in images.items():
        width = min(image.width, 1100 if name in {"film", "walk"} else 1500)
        size = (width, round(width * image.height / image.width))
        small = image.resize(size, Image.Resampling.LANCZOS)
        small.save(folder / f"{name}.jpg", quality=85, optimize=True)


if __name__ == "__main__":
    main()
