# SPDX-License-Identifier: GPL-3.0-or-later
"""What the list of poses does with one of them: retime it, give it another shape, key it once more."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME
from ..storage import pin_paths
from ..storage.points import read_block, update, write_block
from . import playback, pose_curve, pose_edit, pose_showing, pose_state
from .key_ease import of_new_keys
from .playback import Steps, blocks_of, eval_times_of, inbetween_name, relay
from .pose_blocks import SPACING, block_at, keyed, own_curve, shown_curve
from .pose_insertion import close_up, put_in, shown_before


def alike(obj: bpy.types.Object, pose: int, objects: Iterable[bpy.types.Object]) -> dict[str, int]:
    """A pose of an object, and those of others that are first shown at the same frame: by their names."""
    found = {obj.name: pose}
    frames = pose_state.frames_of(obj, pose)
    for other in objects:
        if other == obj or not frames or not pose_state.is_ours(other):
            continue
        index = pose_state.pose_at(other, frames[0])
        if index is not None and abs(pose_state.frames_of(other, index)[0] - frames[0]) < SAME_FRAME:
            found[other.name] = index
    return found


def retiming(obj: bpy.types.Object, pose: int, frame: float) -> Steps:
    """Show a pose at another frame, step by step: the first one of its keys is moved there, with its easing.

    One that goes past others is played in their order from then on; what is generated stays where it is, and
    is stale there. A pose without a key is keyed. Raises Refusal, with nothing changed. Yields the share
    done, see playback.together().
    """
    reason = pose_state.refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    keys = obj.data.shape_keys
    record = obj.planar.poses[pose]
    timeline = keyed(keys)
    mine = np.flatnonzero(np.abs(timeline[:, 1] - record.at) < SAME_EVAL_TIME)
    if len(mine) and abs(timeline[mine[0], 0] - frame) < SAME_FRAME:
        return
    if (np.abs(timeline[:, 0] - frame) < SAME_FRAME).any():
        raise Refusal(f"Frame {frame:g} has a key: move that away first")
    others = np.delete(timeline, mine[:1], axis=0)
    was_unkeyed = pose_state.unkeyed(obj)
    in_turn = len(mine) > 0 and (others[:, 0] < frame).sum() == mine[0]
    if in_turn or len(mine) > 1:
        yield 1.0
        _move_key(own_curve(keys), int(mine[0]), frame)
    else:
        pose_state.block_of(obj, pose)
        yield from _reorder(obj, record.at, others, mine, frame)
    pose_showing.show(obj, was_unkeyed)


def _move_key(curve: bpy.types.FCurve, index: int, frame: float) -> None:
    point = curve.keyframe_points[index]
    by = frame - point.co[0]
    point.handle_left[0] += by
    point.handle_right[0] += by
    point.co[0] = frame
    curve.update()


def _reorder(
    obj: bpy.types.Object, eval_time: float, others: Array32, mine: NDArray[np.intp], frame: float
) -> Steps:
    """Play the pose at an eval_time where it belongs at a frame, among these other keys, and key it there."""
    blocks = blocks_of(obj)
    block = next(block for block in blocks if block.source == eval_time)
    blocks.remove(block)
    block.free = 0
    for other in blocks:
        if other.pose is not None:
            other.pose["order_before"] = 0  # they are put in another order now
    assert block.pose is not None  # a listed one
    block.pose["order_before"] = 0
    blocks = close_up(blocks)
    earlier = others[others[:, 0] < frame]
    put_in(obj.data.shape_keys, blocks, block, shown_before(blocks, earlier), frame, earlier)
    blocks = close_up(blocks)
    to = eval_times_of(blocks)[blocks.index(block)]

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        keys = obj.data.shape_keys
        offsets = _offsets(keys, int(mine[0])) if len(mine) else None
        stays = np.abs(old - eval_time) > SAME_EVAL_TIME
        playback.follow(obj, old[stays], new[stays])
        if offsets is None:
            pose_curve.key(obj, {frame: float(to)}, of_new_keys(obj))
            return
        curve = own_curve(keys)
        assert curve is not None  # its keys are `mine`
        point = curve.keyframe_points[int(mine[0])]
        point.co[1] = to
        point.handle_left[1], point.handle_right[1] = to + offsets[0], to + offsets[1]
        _move_key(curve, int(mine[0]), frame)

    return relay(obj, blocks, then)


def _offsets(keys: bpy.types.Key, index: int) -> tuple[float, float]:
    curve = own_curve(keys)
    assert curve is not None  # it has that key
    point = curve.keyframe_points[index]
    return point.handle_left[1] - point.co[1], point.handle_right[1] - point.co[1]


def rename_blocks(obj: bpy.types.Object, pose: bpy.types.PropertyGroup) -> None:
    """Call a pose's shape key, and what is generated behind it, by its name; no name is there twice."""
    keys = obj.data.shape_keys
    block = block_at(keys, pose.at)
    if block is None or block.name == pose.name:
        return
    before, block.name = block.name, pose.name
    for other in obj.planar.poses:
        if other.copy_of == before:
            other.copy_of = block.name
    pin_paths.rename_pose(obj, before, block.name)
    for number in range(1, pose.generated + 1):
        inbetween = block_at(keys, pose.at + number * SPACING)
        if inbetween is not None and inbetween.name == inbetween_name(before, number):
            inbetween.name = inbetween_name(block.name, number)
    pose.name = block.name  # which calls this again, with nothing to do


def giving_shape(obj: bpy.types.Object, pose: int, shape: Array32) -> Steps:
    """Give a pose another shape. Raises Refusal, with nothing changed; yields as playback.together() asks."""
    block = pose_state.block_of(obj, pose)
    if block.lock_shape:
        raise Refusal(f"Shape key '{block.name}' is locked: open its lock in the Shape Keys panel")
    yield 1.0
    write_block(block, shape)
    update(obj)


def duplicating(obj: bpy.types.Object, pose: int, frame: float) -> Steps:
    """Key a pose once more, as one of its own, at a frame that has none, as pose_edit.put_coordinates().

    Raises Refusal.
    """
    if (np.abs(keyed(obj.data.shape_keys)[:, 0] - frame) < SAME_FRAME).any():
        raise Refusal(f"Frame {frame:g} has a key: go to a frame without one")
    shape = read_block(obj, pose_state.block_of(obj, pose))
    yield from pose_edit.put_coordinates(obj, {frame: shape})


def step_of(obj: bpy.types.Object) -> int:
    """For how many frames each one that is shown stays."""
    curve = shown_curve(obj.data.shape_keys)
    steps = [] if curve is None else [m for m in curve.modifiers if m.type == "STEPPED" and not m.mute]
    return round(steps[0].frame_step) if steps else 1


def setting_step(obj: bpy.types.Object, step: int) -> Steps:
    """Show every frame for `step` frames, counted from the first key. Yields as playback.together() asks."""
    curve = own_curve(obj.data.shape_keys)
    if curve is None:
        raise Refusal("The poses have no curve: key one with Key Pose")
    was_unkeyed = pose_state.unkeyed(obj)
    yield 1.0
    for modifier in [modifier for modifier in curve.modifiers if modifier.type == "STEPPED"]:
        curve.modifiers.remove(modifier)
    if step > 1:
        modifier = curve.modifiers.new("STEPPED")
        modifier.frame_step = step
        modifier.frame_offset = curve.keyframe_points[0].co[0]
    curve.update()
    pose_showing.show(obj, was_unkeyed)
