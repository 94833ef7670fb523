# SPDX-License-Identifier: GPL-3.0-or-later
"""New poses in a pose sequence: a block for each in the order of time, and a key of the curve."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import bpy
import numpy as np

from ..model.frame import Array
from .pose_blocks import (
    FIRST,
    SAME_FRAME,
    SAME_PLACE,
    SPACING,
    add,
    keyed,
    own_curve,
    played,
    points_of,
)
from .shape_keys import POSE_KEY


@dataclass(eq=False)
class _Block:
    """A block of the played range while the sequence is put together."""

    name: str
    listed: bool  # a keyed pose
    points: np.ndarray | None  # its shape; None: as in the file, where it may stay
    place: float  # where it is, or will be
    frame: float | None = None  # of a new one: where it is keyed
    before: float | None = None  # where one that was there already was


def insert(obj: bpy.types.Object, shapes: Mapping[float, np.ndarray]) -> None:
    """Key a new pose for each shape (by frame; see scene/points.py).

    Each comes after the block that the curve shows before its frame. A block cannot be moved: those behind
    the first new one are taken out and added again, and the curve's values follow.
    """
    keys = obj.data.shape_keys
    blocks = _in_order(obj, shapes)
    first = next(index for index, block in enumerate(blocks) if block.frame is not None)
    behind = [block for block in blocks[first:] if block.frame is None]
    for block in behind:
        block.points = points_of(obj, keys.key_blocks[block.name])
    for block in behind:
        obj.shape_key_remove(keys.key_blocks[block.name])
    for index in range(first, len(blocks)):
        block = blocks[index]
        block.place = blocks[index - 1].place + SPACING if index else FIRST
        block.name = add(obj, block.name, block.place, block.points).name
    old = [block for block in blocks if block.before is not None]
    if behind:
        _follow(keys, np.array([block.before for block in old]), np.array([block.place for block in old]))
    _list(obj, [block for block in blocks if block.listed])
    _key(obj, {block.frame: block.place for block in blocks if block.frame is not None})


def _in_order(obj: bpy.types.Object, shapes: Mapping[float, np.ndarray]) -> list[_Block]:
    """All blocks of the played range, the new ones among them."""
    keys = obj.data.shape_keys
    listed = {round(pose.at) for pose in obj.planar.poses}
    blocks = []
    for block in played(keys):
        place = float(round(block.frame))
        blocks.append(_Block(block.name, place in listed, None, place, before=place))
    taken = {block.name for block in keys.key_blocks}
    timeline = keyed(keys)
    latest: _Block | None = None
    for frame in sorted(shapes):
        new = _Block(_free_name(taken), True, shapes[frame], np.inf, frame=frame)
        earlier = timeline[timeline[:, 0] < frame]
        if latest is not None and not (len(earlier) and earlier[-1, 0] > latest.frame):
            index = blocks.index(latest) + 1
        elif len(earlier):
            shown = earlier[-1, 1] + SAME_PLACE
            index = 1 + max((i for i, block in enumerate(blocks) if block.place <= shown), default=-1)
        else:
            index = 0
        blocks.insert(index, new)
        latest = new
    return blocks


def _free_name(taken: set[str]) -> str:
    """A name like those that Blender gives, which is taken from now on."""
    numbered = (f"{POSE_KEY}.{number:03}" for number in itertools.count(1))
    name = next(name for name in itertools.chain([POSE_KEY], numbered) if name not in taken)
    taken.add(name)
    return name


def _follow(keys: bpy.types.Key, old: Array, new: Array) -> None:
    """Take the values of the curve from where blocks were to where they are; between blocks in proportion.

    The keys that are inserted next update the curve. Doing it here would also mark all animation as changed,
    and the unkeyed pose that has just been keyed would be lost when that is undone.
    """
    curve = own_curve(keys)
    if curve is None:
        return
    points = curve.keyframe_points
    for field in ("co", "handle_left", "handle_right"):
        values = np.empty(len(points) * 2, np.float32)
        points.foreach_get(field, values)
        values[1::2] = _moved(values[1::2].astype(np.float64), old, new)
        points.foreach_set(field, values)


def _moved(values: Array, old: Array, new: Array) -> Array:
    outside = np.minimum(values - old[0], 0.0) + np.maximum(values - old[-1], 0.0)
    result: Array = np.interp(values, old, new) + outside
    return result


def _list(obj: bpy.types.Object, blocks: list[_Block]) -> None:
    poses = obj.planar.poses
    poses.clear()
    for block in blocks:
        pose = poses.add()
        pose.at, pose.name = block.place, block.name


def _key(obj: bpy.types.Object, at: Mapping[float, float]) -> None:
    """Key a place at each frame; what keys there were keep their easing, new ones are linear."""
    keys = obj.data.shape_keys
    own_curve(keys)
    before = keyed(keys)[:, 0]
    for frame, place in at.items():
        keys.eval_time = place
        keys.keyframe_insert("eval_time", frame=frame)
    if not len(before):
        keys.animation_data.action.name = f"{obj.name} Poses"
    points = own_curve(keys).keyframe_points
    frames = keyed(keys)[:, 0]
    new = ~(np.abs(frames[:, None] - before[None, :]) < SAME_FRAME).any(axis=1)
    easing = np.empty(len(points), np.int32)
    points.foreach_get("interpolation", easing)
    easing[new] = points[0].bl_rna.properties["interpolation"].enum_items["LINEAR"].value
    points.foreach_set("interpolation", easing)
