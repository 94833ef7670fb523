# SPDX-License-Identifier: GPL-3.0-or-later
"""The points of an object's shape: of a mesh, a lattice, or of a curve's poly splines in order.

A shape is float32 and object-local: count x 3 coordinates, of a curve count x 5, with the radius and the
tilt of each point, which its shape keys hold and Blender blends as well.
"""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array32
from . import changes, redraw

TYPES = frozenset(("MESH", "CURVE", "LATTICE"))  # of objects that have such shapes
CURVE_FIELDS = ("radius", "tilt")  # the columns behind the coordinates


def count(obj: bpy.types.Object) -> int:
    """How many points the object has."""
    if obj.type == "CURVE":
        return sum(len(spline.points) for spline in obj.data.splines)
    return len(obj.data.points if obj.type == "LATTICE" else obj.data.vertices)


def read(obj: bpy.types.Object) -> Array32:
    """The shape that the mesh, the curve or the lattice has without shape keys."""
    if obj.type == "LATTICE":
        return _columns(obj.data.points, (), name="co_deform")
    if obj.type != "CURVE":
        places, name = _vertex_coordinates(obj.data)
        return _columns(places, (), name=name)
    splines = [_columns(spline.points, CURVE_FIELDS, 4) for spline in obj.data.splines]
    return np.delete(np.concatenate(splines), 3, axis=1)  # a poly spline has no use for its weight


def read_regular(lattice: bpy.types.Object) -> Array32:
    """The shape of a lattice before anything has moved its points."""
    return _columns(lattice.data.points, ())


def write(obj: bpy.types.Object, shape: Array32) -> None:
    """Give the mesh, curve or lattice itself a shape; of a curve's, coordinates alone will do, too."""
    if obj.type == "LATTICE":
        obj.data.points.foreach_set("co_deform", shape.ravel())
        return
    if obj.type != "CURVE":
        places, name = _vertex_coordinates(obj.data)
        places.foreach_set(name, shape.ravel())
        return
    start = 0
    for spline in obj.data.splines:
        rows = shape[start : start + len(spline.points)]
        coordinates = np.empty((len(rows), 4), np.float32)
        spline.points.foreach_get("co", coordinates.ravel())
        coordinates[:, :3] = rows[:, :3]
        spline.points.foreach_set("co", coordinates.ravel())
        _set_fields(spline.points, rows)
        start += len(rows)


def read_block(obj: bpy.types.Object, block: bpy.types.ShapeKey) -> Array32:
    """The shape that a shape key holds. Raises Refusal if it has another number of points than the object."""
    if len(block.data) != count(obj):
        raise Refusal(
            f"Shape key '{block.name}' has another number of points than the object, as joining curves "
            "leaves it: undo that, or remove the key"
        )
    return _held(obj, block)


def bits(obj: bpy.types.Object, block: bpy.types.ShapeKey) -> bytes:
    """The bits of read_block(), whatever the number of points: a curve in Edit Mode may have more by then."""
    return _held(obj, block).tobytes()


def write_block(block: bpy.types.ShapeKey, shape: Array32) -> None:
    """Give a shape key a shape; of a curve's, coordinates alone will do, too."""
    _coordinates(block).foreach_set("co", np.ascontiguousarray(shape[:, :3]).ravel())
    _set_fields(block.data, shape)


def update(obj: bpy.types.Object) -> None:
    """Tell Blender, and what is kept of shapes, that the object's shape has been written."""
    changes.tell_pose(obj)
    if obj.type != "MESH":
        obj.data.update_tag()
        redraw.views()
    else:
        obj.data.update()


def _held(obj: bpy.types.Object, block: bpy.types.ShapeKey) -> Array32:
    return _columns(_coordinates(block), CURVE_FIELDS if obj.type == "CURVE" else ())


def _vertex_coordinates(mesh: bpy.types.Mesh) -> tuple[bpy.types.bpy_prop_collection, str]:
    """Where a mesh's coordinates are, and by what name; a hundred times as fast as from its vertices."""
    found = mesh.attributes.get("position")  # there is none in Edit Mode
    return (mesh.vertices, "co") if found is None else (found.data, "vector")


def _coordinates(block: bpy.types.ShapeKey) -> bpy.types.bpy_prop_collection:
    """Where a shape key's coordinates are; those of a mesh's key can be had a hundred times as fast."""
    return block.points if len(block.points) else block.data


def _columns(
    points: bpy.types.bpy_prop_collection, fields: tuple[str, ...], size: int = 3, name: str = "co"
) -> Array32:
    coordinates = np.empty(len(points) * size, np.float32)
    points.foreach_get(name, coordinates)
    if not fields:
        return coordinates.reshape(-1, size)
    result = np.empty((len(points), size + len(fields)), np.float32)
    result[:, :size] = coordinates.reshape(-1, size)
    for column, field in enumerate(fields, size):
        values = np.empty(len(points), np.float32)
        points.foreach_get(field, values)
        result[:, column] = values
    return result


def _set_fields(points: bpy.types.bpy_prop_collection, shape: Array32) -> None:
    for column, field in zip(range(3, shape.shape[1]), CURVE_FIELDS, strict=False):
        points.foreach_set(field, np.ascontiguousarray(shape[:, column]))
