# SPDX-License-Identifier: GPL-3.0-or-later
"""New poses in a pose sequence: a block for each in the order of time, and a key of the curve."""

from __future__ import annotations

import itertools
from collections.abc import Container, Iterator, Mapping

import bpy
import numpy as np

from ...model.plane.frame import Array, Array32, Mask
from ...model.timing.ease import LINEAR
from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME
from ..storage import pin_paths
from ..storage.shape_keys import POSE_KEY
from . import pose_curve
from .key_ease import of_new_keys
from .playback import Block, Steps, blocks_of, eval_times_of, follow, relay
from .pose_blocks import keyed


def insert(obj: bpy.types.Object, shapes: Mapping[float, Array32], *, throughout: bool = False) -> Steps:
    """Key a pose for each shape (by frame; see storage/points.py), step by step as playback.relay().

    A pose that is keyed at such a frame, and nowhere else, gets the shape. Every other one comes after what
    the curve shows before its frame, in the place of the generated shape if one is shown there exactly.
    `throughout`: keys between the frames go away, with what only they show and what is generated there; the
    new ones are linear, as the shapes are the motion themselves.
    """
    keys = obj.data.shape_keys
    timeline = keyed(keys)
    blocks = blocks_of(obj)
    removed = np.zeros(len(timeline), bool)
    if throughout:
        removed = _between(timeline, sorted(shapes))
        blocks = _without(keys, blocks, timeline, removed, sorted(shapes))
        timeline = timeline[~removed]
    new: dict[float, Block] = {}
    latest: float | None = None
    for frame in sorted(shapes):
        block = _keyed_only_there(blocks, timeline, frame)
        if block is not None:
            block.shape = shapes[frame]
            continue
        earlier = timeline[timeline[:, 0] < frame - SAME_FRAME]
        if latest is not None and not (len(earlier) and earlier[-1, 0] > latest):
            behind: Block | None = new[latest]
        else:
            behind = shown_before(blocks, earlier)
        new[frame] = Block("", shapes[frame], pose={})
        put_in(keys, blocks, new[frame], behind, frame, earlier)
        latest = frame
    _name(keys, new)
    at = eval_times_of(blocks).tolist()
    keyed_at = {frame: at[blocks.index(block)] for frame, block in new.items()}

    def then(obj: bpy.types.Object, old: Array, eval_times: Array) -> None:
        pose_curve.remove_keys(obj.data.shape_keys, removed)
        follow(obj, old, eval_times)
        for block in new.values():
            pin_paths.forget_pose(obj, block.name)  # those of an earlier pose of that name
        if keyed_at:
            pose_curve.key(obj, keyed_at, LINEAR if throughout else of_new_keys(obj))

    return relay(obj, blocks, then)


def _between(timeline: Array32, frames: list[float]) -> Mask:
    """The keys from the first to the last of the frames but those at them."""
    at = timeline[:, 0]
    kept = (np.abs(at[:, None] - np.array(frames)) < SAME_FRAME).any(axis=1)
    return np.asarray((at > frames[0]) & (at < frames[-1]) & ~kept)


def _without(
    keys: bpy.types.Key, blocks: list[Block], timeline: Array32, removed: Mask, frames: list[float]
) -> list[Block]:
    """The blocks without the poses that only the removed keys show, and without what is generated there."""

    def shown(block: Block, rows: Array32) -> bool:
        return bool((np.abs(rows[:, 1] - block.stands_at) < SAME_EVAL_TIME).any())

    low = high = 0.0
    if len(timeline) and any(block.inbetween for block in blocks):
        low, high = (pose_curve.value_at(keys, frame) for frame in (frames[0], frames[-1]))
    result = []
    for block in blocks:
        if block.inbetween:
            gone = low < block.stands_at < high
        else:
            gone = block.pose is not None and shown(block, timeline[removed])
            gone = gone and not shown(block, timeline[~removed])
        if not gone:
            result.append(block)
        elif not block.inbetween:
            block.free = 0
    return close_up(result)


def close_up(blocks: list[Block]) -> list[Block]:
    """These blocks as a sequence: nothing generated before the first pose or behind the last one."""
    others = [index for index, block in enumerate(blocks) if not block.inbetween]
    kept = blocks[others[0] : others[-1] + 1] if others else []
    if kept:
        kept[0].free = 0
    return kept


def _keyed_only_there(blocks: list[Block], timeline: Array32, frame: float) -> Block | None:
    """The pose that is keyed at this frame and at no other."""
    values = timeline[np.abs(timeline[:, 0] - frame) < SAME_FRAME, 1]
    for block in blocks if len(values) else ():
        if block.pose is None or block.source is None:
            continue
        there = (np.abs(values - block.source) < SAME_EVAL_TIME).any()
        if there and (np.abs(timeline[:, 1] - block.source) < SAME_EVAL_TIME).sum() == 1:
            return block
    return None


def shown_before(blocks: list[Block], earlier: Array32) -> Block | None:
    """The last block that is not behind what the last of these keys shows."""
    if not len(earlier):
        return None
    shown = earlier[-1, 1] + SAME_EVAL_TIME
    passed = [block for block in blocks if block.source is not None and block.source <= shown]
    return passed[-1] if passed else None


def put_in(
    keys: bpy.types.Key,
    blocks: list[Block],
    new: Block,
    behind: Block | None,
    frame: float,
    earlier: Array32,
) -> None:
    """Put a pose for a frame in behind a block (None: first), and behind what is generated and shown earlier.

    It takes the place of the generated shape that is shown at the frame. `earlier`: the keys before that.
    """
    index = 0 if behind is None else blocks.index(behind) + 1
    value = pose_curve.value_at(keys, frame) if len(earlier) else -np.inf
    while (
        index < len(blocks) and blocks[index].inbetween and blocks[index].stands_at < value - SAME_EVAL_TIME
    ):
        index += 1
    if index < len(blocks) and blocks[index].inbetween and blocks[index].stands_at < value + SAME_EVAL_TIME:
        new.free = blocks[index].free
        blocks[index] = new
        return
    blocks.insert(index, new)


def _name(keys: bpy.types.Key, new: Mapping[float, Block]) -> None:
    names = free_names({block.name for block in keys.key_blocks})
    for frame in sorted(new):
        new[frame].name = next(names)


def free_names(taken: Container[str]) -> Iterator[str]:
    """Names of new poses, like those that Blender gives."""
    numbered = (f"{POSE_KEY}.{number:03}" for number in itertools.count(1))
    return (name for name in itertools.chain([POSE_KEY], numbered) if name not in taken)
