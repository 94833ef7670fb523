# SPDX-License-Identifier: GPL-3.0-or-later
"""What lattices do: for a character whose layers are objects of their own, and for a model, bent as seen."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from PIL import Image

import contact_sheet
import cutout
import planar_native
import puppet
from contact_sheet import View
from drawing import Layer
from planar_deform.scene.view import snapshot

Cell = tuple[str, str, Image.Image]  # label, note, picture
LIGHT = (-0.45, -0.75, 0.5)  # where the model's light comes from
SHADES = ((0.0, (0.32, 0.17, 0.26)), (0.30, (0.85, 0.42, 0.36)), (0.72, (0.98, 0.66, 0.45)))  # by brightness


@dataclass(frozen=True)
class Scene:
    """Objects in a lattice, the poses of which are keyed from the second one on."""

    name: str
    x: float  # where it stands
    view: View  # relative to that
    ground: tuple[int, int, int]
    objects: Sequence[bpy.types.Object]
    lattice: bpy.types.Object
    pins: Sequence[str]


@dataclass(frozen=True)
class Act:
    """A pose: how far pins are led from where they are at rest, by name."""

    name: str
    offsets: Mapping[str, tuple[float, float]]


def layered(
    layers: Sequence[Layer], pins: Mapping[str, tuple[str, float, float]], x: float, spacing: float
) -> Scene:
    """Each layer as an object, all in one lattice, with pins (layer, x, z) by name."""
    objects = []
    for layer in layers:
        obj = cutout.build(f"Paper {layer.name}", [layer], spacing, pixels_per_unit=150)
        obj.location.x = x
        objects.append(obj)
    lattice = _fit(objects, space="PLANE", resolution=(14, 14))
    by_layer = {layer.name: obj for layer, obj in zip(layers, objects, strict=True)}
    for name, (layer, px, pz) in pins.items():
        points = puppet.shown_points(by_layer[layer])
        nearest = int(np.hypot(*(points - (px, pz)).T).argmin())
        by_layer[layer].vertex_groups.new(name=name).add([nearest], 1.0, "REPLACE")
        bpy.ops.planar.add_pin_from_group(object=by_layer[layer].name, group=name)
    view = View.around(-0.2, -0.4, 5.6, 566, 460)
    return Scene("Four objects, one lattice", x, view, (222, 214, 236), objects, lattice, list(pins))


def model(x: float, z: float, size: float, pins: Mapping[str, tuple[float, float]]) -> Scene:
    """A model in a lattice across the camera, with pins at places (x, z) of what faces it."""
    bpy.ops.mesh.primitive_monkey_add(location=(x, 0.0, z), rotation=(0.0, 0.0, 0.3))
    obj = bpy.context.object
    obj.name, obj.scale = "Model", (size, size, size)
    smooth = obj.modifiers.new("Smooth", "SUBSURF")
    smooth.render_levels, smooth.show_viewport = 2, False
    obj.data.materials.append(_shaded("Model"))
    for face in obj.data.polygons:
        face.use_smooth = True
    lattice = _fit([obj], space="CAMERA", resolution=(12, 12))
    places = _world(obj)
    for name, (px, pz) in pins.items():
        near = np.hypot(places[:, 0] - x - px, places[:, 2] - z - pz)
        facing = np.flatnonzero(near < near.min() + 0.06 * size)
        nearest = int(facing[places[facing, 1].argmin()])
        obj.vertex_groups.new(name=name).add([nearest], 1.0, "REPLACE")
        bpy.ops.planar.add_pin_from_group(object=obj.name, group=name)
    view = View.around(0.0, -0.4, 5.6, 566, 460)
    return Scene("A model, bent as it is seen", x, view, (216, 228, 206), [obj], lattice, list(pins))


def perform(scene: Scene, acts: Sequence[Act], apart: int, last: int) -> list[Cell]:
    """Keys the acts, so many frames apart, with rest before and behind, and fills in; cells of them."""
    bpy.context.view_layer.objects.active = scene.lattice
    _key(1, "Rest")
    cells = [("Rest", _size(scene), picture(scene))]
    rest = [_world(obj) for obj in scene.objects]
    drags, seconds = 0, 0.0
    for number, act in enumerate(acts, start=1):
        bpy.context.scene.frame_set(1 + apart * number)
        bpy.ops.planar.reset_to_rest()
        for name, offset in act.offsets.items():
            bpy.ops.planar.select_pins(action="SELECT", pin=scene.lattice.planar.pins.find(name))
            start = time.perf_counter()
            bpy.ops.planar.drag_pins(offset=offset)
            drags, seconds = drags + 1, seconds + time.perf_counter() - start
        _key(1 + apart * number, act.name)
        cells.append((act.name, _told(scene, rest), picture(scene)))
    bpy.context.scene.frame_set(last)
    bpy.ops.planar.reset_to_rest()
    _key(last, "Rest")
    bpy.ops.planar.generate_inbetweens()
    print(
        f"{scene.name}: {_size(scene)}, {drags} drags, {1000 * seconds / drags:.0f} ms for each with settling"
    )
    bpy.context.scene.frame_set(1)
    return cells


def picture(scene: Scene) -> Image.Image:
    """The scene as it stands now, with its pins and the lattice, in its cell."""
    view = scene.view
    shown = View(view.left + scene.x, view.bottom, view.unit, view.width, view.height)
    rendered = contact_sheet.render(bpy.context.scene, shown)
    points = np.concatenate([_world(obj)[:, (0, 2)] for obj in scene.objects]) - (scene.x, 0.0)
    lattice = _world(scene.lattice)[:, (0, 2)] - (scene.x, 0.0)
    edges = _edges(scene.lattice) + len(points)
    both = np.concatenate([points, lattice])
    seen = snapshot.of_active(bpy.context)
    pins = {
        name: seen.pin(index).place[[0, 2]] - (scene.x, 0.0)
        for index, name in enumerate(scene.pins)
        if seen is not None and seen.pin(index) is not None
    }
    return contact_sheet.cell(rendered, view, both, pins, set(), scene.ground, edges)


def _fit(objects: Sequence[bpy.types.Object], **options: object) -> bpy.types.Object:
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]
    bpy.context.view_layer.update()
    bpy.ops.planar.fit_lattice(**options)
    return bpy.context.object


def _key(frame: int, name: str) -> None:
    if bpy.context.scene.frame_current != frame:
        bpy.context.scene.frame_set(frame)
    bpy.ops.planar.key_pose()
    planar = bpy.context.object.planar
    planar.poses[planar.active_pose].name = name


def _size(scene: Scene) -> str:
    vertices = sum(len(obj.data.vertices) for obj in scene.objects)
    data = scene.lattice.data
    return f"{vertices} vertices, {len(scene.pins)} pins, {data.points_u} x {data.points_v} points"


def _told(scene: Scene, rest: Sequence[np.ndarray]) -> str:
    """How distorted the drawings are, or how far the model is moved in depth."""
    if len(scene.objects) == 1:
        depth = np.abs((_world(scene.objects[0]) - rest[0])[:, 1]).max()
        return f"depths changed by {depth:.0e}"
    flipped, angle = 0, 2.0
    for obj, before in zip(scene.objects, rest, strict=True):
        faces = np.array([tuple(face.vertices) for face in obj.data.polygons])
        measure = planar_native.distortion(before[:, (0, 2)], _world(obj)[:, (0, 2)], faces)
        flipped, angle = flipped + measure.flipped, max(angle, measure.angle)
    return f"angle {angle:.3f}, {flipped} flipped"


def _world(obj: bpy.types.Object) -> np.ndarray:
    """World positions as they are shown of a mesh's vertices or a lattice's points, n x 3."""
    data = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found, name = (data.points, "co_deform") if obj.type == "LATTICE" else (data.vertices, "co")
    points = np.empty(3 * len(found), np.float32)
    found.foreach_get(name, points)
    matrix = np.array(obj.matrix_world)
    return points.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]


def _edges(lattice: bpy.types.Object) -> np.ndarray:
    """Pairs of neighbours in a lattice of one layer."""
    u, v = lattice.data.points_u, lattice.data.points_v
    number = np.arange(u * v).reshape(v, u)
    along = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    across = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    return np.concatenate([along, across])


def _shaded(name: str) -> bpy.types.Material:
    """Three flat tones by how much of a face looks at the light, in a scene without one."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    geometry = nodes.new("ShaderNodeNewGeometry")
    dot = nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    dot.inputs[1].default_value = np.array(LIGHT) / np.linalg.norm(LIGHT)
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.interpolation = "CONSTANT"
    ramp.color_ramp.elements.new(0.5)
    for element, (position, colour) in zip(ramp.color_ramp.elements, SHADES, strict=True):
        element.position, element.color = position, (*colour, 1.0)
    emission = nodes.new("ShaderNodeEmission")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(geometry.outputs["Normal"], dot.inputs[0])
    links.new(dot.outputs["Value"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])
    return material
