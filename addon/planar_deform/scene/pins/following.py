# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins and poses follow what has been done to their mesh, in the order in which one depends on the other."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np

from ..objects import mesh_edits, rest_shape
from ..objects.mesh_edits import Joined
from ..sequence import joined_parts, merging, up_to_date
from ..sequence.joined_parts import Came
from . import joining, pin_list, places


def follow(obj: bpy.types.Object) -> list[str]:
    """After an update of a mesh object: a join, an edit, a transform, a change of its groups.

    Tells what a join could not keep.
    """
    pinned = pin_list.has_pins(obj)
    if pinned:
        joining.undone(obj)
        pin_list.sync(obj)
    if not mesh_edits.is_followed(obj):
        return []
    owner, lost = mesh_edits.owner_of(obj.data), []
    keyed = owner > 0 and mesh_edits.was_keyed(owner)
    fewer = len(obj.data.vertices) < obj.data.planar_seen.counts[0]
    joined = mesh_edits.follow(obj)
    if pinned and owner and fewer and not joined:
        joining.part(obj, owner)
    if joined:
        joining.take_in(obj, joined)
        lost = _merge(obj, owner, keyed, joined)
    if pin_list.has_pins(obj):
        places.follow(obj)
        joining.remember(obj)
    joined_parts.remember(obj, mesh_edits.owner_of(obj.data), up_to_date.seen(obj))
    return lost


def undone() -> None:
    """Undo has brought other meshes."""
    merging.undone()


def forget() -> None:
    """Of another file nothing is known."""
    mesh_edits.forget()
    up_to_date.forget()
    joining.forget()
    joined_parts.forget()
    merging.forget()


def _merge(obj: bpy.types.Object, owner: int, keyed: bool, joined: Mapping[int, Joined]) -> list[str]:
    """Make the poses of what has been joined those of the object; what is lost.

    `owner`: of its own mesh, which was `keyed` or not.
    """
    mesh = obj.data
    if mesh.shape_keys is None:
        return []
    came = sorted((_came(*one) for one in joined.items()), key=lambda one: one.rows.start)
    rest = rest_shape.stored_of(mesh)
    if rest is not None:
        own = [slice(0, came[0].rows.start)] if keyed else []
        for rows in (*own, *(one.rows for one in came if one.keys is not None)):
            rest[rows] = 0.0
    begun = len(obj.planar.poses) == 0
    lost = merging.merge(obj, owner, came, rest)
    if begun and len(obj.planar.poses):  # without which the end of the sequence would leave no rest
        rest_shape.put_back(mesh, rest_shape.basis_or_stored(obj), rest_shape.owners_of(mesh))
    mesh_edits.see(obj)
    return lost


def _came(owner: int, part: Joined) -> Came:
    """What is known of a part by its owner."""
    found = np.flatnonzero(part.rows)
    mesh = mesh_edits.left_behind(owner)
    count = len(mesh.vertices) if mesh is not None else int(found[-1] - found[0]) + 1
    rows = slice(int(found[0]), int(found[0]) + count)
    return Came(rows, None if mesh is None else mesh.shape_keys, owner)
