# SPDX-License-Identifier: GPL-3.0-or-later
"""Places of meshes that pins follow: vertex groups, which go where the shape of their mesh takes them.

A place is where its mesh has taken it since rest, so at rest it is followed as the object itself is.
"""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array, Array32, mapped
from ...model.posing.mesh_place import rigid_motion
from ...model.posing.rebinding import Binding
from ..objects import pose_store, rest_shape
from ..storage import points, vertex_groups
from . import pin_list

GROUP_NAME = "Place"
SAME_PLACE = 0.1  # of the size of a place: it is where it was

# By session_uid: shapes that have been written since Blender evaluated what is looked at.
_written: dict[int, Array32] = {}


def wrote(obj: bpy.types.Object, shape: Array32) -> None:
    """An object shows this shape, of which Blender's evaluated mesh does not know yet."""
    _written[obj.session_uid] = shape


def evaluated() -> None:
    """Blender's evaluated meshes are what is shown."""
    _written.clear()


def motion_of(obj: bpy.types.Object, name: str, matrix: Array, depsgraph: bpy.types.Depsgraph) -> Array:
    """The rigid motion in the world (4 x 4) by which a mesh has moved the vertices of a group since rest.

    `matrix`: where the object is (4 x 4). Raises Refusal.
    """
    if obj.mode == "EDIT":
        raise Refusal(f"'{obj.name}', which is followed, is in Edit Mode: leave that first")
    found = vertex_groups.members(obj, [name]).get(name)
    if found is None:
        raise Refusal(f"'{obj.name}' has no vertex group '{name}': choose another one to follow")
    rest, shown = _rest_of(obj), _shown(obj, depsgraph)
    rows, weights = found
    known = (weights > 0.0) & np.isfinite(rest[rows]).all(axis=1) & np.isfinite(shown[rows]).all(axis=1)
    owners = rest_shape.owners_of(obj.data)
    if owners is not None and obj.data.shape_keys is None:
        known &= owners[rows] != 0
    rows = rows[known]
    if not len(rows):
        raise Refusal(
            f"Vertex group '{name}' of '{obj.name}' has no vertices to follow: give it some, or choose "
            "another one"
        )
    before, after = (mapped(shape[rows].astype(np.float64), matrix[:3, :3]) for shape in (rest, shown))
    motion = rigid_motion(before, after, weights[known])
    motion[:3, 3] += matrix[:3, 3] - mapped(matrix[None, :3, 3], motion[:3, :3])[0]
    return motion


def new_place(obj: bpy.types.Object, binding: Binding) -> str:
    """The name of a new vertex group of these vertices of an object with their weights.

    No other group of the file has it: a join makes one of equal ones.
    """
    taken = {
        group.name for other in bpy.data.objects if other.type == "MESH" for group in other.vertex_groups
    }
    group = obj.vertex_groups.new(name=pin_list.free_name(GROUP_NAME, taken))
    vertex_groups.fill(group, *binding)
    name: str = group.name
    return name


def remove_unused(obj: bpy.types.Object, names: set[str]) -> None:
    """Remove groups that were made to be followed, and are by no pin of the file any more."""
    for name in names - places_of(obj):
        group = obj.vertex_groups.get(name)
        if group is not None and name.startswith(GROUP_NAME):
            obj.vertex_groups.remove(group)


def places_of(obj: bpy.types.Object) -> set[str]:
    """The groups of an object that pins follow."""
    return {
        pin.follow_group
        for other in bpy.data.objects
        if pin_list.has_pins(other)
        for pin in other.planar.pins
        if pin.follow == obj and pin.follow_group
    }


def are_one_place(lost: bpy.types.Object, found: bpy.types.Object, name: str) -> bool:
    """Whether a group of a mesh that is gone lies where another one has it, to which that was joined then.

    A drawing and its duplicate have groups of the same names.
    """
    places = []
    for obj in (lost, found):
        rows, weights = vertex_groups.members(obj, [name]).get(name, (np.zeros(0, np.int32), np.zeros(0)))
        if not weights.any():
            return False
        matrix = np.array(obj.matrix_world, np.float64)
        world = mapped(points.read(obj)[rows].astype(np.float64), matrix[:3, :3]) + matrix[:3, 3]
        places.append((world, np.average(world, axis=0, weights=weights)))
    size = float(np.ptp(places[0][0], axis=0).max())
    return bool(np.linalg.norm(places[1][1] - places[0][1]) <= SAME_PLACE * size)


def _rest_of(obj: bpy.types.Object) -> Array32:
    rest = rest_shape.basis_or_stored(obj)
    return points.read(obj) if rest is None else rest


def _shown(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Array32:
    """What Blender shows of the vertices, count x 3; without modifiers that change how many there are."""
    written = _written.get(obj.session_uid)
    if written is not None:
        return written
    shown = obj.evaluated_get(depsgraph)
    count = len(obj.data.vertices)
    if len(shown.data.vertices) != count:
        return pose_store.shown_by(obj)
    return points.read(shown)
