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
    curve, steps = _stepped(obj)
    if curve is None or steps is None:
        return []
    step, offset = steps.frame_step, steps.frame_offset
    found = []
    for index, pose in enumerate(obj.planar.poses):
        frames = pose_state.frames_of(obj, index)
        after = [offset + step * math.ceil((frame - offset) / step) for frame in frames]
        if frames and not any(
            abs(curve.evaluate(frame) - pose.at) < SAME_EVAL_TIME for frame in (*frames, *after)
        ):
            found.append(Held(index, frames[0], after[0] - step, after[0]))
    return found


def shown_for(obj: bpy.types.Object, frame: float) -> float:
    """The frame whose drawing is seen at a frame: on twos the one before, at each second frame."""
    _, steps = _stepped(obj)
    if steps is None:
        return frame
    if (steps.use_frame_start and frame < steps.frame_start) or (
        steps.use_frame_end and frame > steps.frame_end
    ):
        return frame
    # Blender cuts the rest off, before the offset as well.
    whole = math.trunc((frame - steps.frame_offset) / steps.frame_step)
    return float(steps.frame_offset + steps.frame_step * whole)


def _stepped(
    obj: bpy.types.Object,
) -> tuple[bpy.types.FCurve | None, bpy.types.FModifierStepped | None]:
    """The curve of the poses, and what lets each frame stay for several."""
    curve = shown_curve(obj.data.shape_keys) if pose_state.is_ours(obj) else None
    modifiers = [] if curve is None else curve.modifiers
    steps = [
        modifier
        for modifier in modifiers
        if modifier.type == "STEPPED" and not modifier.mute and modifier.frame_step > 1.0
    ]
    return curve, steps[-1] if steps else None
