# SPDX-License-Identifier: GPL-3.0-or-later
"""Putting objects into a lattice: a new one round them, or one that is there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from mathutils import Matrix, Quaternion
from mathutils.kdtree import KDTree

from ...errors import Refusal
from ...model.lattice.fitting import fitted_box
from ...model.plane.frame import Array, mapped, plane_frame
from ..objects import lattice_edits
from ..objects.adding import link_beside, select_alone
from ..objects.flat_object import data_refusal, is_flat, linear_of, origin_of
from ..objects.modifiers import lattices_of, of_lattice
from ..objects.pose_store import store_of
from ..objects.triangulation import Faces, faces_of
from ..storage import vertex_groups
from ..storage.vertex_groups import members


def refusal(objects: Sequence[bpy.types.Object]) -> str | None:
    """Why these objects cannot be put into a lattice, and what to do; None if they can."""
    meshes = [obj for obj in objects if obj.type == "MESH"]
    if not meshes:
        return "No meshes are selected: select what the lattice is to deform"
    for obj in meshes:
        reason = data_refusal(obj, "OBJECT")
        if reason is not None:
            return reason
        if not obj.data.polygons:
            return f"'{obj.name}' has no faces, which pins need: deselect it"
    return None


def _read(obj: bpy.types.Object) -> tuple[Array, Faces]:
    """The vertices of faces as they reach the first modifier, n x 3 and object-local, and the faces."""
    shape = store_of(obj, unkeyed=True).shown.astype(np.float32)
    faces = faces_of(obj.data, shape)
    return shape[faces.vertices].astype(np.float64), faces


def world_of(obj: bpy.types.Object) -> Array:
    """The same vertices in the world. Raises Refusal."""
    places, _ = _read(obj)
    if not np.isfinite(places).all():
        raise Refusal(f"'{obj.name}' has vertices with coordinates that are not numbers: delete them")
    return mapped(places, linear_of(obj)) + origin_of(obj)


def plane_of(objects: Sequence[bpy.types.Object]) -> Quaternion | None:
    """How the plane is turned in which all of these objects are drawn; None where they are not flat.

    Its X and Y are the first object's own axes that lie in it.
    """
    frame = None
    for obj in objects:
        (places, faces), linear = _read(obj), linear_of(obj)
        if frame is None:
            frame = plane_frame(places, faces.parts, faces.triangles, linear)
        if frame is None or not is_flat(frame, mapped(places, linear), faces.parts):
            return None
    assert frame is not None  # there is an object
    return Matrix((frame.u, frame.v, frame.n)).transposed().to_quaternion()


def fit(
    context: bpy.types.Context,
    objects: Sequence[bpy.types.Object],
    turn: Quaternion,
    counts: Sequence[int],
    basis: str,
    free: int,
    *,
    anew: bool,
) -> list[bpy.types.Object]:
    """A new lattice round the objects, turned like that, which deforms them. Raises Refusal.

    `counts`, `free`: see fitted_box(). It comes first in their stacks, and is selected alone. `anew`: in the
    place of other lattices; those are returned that deform nothing any more.
    """
    axes = np.array(turn.to_matrix(), np.float64).T  # rows: the lattice's axes in the world
    places = np.concatenate([mapped(world_of(obj), axes) for obj in objects])
    try:
        centre, size = fitted_box(places.min(axis=0), places.max(axis=0), counts, free)
    except ValueError as error:
        raise Refusal(str(error)) from error
    data = bpy.data.lattices.new("Lattice")
    lattice = bpy.data.objects.new("Lattice", data)
    link_beside(context, objects[0], lattice)
    data.points_u, data.points_v, data.points_w = counts  # from -0.5 to 0.5, as it has an object by now
    for axis in "uvw":
        setattr(data, f"interpolation_type_{axis}", basis)
    lattice.matrix_world = Matrix.LocRotScale(mapped(centre[None, :], axes.T.copy())[0], turn, size)
    others: list[bpy.types.Object] = []
    for obj in objects:
        if anew:
            others += lattices_of(obj)
            for modifier in [modifier for modifier in obj.modifiers if modifier.type == "LATTICE"]:
                obj.modifiers.remove(modifier)
        add_modifier(obj, lattice)
    lattice_edits.see(lattice)
    select_alone(context, lattice)
    return [other for other in dict.fromkeys(others) if not any(modifiers_of(other))]


def add_modifier(obj: bpy.types.Object, lattice: bpy.types.Object) -> bpy.types.Modifier:
    """Let a lattice deform an object, before all else does."""
    modifier = obj.modifiers.new("Lattice", "LATTICE")
    modifier.object = lattice
    obj.modifiers.move(len(obj.modifiers) - 1, 0)
    return obj.modifiers[0]


def add_like(obj: bpy.types.Object, source: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Let the lattice of another object's modifier deform this one as strongly, and by a group like that."""
    added = add_modifier(obj, modifier.object)
    added.strength, added.invert_vertex_group = modifier.strength, modifier.invert_vertex_group
    name = modifier.vertex_group
    if name in source.vertex_groups and name not in obj.vertex_groups:
        _copy_group(source, obj, name)
    added.vertex_group = name if name in obj.vertex_groups else ""


def _copy_group(source: bpy.types.Object, obj: bpy.types.Object, name: str) -> None:
    """Give each vertex the weight of the other object's vertex that is nearest to it."""
    weights = np.zeros(len(source.data.vertices))
    rows, values = members(source, [name]).get(name, (np.empty(0, np.int32), np.empty(0)))
    weights[rows] = values
    tree = KDTree(len(source.data.vertices))
    for vertex in source.data.vertices:
        tree.insert(source.matrix_world @ vertex.co, vertex.index)
    tree.balance()
    nearest = [tree.find(obj.matrix_world @ vertex.co)[1] for vertex in obj.data.vertices]
    copied = weights[nearest]
    vertex_groups.fill(obj.vertex_groups.new(name=name), np.flatnonzero(copied > 0.0), copied[copied > 0.0])


def modifiers_of(lattice: bpy.types.Object) -> Iterable[tuple[bpy.types.Object, bpy.types.Modifier]]:
    """All objects that a lattice deforms, hidden ones as well, with the modifiers."""
    for obj in bpy.data.objects:
        for modifier in of_lattice(obj, lattice):
            yield obj, modifier
