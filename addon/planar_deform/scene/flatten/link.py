# SPDX-License-Identifier: GPL-3.0-or-later
"""How a flat mesh keeps what of its surface it is: attributes with the surface's vertices and corners.

Both are counted from 1, so that what an edit of the flat mesh has added stands for nothing (0).
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...errors import Refusal
from ...model.flatten.patches import Corners, matched
from ...model.plane.frame import Indices
from .surface import corners_of

VERTEX = "planar_surface_vertex"
CORNER = "planar_surface_corner"
EDGE_NUMBER = "planar_edge_number"
DOMAINS = {VERTEX: "POINT", CORNER: "CORNER", EDGE_NUMBER: "EDGE"}
AGAIN = "lay the surface flat again with Flatten"


@dataclass(frozen=True)
class Link:
    """What a flat mesh is of its surface."""

    surface: bpy.types.Object
    vertices: Indices  # of the surface, for each vertex of the flat mesh
    corners: Indices  # of the surface, for each corner of the flat mesh


def is_flat_mesh(obj: bpy.types.Object | None) -> bool:
    """Whether an object has been made by Flatten; its surface may be lost by now."""
    return obj is not None and obj.type == "MESH" and VERTEX in obj.data.attributes


def set_link(obj: bpy.types.Object, surface: bpy.types.Object, vertices: Indices, corners: Indices) -> None:
    """Remember what of a surface the vertices and corners of a flat mesh are."""
    obj.planar.surface = surface
    obj.planar.surface_vertices = len(surface.data.vertices)
    write_numbers(obj.data, VERTEX, vertices + 1)
    write_numbers(obj.data, CORNER, corners + 1)


def write_numbers(mesh: bpy.types.Mesh, name: str, numbers: Indices) -> None:
    """Keep a number for each of what the attribute is of."""
    found = mesh.attributes.get(name) or mesh.attributes.new(name, "INT", DOMAINS[name])
    found.data.foreach_set("value", np.ascontiguousarray(numbers, dtype=np.int32))


def numbers_of(mesh: bpy.types.Mesh, name: str) -> Indices | None:
    """The numbers that are kept; None where there are none."""
    found = mesh.attributes.get(name)
    if found is None or found.data_type != "INT" or found.domain != DOMAINS[name]:
        return None
    numbers = np.empty(len(found.data), np.int32)
    found.data.foreach_get("value", numbers)
    return numbers


def surface_of(obj: bpy.types.Object) -> bpy.types.Object:
    """The surface that a flat mesh is of, in Object Mode. Raises Refusal."""
    surface = obj.planar.surface
    if surface is None or surface.type != "MESH" or not surface.users_scene:
        raise Refusal(f"The surface of '{obj.name}' has been deleted: undo that, or {AGAIN}")
    if surface.mode != "OBJECT":
        raise Refusal(f"'{surface.name}' is in another mode: leave that first")
    return surface


def read_link(obj: bpy.types.Object, *, renewed: bool = False) -> Link:
    """What a flat mesh in Object Mode is of its surface. Raises Refusal where they do not fit any more.

    `renewed`: where the surface has been edited, flat faces stand for those on the same vertices. Refused is
    then only one that has more or fewer vertices by now, or lacks faces.
    """
    surface = surface_of(obj)
    vertices, corners = _numbers(obj)
    of_surface, of_flat = corners_of(surface.data), corners_of(obj.data)
    count = len(surface.data.vertices)
    before = obj.planar.surface_vertices
    fits = _fits(vertices, corners, of_surface, of_flat, count)
    if count != before and (renewed or not fits):
        raise Refusal(
            f"'{surface.name}' has {count} vertices, not the {before} that '{obj.name}' was made of: undo "
            f"what was done to it, or {AGAIN}"
        )
    if not fits:
        found = matched(of_flat, vertices, of_surface) if _within(vertices, count) else None
        if found is None or not renewed:
            use = "" if found is None else "use Refresh from Surface, "
            raise Refusal(
                f"The faces of '{surface.name}' are not those that '{obj.name}' was made of: {use}undo what "
                f"was done to them, or {AGAIN}"
            )
        corners = found
    return Link(surface, vertices, corners)


def _numbers(obj: bpy.types.Object) -> tuple[Indices, Indices]:
    vertices, corners = numbers_of(obj.data, VERTEX), numbers_of(obj.data, CORNER)
    if vertices is None or corners is None:
        raise Refusal(f"'{obj.name}' was not made by Flatten: select the flat mesh of a surface")
    if not (vertices.all() and corners.all()):
        raise Refusal(f"'{obj.name}' has parts that its surface does not: undo their making, or {AGAIN}")
    return vertices - 1, corners - 1


def _within(numbers: Indices, count: int) -> bool:
    return not len(numbers) or bool(numbers.min() >= 0 and numbers.max() < count)


def _fits(vertices: Indices, corners: Indices, surface: Corners, flat: Corners, count: int) -> bool:
    """Whether the corners are of these vertices, and those of a flat face of one face of the surface."""
    if not _within(vertices, count) or not _within(corners, len(surface.vertices)):
        return False
    if not np.array_equal(surface.vertices[corners], vertices[flat.vertices]):
        return False
    owners = surface.faces[corners]
    return bool((owners == owners[flat.starts[flat.faces]]).all())
