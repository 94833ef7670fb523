# SPDX-License-Identifier: GPL-3.0-or-later
"""The pose sequence: shapes kept over time, as absolute shape keys that one F-curve plays.

Blocks, in the order of their place on the curve, which is what eval_time has to be to show them:

    Basis          0             the rest shape
    Before Poses   < FIRST       the shape before the sequence was begun, or the user's own key "Pose"
    poses          FIRST + 8 i   the keyed poses, in the order of time in which they were keyed
    hold, scratch  HOLD, SCRATCH only while an unkeyed pose is shown, see below

`eval_time` has one F-curve with a key for each keyed pose, whose value is the place of the pose's block; the
curve alone says when a pose is shown, so that the user times and eases them in Blender's own editors. A pose
whose key was duplicated there is shown, and edited, at several frames; one whose key was removed has none.
Keys with other values are the user's retiming and stay what they are. `Object.planar.poses` lists the poses
by the places of their blocks; what else is in the played range is no keyed pose.

The played range begins far above the blocks below it, and ends in a copy of its last shape far above that: a
curve that overshoots holds the first or the last pose, as at the ends of any sequence of absolute shape keys.

An unkeyed pose is written to the scratch block and shown by setting `eval_time`, which any frame change takes
back, as it does with every animated value. No curve reaches it: below it comes the hold.

Beginning changes only how shapes are stored. Without shape keys the rest shape becomes the Basis and the
object's own shape is kept in a block. A mesh with a Basis and at most one key "Pose", which is what posing
makes, keeps both. `clear` undoes exactly that. Other shape keys, drivers and actions are the user's and are
refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..model.frame import Array
from . import compat, points, pose_insertion
from .errors import Refusal
from .pose_blocks import (
    FIRST,
    HOLD,
    SAME_FRAME,
    SAME_PLACE,
    SCRATCH,
    add,
    block_at,
    keyed,
    own_curve,
    places,
    played,
    points_of,
    shown_curve,
    take_out,
)
from .shape_keys import POSE_KEY

if TYPE_CHECKING:
    from .shape import SceneShape

ON_A_COPY = "work on a copy of the object, with Apply All in the Shape Keys panel's menu"


def has_blocks(obj: bpy.types.Object) -> bool:
    """Whether the mesh has shape keys of a pose sequence."""
    keys = obj.data.shape_keys
    return keys is not None and any(block_at(keys, pose.at) is not None for pose in obj.planar.poses)


def is_ours(obj: bpy.types.Object) -> bool:
    """Whether the object shows a pose sequence."""
    return has_blocks(obj) and not obj.data.shape_keys.use_relative


def refusal(obj: bpy.types.Object) -> str | None:
    """Why poses of the object cannot be keyed, and what to do about it; None when they can."""
    keys = obj.data.shape_keys
    if keys is None:
        return None
    if obj.show_only_shape_key:
        return "Only the active shape key is shown: turn off Shape Key Lock in the Shape Keys panel"
    ours = has_blocks(obj)
    if ours and keys.use_relative:
        return "Keyed poses are absolute shape keys: turn off Relative in the Shape Keys panel"
    if not ours and not keys.use_relative:
        return f"The mesh has absolute shape keys of its own: {ON_A_COPY}"
    others = [block.name for block in keys.key_blocks[1:]]
    if not ours and (others not in ([], [POSE_KEY]) or places(keys).max() >= FIRST):
        names = ", ".join(others[:3]) + (", ..." if others[3:] else "")
        return f"The mesh has shape keys of its own ({names}): {ON_A_COPY}"
    return _animation_refusal(keys, ours)


def _animation_refusal(keys: bpy.types.Key, ours: bool) -> str | None:
    animation = keys.animation_data
    if animation is None:
        return None
    if animation.drivers:
        return "The shape keys have drivers: delete them in the Drivers editor"
    if animation.nla_tracks:
        return "The shape keys are animated in the Nonlinear Animation editor: delete their tracks there"
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


# -- reading


def frames_of(obj: bpy.types.Object, pose: int) -> list[float]:
    """The frames at which a keyed pose stands on the curve, in order."""
    timeline = keyed(obj.data.shape_keys)
    frames: list[float] = timeline[
        np.abs(timeline[:, 1] - obj.planar.poses[pose].at) < SAME_PLACE, 0
    ].tolist()
    return frames


def pose_at(obj: bpy.types.Object, frame: float) -> int | None:
    """The index of the pose that is keyed at a frame."""
    timeline = keyed(obj.data.shape_keys)
    for value in timeline[np.abs(timeline[:, 0] - frame) < SAME_FRAME, 1]:
        for index, pose in enumerate(obj.planar.poses):
            if abs(pose.at - value) < SAME_PLACE:
                return index
    return None


def shown_points(obj: bpy.types.Object) -> np.ndarray:
    """The shape that is shown at present, see scene/points.py: as Blender evaluates absolute keys.

    Raises Refusal between blocks that are not interpolated linearly.
    """
    keys = obj.data.shape_keys
    at = places(keys)
    time = keys.eval_time
    upper = int(np.searchsorted(at, time - SAME_PLACE))
    if upper == len(at) or upper == 0 or abs(at[upper] - time) < SAME_PLACE:
        return points_of(obj, keys.key_blocks[min(upper, len(at) - 1)])
    pair = keys.key_blocks[upper - 1], keys.key_blocks[upper]
    for block in pair:
        if block.interpolation != "KEY_LINEAR":
            raise Refusal(
                f"Shape key '{block.name}' is not interpolated linearly: choose Linear in its panel"
            )
    share = np.float32((time - at[upper - 1]) / (at[upper] - at[upper - 1]))
    low, high = (points_of(obj, block) for block in pair)
    return low * (np.float32(1.0) - share) + high * share


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
    return block_at(keys, at) if abs(keys.eval_time - at) < SAME_PLACE else None


# -- writing


def put(scene: SceneShape, shapes: Mapping[float, Array], *, throughout: bool = False) -> None:
    """Key poses: n x 2 positions of the cutout by frame. `throughout`: keys between those frames go away.

    A frame at which a pose is keyed gets the new one in its place, with its easing; the object's sequence is
    begun if it has none. `scene` is used up by this. Raises Refusal and ObjectGone, with nothing changed.
    """
    obj = scene.resolve()
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    coordinates = {float(frame): scene.coordinates(positions) for frame, positions in shapes.items()}
    if is_ours(obj):
        _drop_lost_poses(obj)
        drop_scratch(obj)
    else:
        _begin(obj, scene.rest_coordinates())
    if throughout:
        _unkey_between(obj, sorted(coordinates))
    new: dict[float, np.ndarray] = {}
    for frame, shape in coordinates.items():
        pose = pose_at(obj, frame)
        # A pose that is shown at other frames, too, stays as it is there.
        if pose is not None and len(frames_of(obj, pose)) == 1:
            block = block_at(obj.data.shape_keys, obj.planar.poses[pose].at)
            points.write_block(block, shape)
        else:
            new[frame] = shape
    if new:
        pose_insertion.insert(obj, new)
    latest = pose_at(obj, max(coordinates))
    if latest is not None:
        activate(obj, latest)
    _show_frame(obj)


def activate(obj: bpy.types.Object, pose: int) -> None:
    """Make a pose the active one, in our list and in Blender's, where Edit Mode edits it."""
    obj.planar.active_pose = pose
    keys = obj.data.shape_keys
    block = block_at(keys, obj.planar.poses[pose].at)
    if block is not None:
        obj.active_shape_key_index = keys.key_blocks.find(block.name)


