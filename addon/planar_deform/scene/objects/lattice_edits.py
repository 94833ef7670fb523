# SPDX-License-Identifier: GPL-3.0-or-later
"""A lattice keeps its transform when Blender applies it, or sets its origin.

Blender takes the points of a lattice along then, but not where they are at rest, which is fixed in the
lattice's own space: what had been its place would be a pose. So the lattice keeps how it was last seen, and
where its points have been moved as much as its transform was given up, both are given back.
"""

from __future__ import annotations

from functools import lru_cache

import bpy
import numpy as np
from mathutils import Matrix

from ...model.plane.affine import Affine
from ...model.plane.frame import Array, Array32, mapped
from ..sequence import up_to_date
from ..storage import migration, points

SUMS = 8
ROUNDING = 1e-5  # of coordinates that Blender has transformed in float32

# By session_uid: the shape and the transform that were given up when that was last told.
_told: dict[int, bytes] = {}


def follow(obj: bpy.types.Object) -> str | None:
    """After an update of a lattice that may be changed: undo what has been applied; what is to be told."""
    if not is_followed(obj):
        return None
    before = _matrix(obj.planar.seen_basis)
    applied = _applied(obj, before)
    told = None
    if applied is not None:
        state = points.read(obj).tobytes() + _flat(obj.matrix_basis).tobytes()
        if _told.get(obj.session_uid) != state:  # undo and redo come by it again
            _told[obj.session_uid] = state
            told = f"'{obj.name}' keeps its transform: without it, what it deforms would jump"
        _put_back(obj, before, applied)
    see(obj)
    return told


def see(obj: bpy.types.Object) -> None:
    """Remember a lattice as it is now. Writes nothing where it is as it was last seen."""
    settings = obj.planar
    basis, sums = _flat(obj.matrix_basis), _sums(_reference(obj)).ravel()
    if not np.array_equal(basis, np.array(settings.seen_basis, np.float32)):
        settings.seen_basis = basis.tolist()
    if not np.array_equal(sums, np.array(settings.seen_sums, np.float32)):
        settings.seen_sums = sums.tolist()
    up_to_date.see(obj)


def is_followed(obj: bpy.types.Object) -> bool:
    """Whether an object is a lattice that has anything of ours, and may be changed."""
    if obj.type != "LATTICE" or obj.mode != "OBJECT" or not obj.is_property_set("planar"):
        return False
    data = obj.data
    if obj.library is not None or data.library is not None or data.override_library is not None:
        return False
    return data.users - data.use_fake_user == 1 and not migration.is_newer(obj)


def forget() -> None:
    """Of another file nothing is known."""
    _told.clear()


def _applied(obj: bpy.types.Object, before: Array) -> Affine | None:
    """What has taken the points along since they were last seen, if the transform was given up for it."""
    now = _matrix(_flat(obj.matrix_basis))
    if np.array_equal(before, now) or not np.linalg.det(before) or not np.linalg.det(now):
        return None
    change = np.linalg.inv(now) @ before
    applied = Affine(change[:3, :3], change[:3, 3])
    shape = _reference(obj)
    old, new = np.array(obj.planar.seen_sums, np.float64).reshape(SUMS, 3), _sums(shape).astype(np.float64)
    size = float(np.abs(shape).max(initial=0.0)) + float(np.abs(old).max())
    if np.abs(old - new).max() <= ROUNDING * size:  # it has been moved, and nothing else
        return None
    return applied if np.abs(applied.of(old) - new).max() <= ROUNDING * size else None


def _put_back(obj: bpy.types.Object, before: Array, applied: Affine) -> None:
    """Take back what was applied, in all shapes of the lattice; its children stay where they are."""
    parent = np.array(obj.matrix_world, np.float64) @ np.linalg.inv(_matrix(_flat(obj.matrix_basis)))
    children = [(child, np.array(child.matrix_parent_inverse, np.float64)) for child in obj.children]
    world = np.array(obj.matrix_world, np.float64)
    shown = points.read(obj)
    points.write(obj, _back(shown, applied))
    keys = obj.data.shape_keys
    for block in () if keys is None else keys.key_blocks:
        points.write_block(block, _back(points.read_block(obj, block), applied))
    obj.matrix_basis = Matrix(before.tolist())
    for child, inverse in children:
        child.matrix_parent_inverse = Matrix((np.linalg.inv(parent @ before) @ world @ inverse).tolist())
    up_to_date.carry(obj)
    points.update(obj)


def _back(shape: Array32, applied: Affine) -> Array32:
    inverse = np.linalg.inv(applied.linear)
    back: Array32 = mapped(shape.astype(np.float64) - applied.offset, inverse).astype(np.float32)
    return back


def _reference(obj: bpy.types.Object) -> Array32:
    keys = obj.data.shape_keys
    return points.read(obj) if keys is None else points.read_block(obj, keys.reference_key)


def _sums(shape: Array32) -> Array32:
    """Weighted means of the points, all of which an affine map of the points takes along (SUMS x 3)."""
    sums: Array32 = mapped(shape.astype(np.float64).T, _weights(len(shape))).T.astype(np.float32)
    return sums


@lru_cache(maxsize=4)
def _weights(count: int) -> Array:
    """Any that are all different; each row adds up to 1."""
    weights = 1.0 + np.sin(np.outer(np.arange(1, SUMS + 1), np.arange(count)))
    shares: Array = weights / weights.sum(axis=1, keepdims=True)
    return shares


def _flat(matrix: object) -> Array32:
    found: Array32 = np.array(matrix, np.float32).ravel()
    return found


def _matrix(values: object) -> Array:
    found: Array = np.array(values, np.float64).reshape(4, 4)
    return found
