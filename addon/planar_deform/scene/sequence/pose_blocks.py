# SPDX-License-Identifier: GPL-3.0-or-later
"""The absolute shape keys of a pose sequence, and the curve that plays them; the folder tells how."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME
from ..storage import points
from . import strips

# The eval_times of blocks: what the Key's has to be to show them. Blender keeps a block's divided by 100 in
# float32, and puts a new block at the Key's unless one is within 0.1 of that or all are 10 and more below.
FIRST = 1024.0
SPACING = 8.0
HOLD = 500_000.0
SCRATCH = 1_000_000.0
STILL = 1_040_000.0  # what is shown while blocks are laid anew; eval_time goes to 1 048 574


def eval_times(keys: bpy.types.Key) -> Array:
    """Where each block is, in order."""
    found = np.empty(len(keys.key_blocks), np.float32)
    keys.key_blocks.foreach_get("frame", found)
    return found.astype(np.float64)


def block_at(keys: bpy.types.Key | None, eval_time: float) -> bpy.types.ShapeKey | None:
    """The block at an eval_time."""
    if keys is None:
        return None
    distances = np.abs(eval_times(keys) - eval_time)
    nearest = int(distances.argmin())
    return keys.key_blocks[nearest] if distances[nearest] < SAME_EVAL_TIME else None


def add(obj: bpy.types.Object, name: str, eval_time: float, shape: Array32) -> bpy.types.ShapeKey:
    """Add a block that holds a shape at an eval_time. Moves eval_time there."""
    obj.data.shape_keys.eval_time = eval_time
    block = obj.shape_key_add(name=name, from_mix=False)
    block.interpolation = "KEY_LINEAR"
    points.write_block(block, shape)
    return block


def take_out(obj: bpy.types.Object, block: bpy.types.ShapeKey) -> None:
    """Remove a block; the active one stays active, unless it is this one."""
    active, index = obj.active_shape_key_index, obj.data.shape_keys.key_blocks.find(block.name)
    obj.shape_key_remove(block)
    obj.active_shape_key_index = max(0, active - (index <= active))  # any removal makes Blender move on


def played(keys: bpy.types.Key) -> list[bpy.types.ShapeKey]:
    """The blocks of the played range."""
    return [
        block
        for block, at in zip(keys.key_blocks, eval_times(keys), strict=True)
        if FIRST - SAME_EVAL_TIME < at < HOLD
    ]


def blended(obj: bpy.types.Object, time: float) -> Array32:
    """The shape that a value of eval_time shows, as Blender evaluates absolute keys.

    Raises Refusal between blocks that are not interpolated linearly.
    """
    keys = obj.data.shape_keys
    at = np.round(eval_times(keys), 2)
    upper = int(np.searchsorted(at, time))
    if upper == len(at) or upper == 0 or at[upper] == time:
        return points.read_block(obj, keys.key_blocks[min(upper, len(at) - 1)])
    pair = keys.key_blocks[upper - 1], keys.key_blocks[upper]
    for block in pair:
        if block.interpolation != "KEY_LINEAR":
            raise Refusal(
                f"Shape key '{block.name}' is not interpolated linearly: choose Linear in its panel"
            )
    share = share_of(at[upper - 1], at[upper], time)
    low, high = (points.read_block(obj, block) for block in pair)
    return low * (np.float32(1.0) - share) + high * share


def share_of(low: float, high: float, time: float) -> np.float32:
    """How much of the block at eval_time `high`, beside that at `low`, a value of eval_time shows.

    Reckoned as Blender does, in float32 with eval_times divided by 100: shapes far apart tell the difference.
    """
    first, last, now = np.array([low, high, time], np.float32) / np.float32(100.0)
    share: np.float32 = (now - first) / (last - first)
    return share


def shown_curve(keys: bpy.types.Key | None) -> bpy.types.FCurve | None:
    """The curve that plays the blocks, to be read."""
    curves = None if keys is None else compat.curves_of(keys.animation_data)
    return None if curves is None else curves.find("eval_time")


def own_curve(keys: bpy.types.Key) -> bpy.types.FCurve | None:
    """The curve that plays the blocks, to be changed: a duplicated object may use the same action."""
    if keys.animation_data is not None and keys.animation_data.action is not None:
        compat.make_single_user(keys.animation_data)
    return shown_curve(keys)


def keyed(keys: bpy.types.Key | None) -> Array32:
    """Frame and value of each key of the curve, in time, k x 2 float32."""
    curve = shown_curve(keys)
    if curve is None:
        strip = strips.strip_of(keys)
        if strip is not None:
            return strips.keyed(strip)
        return np.empty((0, 2), np.float32)
    timeline = np.empty(len(curve.keyframe_points) * 2, np.float32)
    curve.keyframe_points.foreach_get("co", timeline)
    return timeline.reshape(-1, 2)


def played_value(keys: bpy.types.Key, frame: float) -> float:
    """The eval_time that is shown at a frame, unless an unkeyed pose is."""
    curve, strip = shown_curve(keys), strips.strip_of(keys)
    if curve is not None:
        return float(curve.evaluate(frame))
    return float(keys.eval_time) if strip is None else strips.value_at(strip, frame)


def set_key_type(keys: bpy.types.Key, frame: float, kind: str) -> None:
    """Give the key of the curve at a frame one of Blender's types, such as 'BREAKDOWN'."""
    for index in np.flatnonzero(np.abs(keyed(keys)[:, 0] - frame) < SAME_FRAME):
        curve = own_curve(keys)
        assert curve is not None  # it has that key
        curve.keyframe_points[int(index)].type = kind