def remove(obj: bpy.types.Object, pose: int) -> None:
    """Take a pose out of the sequence, and its keys; with the last one the sequence ends."""
    if len(obj.planar.poses) == 1:
        clear(obj)
        return
    drop_scratch(obj)
    keys = obj.data.shape_keys
    _remove_keys(keys, np.abs(keyed(keys)[:, 1] - obj.planar.poses[pose].at) < SAME_PLACE)
    _remove_pose(obj, pose)
    activate(obj, max(0, min(obj.planar.active_pose, len(obj.planar.poses) - 1)))
    _show_frame(obj)


def clear(obj: bpy.types.Object) -> None:
    """End the sequence: everything is as it was before it was begun, to the bit."""
    settings = obj.planar
    if is_ours(obj):
        keys = obj.data.shape_keys
        action = None if keys.animation_data is None else keys.animation_data.action
        keys.animation_data_clear()
        if action is not None and not action.users:
            bpy.data.actions.remove(action)
        for name in [block.name for block in keys.key_blocks if block.frame > FIRST - SAME_PLACE]:
            obj.shape_key_remove(keys.key_blocks[name])
        keys.eval_time = 0.0
        if settings.key_before < 0:
            shape = points_of(obj, keys.key_blocks[-1])
            obj.shape_key_clear()
            points.write(obj, shape)
        else:
            keys.use_relative = True
            obj.active_shape_key_index = settings.key_before
        points.update(obj)
    settings.poses.clear()
    settings.active_pose = 0


