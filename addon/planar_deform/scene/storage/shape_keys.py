# SPDX-License-Identifier: GPL-3.0-or-later
"""Relative shape keys: which one is posed, what all of them show, and the posed one's share in it."""

from __future__ import annotations

import re

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array
from . import points
from .vertex_groups import members

POSE_KEY = "Pose"
_BAKED = re.compile(r"Frame (-?\d+)")
# Below this share of the shown shape a key is as good as off: its difference would be divided by the share,
# and float32 coordinates would lose what the eye can see.
LEAST_SHARE = 1e-3


def posed_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The shape key an action writes to: the active one, in place of the Basis the baked one of the frame.

    None when there is none, so that a Pose key has to be made.
    """
    key = obj.active_shape_key
    return key if key is not None and key != obj.data.shape_keys.reference_key else baked_key(obj)


def baked_name(frame: int) -> str:
    """The name of the key that a bake makes of a frame."""
    return f"Frame {frame}"


def baked_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The key that a bake has made of the present frame, if that is what is posed: the Basis is active."""
    keys, scene = obj.data.shape_keys, bpy.context.scene
    if obj.active_shape_key != keys.reference_key or obj.show_only_shape_key or scene.frame_subframe:
        return None
    key = keys.key_blocks.get(baked_name(scene.frame_current))
    return key if key is not None and _baked_frames(keys) else None


def _baked_frames(keys: bpy.types.Key) -> list[int]:
    """The frames of which a bake has made keys that are played."""
    curves = compat.curves_of(keys.animation_data)
    if not curves or len(keys.key_blocks) < 2 or not _BAKED.fullmatch(keys.key_blocks[1].name):
        return []
    names = (_BAKED.fullmatch(name) for name in keys.key_blocks.keys())  # noqa: SIM118
    return sorted(int(name[1]) for name in names if name is not None)


def _baked_refusal(obj: bpy.types.Object) -> str | None:
    """Why there is no key to be posed at the present frame, where a bake has made one of others."""
    keys, frame = obj.data.shape_keys, bpy.context.scene.frame_current_final
    frames = _baked_frames(keys)
    if not frames or baked_key(obj) is not None:
        return None
    before, after = [at for at in frames if at <= frame][-1:], [at for at in frames if at > frame][:1]
    where = " or ".join(str(at) for at in (*before, *after))
    return (
        f"The bake has no shape key for frame {frame:g}: go to frame {where}, or choose the key to pose "
        "in the Shape Keys panel"
    )


def refusal(obj: bpy.types.Object) -> str | None:
    """Why the object's shape keys cannot be posed, and what to do; None when they can or there are none."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    if not keys.use_relative and obj.planar.poses:  # which are found by the eval_times of their keys
        return "The shape keys of the poses have been re-timed: undo Re-Time Shape Keys"
    if not keys.use_relative:
        return "Absolute shape keys cannot be posed: turn on Relative in the Shape Keys panel"
    key = posed_key(obj)
    if key is None:
        if obj.show_only_shape_key:
            return "Only the Basis is shown: turn off Shape Key Lock in the Shape Keys panel"
        return _baked_refusal(obj)
    if key.mute:
        return f"Shape key '{key.name}' is muted: tick its box in the Shape Keys panel"
    if key.lock_shape:
        return f"Shape key '{key.name}' is locked: open its lock in the Shape Keys panel"
    if key.value == 0.0 and not obj.show_only_shape_key:
        return f"Shape key '{key.name}' has value 0, so a pose in it would not show: raise its value"
    return None


def shown_points(obj: bpy.types.Object) -> Array:
    """The shape (storage/points.py) that the keys show together, as Blender evaluates relative keys."""
    keys = obj.data.shape_keys
    basis = points.read_block(obj, keys.reference_key).astype(np.float64)
    if obj.show_only_shape_key:
        only = obj.active_shape_key
        if only.mute or only == keys.reference_key:
            return basis
        return basis + (points.read_block(obj, only) - basis) * mask(obj, only)
    shown = basis.copy()
    for key in keys.key_blocks:
        if counts(keys, key):
            offsets = points.read_block(obj, key).astype(np.float64)
            offsets -= points.read_block(obj, key.relative_key)
            shown += offsets * (key.value * mask(obj, key))
    return shown


def share_of_posed_key(obj: bpy.types.Object) -> Array:
    """How much the shown shape moves when the posed key does, count x 1: d(shown) / d(posed key).

    Its own value through its mask, less the values of the keys that are relative to it.
    """
    keys = obj.data.shape_keys
    posed = posed_key(obj)
    share = np.zeros((points.count(obj), 1))
    if posed is None:
        return share + 1.0  # the Pose key that will be made has value 1
    if obj.show_only_shape_key:
        return share + weight_of_posed_key(obj)
    for key in keys.key_blocks:
        if counts(keys, key):
            weight = key.value * mask(obj, key)
            share += weight * ((key == posed) - (key.relative_key == posed))
    return share


def under_posed_key(obj: bpy.types.Object) -> bpy.types.ShapeKey:
    """The key from which the difference of the posed key, which there is, is taken."""
    keys = obj.data.shape_keys
    if obj.show_only_shape_key:
        return keys.reference_key
    posed = posed_key(obj)
    assert posed is not None
    return posed.relative_key


def weight_of_posed_key(obj: bpy.types.Object) -> Array | float:
    """The share of its difference that the posed key adds to the shown shape, count x 1 or one number."""
    posed = posed_key(obj)
    assert posed is not None
    return mask(obj, posed) * (1.0 if obj.show_only_shape_key else posed.value)


def check_share(obj: bpy.types.Object, share: Array) -> None:
    """Refuse when the posed key does not show at some of the vertices with these shares."""
    if len(share) and np.abs(share).min() >= LEAST_SHARE:
        return
    key = posed_key(obj)
    name = key.name if key is not None else POSE_KEY
    if key is not None and key.vertex_group in obj.vertex_groups:
        raise Refusal(
            f"Vertex group '{key.vertex_group}' masks shape key '{name}' where the drawing has vertices: "
            "clear the key's vertex group"
        )
    raise Refusal(
        f"A pose in shape key '{name}' would not show: raise its value and check the keys relative to it"
    )


def add_pose_key(obj: bpy.types.Object) -> bpy.types.ShapeKey:
    """Add and activate a key at value 1 that starts as the Basis, so that the shown shape stays as it is."""
    key = obj.shape_key_add(name=POSE_KEY, from_mix=False)
    # A new key copies the mesh's own coordinates, which need not be the Basis.
    points.write_block(key, points.read_block(obj, obj.data.shape_keys.reference_key))
    key.value = 1.0  # 0 in 4.2, 1 in 5.2
    obj.active_shape_key_index = len(obj.data.shape_keys.key_blocks) - 1
    return key


def counts(keys: bpy.types.Key, key: bpy.types.ShapeKey) -> bool:
    """Whether one of relative keys adds to what is shown."""
    return key != keys.reference_key and not key.mute and key.value != 0.0


def mask(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> Array | float:
    """The key's mask, count x 1, or 1.0: a vertex group that is missing masks nothing."""
    group = members(obj, [key.vertex_group]).get(key.vertex_group) if key.vertex_group else None
    if group is None:
        return 1.0
    rows, weights = group
    result = np.zeros((len(obj.data.vertices), 1))
    result[rows, 0] = weights
    return result
