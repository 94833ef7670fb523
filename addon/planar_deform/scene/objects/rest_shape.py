# SPDX-License-Identifier: GPL-3.0-or-later
"""The rest shape: the Basis when there are shape keys, else an attribute of the mesh's points."""

from __future__ import annotations

import random

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array32, Indices
from ..sequence import pose_state
from ..storage import points, shape_keys
from ..storage.migration import OWNER, REST, SEEN, VERSION


def basis_or_stored(obj: bpy.types.Object) -> Array32 | None:
    """Rest positions count x 3 (float32, object-local) as they are stored; None when they are not."""
    mesh = obj.data
    if mesh.shape_keys is not None:
        return points.read_block(obj, mesh.shape_keys.reference_key)
    return stored_of(mesh)


def stored_of(mesh: bpy.types.Mesh) -> Array32 | None:
    """Rest positions count x 3 as the attribute of the mesh has them, which it may beside shape keys."""
    return _vectors(mesh, REST)


def seen_of(mesh: bpy.types.Mesh) -> Array32 | None:
    """The shape count x 3 in which the mesh, or its Basis, was last seen; None where that is not known."""
    if mesh.planar_seen.keyed != (mesh.shape_keys is not None):
        return None
    return _vectors(mesh, SEEN)


def see(mesh: bpy.types.Mesh, shape: Array32) -> None:
    """Keep the shape count x 3 that the mesh, or its Basis, has now."""
    keyed = mesh.shape_keys is not None
    if mesh.planar_seen.keyed != keyed:
        mesh.planar_seen.keyed = keyed
    _put(mesh, SEEN, "FLOAT_VECTOR", "vector", shape)


def owners_of(mesh: bpy.types.Mesh) -> Indices | None:
    """The owner of each vertex's stored rest (count,); None when that is not recorded."""
    owner = _attribute(mesh, OWNER, "INT")
    if owner is None:
        return None
    owners = np.empty(len(mesh.vertices), np.int32)
    owner.data.foreach_get("value", owners)
    return owners


def write(mesh: bpy.types.Mesh, rest: Array32) -> None:
    """Store rest positions, count x 3, on a mesh without shape keys, all owned by this mesh."""
    put_back(mesh, rest, np.full(len(mesh.vertices), new_owner(), np.int32))


def new_owner() -> int:
    """A number that no mesh has, to all probability."""
    return random.randrange(1, 1 << 24)  # so that Blender's interpolation in float keeps it


def put_back(mesh: bpy.types.Mesh, rest: Array32 | None, owners: Indices | None) -> None:
    """Store rest and owners as they were read, and nothing where there was nothing."""
    mesh.planar_version = 0 if rest is None else VERSION
    _put(mesh, REST, "FLOAT_VECTOR", "vector", rest)
    write_owners(mesh, owners)


def write_owners(mesh: bpy.types.Mesh, owners: Indices | None) -> None:
    """Store the owner of each vertex (count,), or none."""
    _put(mesh, OWNER, "INT", "value", owners)


def ensure(obj: bpy.types.Object) -> None:
    """Store the current shape as rest shape if none is stored."""
    mesh = obj.data
    if basis_or_stored(obj) is None:
        write(mesh, points.read(obj))


def reference(obj: bpy.types.Object) -> Array32:
    """The shape count x 3 of the mesh itself, of its Basis where it has shape keys. Raises Refusal."""
    keys = obj.data.shape_keys
    return points.read(obj) if keys is None else points.read_block(obj, keys.reference_key)


def set_to_current(obj: bpy.types.Object) -> None:
    """Take the current shape as rest shape.

    With a pose sequence it becomes the Basis. With relative keys what the posed key adds to the shown shape
    goes into the Basis, the other keys move along with it, and the posed key adds nothing any more: what is
    shown stays the same. Raises Refusal, with nothing changed.
    """
    mesh = obj.data
    if mesh.shape_keys is None:
        write(mesh, points.read(obj))
    elif not mesh.shape_keys.use_relative:
        shown = pose_state.shown_points(obj)  # the poses stay as they are, wherever the rest is
        points.write_block(mesh.shape_keys.reference_key, shown)
        points.write(obj, shown)
        points.update(obj)
    else:
        _give_to_basis(obj)
    see(mesh, reference(obj))


def _give_to_basis(obj: bpy.types.Object) -> None:
    """What the posed key adds goes into the Basis of relative keys. Raises Refusal, with nothing changed."""
    keys = obj.data.shape_keys
    posed = shape_keys.posed_key(obj)
    if posed is None:
        return  # the Basis itself is active: it is the rest already
    if posed.relative_key != posed and posed in _relative_chain(posed.relative_key):
        raise Refusal(
            f"Shape key '{posed.name}' is relative to itself by others: make it relative to the Basis"
        )
    shapes = {key.name: points.read_block(obj, key).astype(np.float64) for key in keys.key_blocks}
    under = shape_keys.under_posed_key(obj)
    own = shapes[posed.name] - shapes[under.name]
    added = own * shape_keys.weight_of_posed_key(obj)
    for key in keys.key_blocks:
        loses_own = posed in _relative_chain(key)
        points.write_block(key, (shapes[key.name] + added - own * loses_own).astype(np.float32))
    points.write(obj, points.read_block(obj, keys.reference_key))
    points.update(obj)


def _relative_chain(key: bpy.types.ShapeKey) -> list[bpy.types.ShapeKey]:
    """The key, the key it is relative to, and so on; each once."""
    chain: list[bpy.types.ShapeKey] = []
    while key not in chain:
        chain.append(key)
        key = key.relative_key
    return chain


def _put(mesh: bpy.types.Mesh, name: str, kind: str, field: str, values: Array32 | Indices | None) -> None:
    found = _attribute(mesh, name, kind)
    if values is not None:
        found = found or _new_attribute(mesh, name, kind)
        found.data.foreach_set(field, np.ascontiguousarray(values).ravel())
    elif found is not None:
        mesh.attributes.remove(found)


def _vectors(mesh: bpy.types.Mesh, name: str) -> Array32 | None:
    found = _attribute(mesh, name, "FLOAT_VECTOR")
    if found is None:
        return None
    vectors = np.empty(len(mesh.vertices) * 3, np.float32)
    found.data.foreach_get("vector", vectors)
    return vectors.reshape(-1, 3)


def _attribute(mesh: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute | None:
    found = mesh.attributes.get(name)
    return found if found is not None and found.domain == "POINT" and found.data_type == kind else None


def _new_attribute(mesh: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute:
    occupied = mesh.attributes.get(name)
    if occupied is not None:  # of another type or domain: not ours, and in the way
        mesh.attributes.remove(occupied)
    return mesh.attributes.new(name, kind, "POINT")