def show_unkeyed(obj: bpy.types.Object, coordinates: np.ndarray) -> None:
    """Show a shape until the frame changes."""
    keys = obj.data.shape_keys
    scratch = block_at(keys, SCRATCH)
    if scratch is not None and keys.eval_time == SCRATCH:
        points.write_block(scratch, coordinates)
        return
    drop_scratch(obj)  # of another frame: since then, the last pose may have become another
    add(obj, "Hold", HOLD, points_of(obj, played(keys)[-1]))
    add(obj, "Unkeyed", SCRATCH, coordinates)


def drop_scratch(obj: bpy.types.Object) -> None:
    """Take the place of unkeyed poses away. What is shown then is for the caller to say."""
    for place in (SCRATCH, HOLD):
        block = block_at(obj.data.shape_keys, place)
        if block is not None:
            take_out(obj, block)


def _remove_pose(obj: bpy.types.Object, pose: int) -> None:
    block = block_at(obj.data.shape_keys, obj.planar.poses[pose].at)
    if block is not None:
        obj.shape_key_remove(block)
    obj.planar.poses.remove(pose)


def _remove_keys(keys: bpy.types.Key, chosen: np.ndarray) -> None:
    """Remove those keys of the curve that are chosen (a mask)."""
    if chosen.any():
        curve = own_curve(keys)
        for index in np.flatnonzero(chosen)[::-1].tolist():
            curve.keyframe_points.remove(curve.keyframe_points[index], fast=True)
        curve.update()


def _unkey_between(obj: bpy.types.Object, frames: list[float]) -> None:
    """Remove all keys from the first to the last of the frames but those at them, and what only they show."""
    keys = obj.data.shape_keys
    at = keyed(keys)[:, 0]
    kept = (np.abs(at[:, None] - np.array(frames)) < SAME_FRAME).any(axis=1)
    shown = [bool(frames_of(obj, pose)) for pose in range(len(obj.planar.poses))]
    _remove_keys(keys, (at > frames[0]) & (at < frames[-1]) & ~kept)
    for pose in reversed(range(len(shown))):
        if shown[pose] and not frames_of(obj, pose):
            _remove_pose(obj, pose)


def _show_frame(obj: bpy.types.Object) -> None:
    """Show what the curve says for the present frame."""
    keys = obj.data.shape_keys
    curve = shown_curve(keys)
    if curve is not None:
        keys.eval_time = curve.evaluate(bpy.context.scene.frame_current_final)
    points.update(obj)


def _begin(obj: bpy.types.Object, rest: np.ndarray) -> None:
    mesh, settings = obj.data, obj.planar
    settings.poses.clear()
    if mesh.shape_keys is None:
        shape = points.read(obj)
        settings.key_before = -1
        basis = obj.shape_key_add(name="Basis", from_mix=False)
        points.write_block(obj.shape_key_add(name="Before Poses", from_mix=False), shape)
        points.write_block(basis, rest)
        points.write(obj, rest)  # Blender keeps the Basis there
    else:
        settings.key_before = obj.active_shape_key_index
    mesh.shape_keys.use_relative = False


def _drop_lost_poses(obj: bpy.types.Object) -> None:
    """Poses whose blocks the user removed are no poses any more."""
    poses = obj.planar.poses
    for index in reversed(range(len(poses))):
        if block_at(obj.data.shape_keys, poses[index].at) is None:
            poses.remove(index)
