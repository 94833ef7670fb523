# SPDX-License-Identifier: GPL-3.0-or-later
"""What Flatten does: a surface laid flat, the flat mesh posed by pins, and its checker, which follows."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np
from PIL import Image

import contact_sheet
import planar_native
from contact_sheet import View

Place = tuple[float, float]
Cell = tuple[str, str, Image.Image]  # label, note, picture
ROWS, COLUMNS = 22, 64  # of the hood's faces
SQUARES = 14  # of the checker, along the map
LIGHT = (-0.4, -0.7, 0.6)  # where it comes from
DARK, BRIGHT = (0.16, 0.30, 0.42), (0.93, 0.86, 0.70)  # squares of the checker
SOLID = View.around(0.0, -0.95, 2.5, 290, 300)  # what shows the surface,
FLAT = View.around(0.05, -1.6, 3.5, 550, 300)  # and the flat mesh


def build(x: float, z: float) -> bpy.types.Object:
    """A surface that nobody can unroll, open below: half an egg with a cut at its back and an open crown."""
    down = np.radians(np.linspace(18.0, 118.0, ROWS + 1))[:, None]
    round_ = np.radians(np.linspace(20.0, 340.0, COLUMNS + 1) - 270.0)[None, :]
    radius = 1.0 + 0.1 * np.cos(3.0 * round_) * np.sin(down) ** 2
    places = np.stack(
        [
            radius * np.sin(down) * np.cos(round_),
            radius * np.sin(down) * np.sin(round_),
            1.15 * np.cos(down) + 0 * round_,
        ],
        axis=-1,
    ).reshape(-1, 3)
    first = (np.arange(ROWS)[:, None] * (COLUMNS + 1) + np.arange(COLUMNS)).ravel()
    faces = np.stack([first, first + COLUMNS + 1, first + COLUMNS + 2, first + 1], axis=1)
    mesh = bpy.data.meshes.new("Hood")
    mesh.from_pydata(places.tolist(), [], faces.tolist())
    for face in mesh.polygons:
        face.use_smooth = True
    mesh.materials.append(_checkered())
    obj = bpy.data.objects.new("Hood", mesh)
    obj.location = (x, 0.0, z)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def perform(surface: bpy.types.Object, pins: Mapping[str, Place], drags: Mapping[str, Place]) -> list[Cell]:
    """Lays the surface flat, and drags pins of the flat mesh, named with their places; cells of that."""
    _activate(surface)
    bpy.ops.planar.flatten(to="UV")
    bpy.ops.planar.flatten(to="MESH")
    flat = bpy.context.object
    rest = _places(flat)
    for name, place in pins.items():
        nearest = int(np.hypot(*(rest - place).T).argmin())
        flat.vertex_groups.new(name=name).add([nearest], 1.0, "REPLACE")
        bpy.ops.planar.add_pin_from_group(group=name)
    bpy.ops.planar.push_to_uv_map()
    flat.planar.live_uv = True
    cells = [
        ("A surface", f"{len(surface.data.polygons)} faces", _picture(surface, surface)),
        ("Laid flat", _against(surface, flat), _picture(flat, surface)),
    ]
    for name, offset in drags.items():
        bpy.ops.planar.select_pins(action="SELECT", pin=flat.planar.pins.find(name))
        bpy.ops.planar.drag_pins(offset=offset)
    posed = planar_native.distortion(rest, _places(flat), _triangles(flat))
    cells += [
        ("Flat, posed", f"angle {posed.angle:.3f}, {posed.flipped} flipped", _picture(flat, surface)),
        ("The checker follows", "", _picture(surface, surface)),
    ]
    print(f"A surface laid flat: {len(surface.data.vertices)} vertices, {cells[1][1]}")
    return cells


def _picture(obj: bpy.types.Object, surface: bpy.types.Object) -> Image.Image:
    """The object alone, with pins and mesh if it is the flat one."""
    x, _, z = obj.location
    for other in bpy.data.objects:
        if other.type == "MESH":
            other.hide_render = other != obj
    view = SOLID if obj == surface else FLAT
    shown = View(view.left + x, view.bottom + z, view.unit, view.width, view.height)
    rendered = contact_sheet.render(bpy.context.scene, shown)
    points = _places(obj)
    pins, edges = {}, None
    if obj != surface:
        edges = np.array([edge.vertices[:] for edge in obj.data.edges])
        for pin in obj.planar.pins:
            pins[pin.group] = points[next(iter(_members(obj, pin.group)))]
    return contact_sheet.cell(rendered, view, points, pins, set(), (226, 226, 214), edges)


def _against(surface: bpy.types.Object, flat: bpy.types.Object) -> str:
    """How distorted the flat mesh is against its surface, each triangle of which is laid flat by itself."""
    places = np.array([vertex.co[:] for vertex in surface.data.vertices])[_triangles(surface)]
    along, other = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    length = np.linalg.norm(along, axis=1)
    right = (along * other).sum(axis=1) / length
    up = np.linalg.norm(np.cross(along, other), axis=1) / length
    zero = np.zeros_like(length)
    alone = np.stack([zero, zero, length, zero, right, up], axis=1).reshape(-1, 2)
    laid = _places(flat)[_triangles(flat)].reshape(-1, 2)
    found = planar_native.distortion(alone, laid, np.arange(len(alone)).reshape(-1, 3))
    return f"area {found.area:.3f}, angle {found.angle:.3f}, {found.flipped} flipped"


def _members(obj: bpy.types.Object, group: str) -> list[int]:
    index = obj.vertex_groups[group].index
    return [v.index for v in obj.data.vertices if any(g.group == index for g in v.groups)]


def _activate(obj: bpy.types.Object) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()


def _places(obj: bpy.types.Object) -> np.ndarray:
    """Where a mesh's vertices are seen from the front, relative to the object."""
    return np.array([(vertex.co.x, vertex.co.z) for vertex in obj.data.vertices])


def _triangles(obj: bpy.types.Object) -> np.ndarray:
    obj.data.calc_loop_triangles()
    return np.array([triangle.vertices[:] for triangle in obj.data.loop_triangles])


def _checkered() -> bpy.types.Material:
    """A checker on the UV map, lit from one side without a light."""
    material = bpy.data.materials.new("Checker")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    uv, checker = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = SQUARES
    for name, colour in (("Color1", DARK), ("Color2", BRIGHT)):
        checker.inputs[name].default_value = (*colour, 1.0)
    geometry, dot = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    dot.inputs[1].default_value = np.array(LIGHT) / np.linalg.norm(LIGHT)
    shade = nodes.new("ShaderNodeMapRange")
    shade.inputs["From Min"].default_value, shade.inputs["To Min"].default_value = -0.4, 0.35
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    links.new(uv.outputs["UV"], checker.inputs["Vector"])
    links.new(geometry.outputs["Normal"], dot.inputs[0])
    links.new(dot.outputs["Value"], shade.inputs["Value"])
    links.new(checker.outputs["Color"], emission.inputs["Color"])
    links.new(shade.outputs["Result"], emission.inputs["Strength"])
    links.new(emission.outputs[0], output.inputs["Surface"])
    return material
