# SPDX-License-Identifier: GPL-3.0-or-later
"""What has been done to a mesh as a whole since it was last seen: its rest shape and its pins follow.

Blender takes the coordinates and the shape keys of a mesh along when a transform is applied, an origin is
set, objects are joined or all is edited, but not its attributes and what an object holds of pins. So the mesh
keeps the shape in which it was last seen, and the affine map that explains what it is now tells what was
done. An edit that no map explains, as of some vertices, leaves the rest shape as it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...model.plane.affine import Affine, affine_between
from ...model.plane.frame import Array32, Indices, Mask
from ...model.plane.rest import fitted
from ..sequence import pose_state, up_to_date
from ..storage import migration, points
from . import rest_shape, triangulation

# By owner: the mesh (session_uid) that the number was first seen on, as a duplicate gets another one; and
# whether that mesh had shape keys when it was last seen.
_meshes: dict[int, int] = {}
_keyed: dict[int, bool] = {}

ROUNDING = 1e-5  # of coordinates that Blender has transformed in float32
INTERPOLATED = 4  # an owner's number may be off by, as Blender's weights do not quite add up to 1


@dataclass(frozen=True)
class Joined:
    """What has come from another mesh by a join."""

    rows: Mask  # its vertices (count,)
    map: Affine | None  # that took it here, if one explains it
    turned_over: bool  # seen along the axes of the objects


def follow(obj: bpy.types.Object) -> dict[int, Joined]:
    """Make rest shape and pins follow what was done to the mesh; what was joined to it, by its owner.

    What has been joined belongs to the mesh from then on. Writes nothing where nothing was done.
    """
    if not is_followed(obj):
        return {}
    mesh = obj.data
    present, seen = rest_shape.reference(obj), rest_shape.seen_of(mesh)
    owners, rest = _owners(mesh), rest_shape.stored_of(mesh)
    if is_joined(owners) and _tidy(mesh, owners, present):
        rest_shape.write_owners(mesh, owners)
    joined = _take_in_all(obj, owners, rest, seen, present) if is_joined(owners) else {}
    rows = owners == owners[0]
    for part in joined.values():
        rows &= ~part.rows
    edited = seen is None or not np.array_equal(seen.view(np.int32), present.view(np.int32))
    done = None
    if edited and seen is not None:
        done = affine_between(seen[rows], present[rows])
        if done is not None:
            _carry(obj, done, done.turns_over(seen[rows]))
        if done is not None and _explains(done, seen[rows], present[rows]):
            up_to_date.carry(obj)
        if done is not None and rest is not None:
            rest[rows] = done.of(rest[rows])
    if rest is not None and (joined or done is not None):
        rest_shape.put_back(mesh, rest, owners)
    elif joined:
        rest_shape.write_owners(mesh, owners)
    if edited:
        rest_shape.see(mesh, present)
    _meshes.setdefault(int(owners[0]), mesh.session_uid)
    _keyed[int(owners[0])] = mesh.shape_keys is not None
    up_to_date.see(obj)
    return joined


def catch_up(obj: bpy.types.Object) -> None:
    """The same before an object is read, but for a join, which the pins have to be told of."""
    if is_followed(obj) and not is_joined(_owners(obj.data)):
        follow(obj)


def is_followed(obj: bpy.types.Object) -> bool:
    """Whether an object has anything of ours that has to follow, and may be changed."""
    if obj.type != "MESH" or obj.mode not in {"OBJECT", "WEIGHT_PAINT"} or not len(obj.data.vertices):
        return False
    mesh = obj.data
    if obj.library is not None or mesh.library is not None or mesh.override_library is not None:
        return False
    if rest_shape.owners_of(mesh) is None and rest_shape.stored_of(mesh) is None:
        if not obj.is_property_set("planar") or migration.is_newer(obj):
            return False
        return len(obj.planar.pins) > 0 or len(obj.planar.poses) > 0
    return not migration.is_newer(obj)


def is_joined(owners: Indices) -> bool:
    """Whether a mesh with these owners of its vertices has come from several."""
    return bool(((owners != owners[0]) & (owners != 0)).any())


def owner_of(mesh: bpy.types.Mesh) -> int:
    """The number of a mesh that has been followed."""
    owners = rest_shape.owners_of(mesh)
    return 0 if owners is None or not len(owners) else int(owners[0])


def was_keyed(owner: int) -> bool:
    """Whether a mesh with this number had shape keys when it was last seen; as if, where it never was."""
    return _keyed.get(owner, True)


def left_behind(owner: int) -> bpy.types.Mesh | None:
    """The mesh with this number that a join has left without a user."""
    for mesh in bpy.data.meshes:
        if not mesh.users - mesh.use_fake_user and owner_of(mesh) == owner:
            return mesh
    return None


def see(obj: bpy.types.Object) -> None:
    """What the mesh is now is as it was last seen: it has been changed by what follows it."""
    rest_shape.see(obj.data, rest_shape.reference(obj))
    _keyed[owner_of(obj.data)] = obj.data.shape_keys is not None
    up_to_date.see(obj)


def is_elsewhere(owner: int, mesh: bpy.types.Mesh) -> bool:
    """Whether an owner's number is that of another mesh of the file."""
    uid = _meshes.get(owner, mesh.session_uid)
    return uid != mesh.session_uid and any(
        other.session_uid == uid and other.users for other in bpy.data.meshes
    )


