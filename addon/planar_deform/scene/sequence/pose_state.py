# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pose sequence is at present: whether there is one, what it shows, why it cannot be changed."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME
from ..storage.shape_keys import POSE_KEY
from .pose_blocks import FIRST, HOLD, blended, block_at, eval_times, keyed, played_value
from .strips import strip_of

ON_A_COPY = "work on a copy of the object, with Apply All in the Shape Keys panel's menu"


def has_blocks(obj: bpy.types.Object) -> bool:
    """Whether the object has shape keys of a pose sequence."""
    keys = obj.data.shape_keys
    return keys is not None and _has_blocks(obj, eval_times(keys))


def _has_blocks(obj: bpy.types.Object, there: Array) -> bool:
    """Whether any pose's shape key is among those that are there, told by their eval_times."""
    return any(_is_there(there, pose.at) for pose in obj.planar.poses)


def _is_there(there: Array, eval_time: float) -> bool:
    return bool(np.abs(there - eval_time).min() < SAME_EVAL_TIME)


def is_ours(obj: bpy.types.Object) -> bool:
    """Whether the object shows a pose sequence."""
    return has_blocks(obj) and not obj.data.shape_keys.use_relative


def absence(obj: bpy.types.Object) -> str | None:
    """Why nothing can be done with the object's poses: that there are none; None when there are some."""
    return None if is_ours(obj) else "No poses are keyed: use Key Pose first"


def refusal(obj: bpy.types.Object) -> str | None:
    """Why poses of the object cannot be keyed, and what to do about it; None when they can."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    if obj.show_only_shape_key:
        return "Only the active shape key is shown: turn off Shape Key Lock in the Shape Keys panel"
    there = eval_times(keys)
    ours = _has_blocks(obj, there)
    reason = _own_blocks_refusal(keys, there) if ours else _foreign_blocks_refusal(keys, there)
    return reason or animation_refusal(keys, ours=ours)


def _own_blocks_refusal(keys: bpy.types.Key, there: Array) -> str | None:
    if keys.use_relative:
        return "Keyed poses are absolute shape keys: turn off Relative in the Shape Keys panel"
    if not _is_there(there, 0.0):
        return "The Basis of the poses is gone, which is the rest shape: undo deleting that shape key"
    out_of_order = np.flatnonzero(np.diff(there) < SAME_EVAL_TIME)
    if len(out_of_order):
        name = keys.key_blocks[int(out_of_order[0]) + 1].name
        return f"Shape key '{name}' came from another object's poses: undo joining them, or clear those first"
    return None


def _foreign_blocks_refusal(keys: bpy.types.Key, there: Array) -> str | None:
    if not keys.use_relative:
        return f"The object has absolute shape keys of its own: {ON_A_COPY}"
    others = [block.name for block in keys.key_blocks[1:]]
    if others not in ([], [POSE_KEY]) or there.max() >= FIRST:
        names = ", ".join(others[:3]) + (", ..." if others[3:] else "")
        return f"The object has shape keys of its own ({names}): {ON_A_COPY}"
    return None


def animation_refusal(keys: bpy.types.Key, *, ours: bool = True) -> str | None:
    """Why the curve of shape keys, of a sequence if they are `ours`, cannot be edited; None when it can."""
    animation = keys.animation_data
    if animation is None:
        return None
    if animation.drivers:
        return "The shape keys have drivers: delete them in the Drivers editor"
    if animation.nla_tracks:
        return _strips_refusal(keys)
    if animation.action is None:
        return None
    if not ours:
        return (
            f"The shape keys have an action of their own ('{animation.action.name}'): unlink it in the "
            "Dope Sheet's Shape Key Editor, or work on a copy of the object"
        )
    if not animation.action.is_editable:
        return "The poses' action is linked from a library: make it local in the Dope Sheet"
    for curve in compat.curves_of(animation) or ():
        if curve.data_path != "eval_time":
            return "The poses' action animates something else, too: delete its other curves in the Dope Sheet"
        if curve.lock or (curve.group is not None and curve.group.lock):
            return "The poses' curve is locked: open its lock in the Graph Editor"
        if curve.sampled_points:
            return "The poses' curve is made of samples: turn them into keys in the Graph Editor"
    return None


def _strips_refusal(keys: bpy.types.Key) -> str:
    strip = strip_of(keys)
    if strip is None:
        return "The shape keys are animated in the Nonlinear Animation editor: delete their tracks there"
    return (
        "A strip in the Nonlinear Animation editor plays the poses: to edit them, choose the action "
        f"'{strip.action.name}' in the Dope Sheet's Shape Key Editor, then delete the strip's track"
    )


def block_of(obj: bpy.types.Object, pose: int) -> bpy.types.ShapeKey:
    """The block of a pose (its index). Raises Refusal where the user has removed it."""
    block = block_at(obj.data.shape_keys, obj.planar.poses[pose].at)
    if block is None:
        raise Refusal(f"The shape key of pose '{obj.planar.poses[pose].name}' is gone: delete the pose")
    return block


def frames_of(obj: bpy.types.Object, pose: int) -> list[float]:
    """The frames at which a keyed pose stands on the curve, in order."""
    return frames_at(obj, obj.planar.poses[pose].at)


def frames_at(obj: bpy.types.Object, eval_time: float) -> list[float]:
    """The frames at which keys of the curve have this value, in order."""
    timeline = keyed(obj.data.shape_keys)
    frames: list[float] = timeline[np.abs(timeline[:, 1] - eval_time) < SAME_EVAL_TIME, 0].tolist()
    return frames


def pose_at(obj: bpy.types.Object, frame: float) -> int | None:
    """The index of the pose that is keyed at a frame."""
    timeline = keyed(obj.data.shape_keys)
    for value in timeline[np.abs(timeline[:, 0] - frame) < SAME_FRAME, 1]:
        for index, pose in enumerate(obj.planar.poses):
            if abs(pose.at - value) < SAME_EVAL_TIME:
                return index
    return None


def shown_points(obj: bpy.types.Object) -> Array32:
    """The shape that is shown at present, see storage/points.py. Raises Refusal as pose_blocks.blended()."""
    return blended(obj, obj.data.shape_keys.eval_time)


def shape_at(obj: bpy.types.Object, frame: float) -> Array32:
    """The shape that the sequence shows at any frame, see storage/points.py. Raises Refusal as blended()."""
    return blended(obj, played_value(obj.data.shape_keys, frame))


def unkeyed(obj: bpy.types.Object) -> bool:
    """Whether what is shown is a pose that no frame has."""
    return is_ours(obj) and obj.data.shape_keys.eval_time > HOLD


def keyed_pose_shown(obj: bpy.types.Object, frame: float) -> bpy.types.ShapeKey | None:
    """The block of the pose that is keyed at this frame, if that is what is shown."""
    pose = pose_at(obj, frame)
    if pose is None:
        return None
    at = obj.planar.poses[pose].at
    keys = obj.data.shape_keys
    return block_at(keys, at) if abs(keys.eval_time - at) < SAME_EVAL_TIME else None
