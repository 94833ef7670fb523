# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses that are keyed and not shown: on twos, each second frame only holds the one before."""

from __future__ import annotations

import math
from typing import NamedTuple

import bpy

from ...model.timing.played_curve import SAME_EVAL_TIME
from . import pose_state
from .pose_blocks import shown_curve


class Held(NamedTuple):
    """A pose that no frame shows."""

    pose: int  # its index
    frame: float  # where it is keyed
    before: float  # the frames nearest to that which show something new
    after: float


def held(obj: bpy.types.Object) -> list[Held]:
    """The keyed poses that the steps of the curve pass over."""
    curve = shown_curve(obj.data.shape_keys) if pose_state.is_ours(obj) else None
    if curve is None:
        return []
    steps = [
        modifier
        for modifier in curve.modifiers
        if modifier.type == "STEPPED" and not modifier.mute and modifier.frame_step > 1.0
    ]
    if not steps:
        return []
    step, offset = steps[-1].frame_step, steps[-1].frame_offset
    found = []
    for index, pose in enumerate(obj.planar.poses):
        frames = pose_state.frames_of(obj, index)
        after = [offset + step * math.ceil((frame - offset) / step) for frame in frames]
        if frames and not any(
            abs(curve.evaluate(frame) - pose.at) < SAME_EVAL_TIME for frame in (*frames, *after)
        ):
            found.append(Held(index, frames[0], after[0] - step, after[0]))
    return found