def forget() -> None:
    """Of another file nothing is known."""
    _meshes.clear()
    _keyed.clear()


def _owners(mesh: bpy.types.Mesh) -> Indices:
    """The owner of each vertex, by a number of the mesh's own."""
    owners = rest_shape.owners_of(mesh)
    if owners is None:
        owners = np.full(len(mesh.vertices), rest_shape.new_owner(), np.int32)
        rest_shape.write_owners(mesh, owners)
    elif is_elsewhere(int(owners[0]), mesh):
        owners[owners == owners[0]] = rest_shape.new_owner()
        rest_shape.write_owners(mesh, owners)
    return owners


def _tidy(mesh: bpy.types.Mesh, owners: Indices, present: Array32) -> bool:
    """Make owners out of what Blender has interpolated between them; whether there was any."""
    own = owners[0]
    odd = (owners != own) & (owners != 0) & ~np.isin(owners, list(_meshes))
    if not odd.any():
        return False
    rounded = odd & (np.abs(owners - own) <= INTERPOLATED)
    owners[rounded] = own
    faces = triangulation.faces_of(mesh, present)
    mine = np.isin(faces.parts, faces.parts[owners[faces.vertices] == own])
    mixed = np.intersect1d(np.flatnonzero(odd & ~rounded), faces.vertices[mine])
    owners[mixed] = 0  # between vertices with and without a rest
    return bool(rounded.any() or len(mixed))


def _take_in_all(
    obj: bpy.types.Object, owners: Indices, rest: Array32 | None, seen: Array32 | None, present: Array32
) -> dict[int, Joined]:
    """Make what has been joined to a mesh its own, in these arrays; what that was, by its owner."""
    if owners[0] == 0:  # nothing was known of the mesh, so it has not been posed
        owners[owners == 0] = rest_shape.new_owner()
    own = owners == owners[0]
    if rest is not None and not rest[own].any():
        rest[own] = present[own]
    joined = {}
    for owner in np.unique(owners[~own & (owners != 0)]).tolist():
        rows = owners == owner
        joined[owner] = _take_in(obj.data, rows, rest, seen, present)
        if rest is not None and pose_state.is_ours(obj) and not was_keyed(owner):
            _give_basis(obj, rows, rest, present)
    for part in joined.values():
        owners[part.rows] = owners[0]
    return joined


def _take_in(
    mesh: bpy.types.Mesh, rows: Mask, rest: Array32 | None, seen: Array32 | None, present: Array32
) -> Joined:
    """Bring the rest of what has been joined to where that is."""
    found = None if seen is None else affine_between(seen[rows], present[rows])
    unmoved = seen is not None and np.array_equal(seen[rows], present[rows])
    if unmoved:
        found = Affine(np.eye(3), np.zeros(3))
    if rest is not None and not rest[rows].any():  # it had none, but a Basis
        rest[rows] = present[rows]
    elif rest is not None and found is not None:
        rest[rows] = found.of(rest[rows])
    elif rest is not None:
        faces = triangulation.faces_of(mesh, present)
        for part in np.unique(faces.parts[rows[faces.vertices]]):
            of_part = faces.vertices[faces.parts == part]
            rest[of_part] = fitted(rest[of_part].astype(np.float64), present[of_part], scaled=True)
    over = found is not None and seen is not None and found.turns_over(seen[rows])
    return Joined(rows, found, over)


def _give_basis(obj: bpy.types.Object, rows: Mask, rest: Array32, present: Array32) -> None:
    """In a pose sequence the Basis is the rest; a join makes it of the shape that was shown."""
    present[rows] = rest[rows]
    points.write_block(obj.data.shape_keys.reference_key, present)
    points.write(obj, present)
    points.update(obj)


def _explains(done: Affine, before: Array32, after: Array32) -> bool:
    """Whether a map tells of all vertices where they are by now: what takes poses along takes in-betweens."""
    gap = np.abs(done.of(before) - after).max()
    return bool(gap <= ROUNDING * np.abs(after).max())


def _carry(moved: bpy.types.Object, done: Affine, turned_over: bool) -> None:
    """What is stored of the pins follows."""
    mesh = moved.data
    for place in mesh.planar_seen.places:
        place.place = done.of(np.array([place.place]))[0]
    for obj in bpy.data.objects:
        if obj.data == mesh and obj.is_property_set("planar"):
            for pin in obj.planar.pins:
                pin.target, pin.reached = done.of(np.array([pin.target, pin.reached]))
                pin.follow_axis = done.linear @ np.array(pin.follow_axis)
                if turned_over:
                    pin.angle = -pin.angle
        if obj.is_property_set("planar"):
            _carry_followers(obj, mesh, done)


def _carry_followers(obj: bpy.types.Object, mesh: bpy.types.Mesh, done: Affine) -> None:
    """Pins that follow places of a mesh stay beside them."""
    for pin in obj.planar.pins:
        if pin.follow_group and pin.follow is not None and pin.follow.data == mesh:
            offset = np.array(pin.follow_offset, np.float64).reshape(4, 4)
            offset[:3] = done.linear @ offset[:3] + np.outer(done.offset, offset[3])
            pin.follow_offset = offset.ravel()
