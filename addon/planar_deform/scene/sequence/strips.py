# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose sequence whose curve has been pushed down to the Nonlinear Animation editor: read, not changed.

The strip shows its action at other frames: from `frame_start` on, stretched by `scale`. What strips blend and
repeat is not told here.
"""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...model.plane.frame import Array32


def strip_of(keys: bpy.types.Key | None) -> bpy.types.NlaStrip | None:
    """The topmost strip that plays the blocks; None as long as they have an action themselves."""
    animation = None if keys is None else keys.animation_data
    if animation is None or animation.action is not None:
        return None
    for track in reversed(animation.nla_tracks):
        for strip in [] if track.mute else track.strips:
            if not strip.mute and curve_of(strip) is not None:
                return strip
    return None


def curve_of(strip: bpy.types.NlaStrip) -> bpy.types.FCurve | None:
    """The curve on eval_time that a strip plays."""
    curves = compat.curves_of_strip(strip)
    return None if curves is None else curves.find("eval_time")


def keyed(strip: bpy.types.NlaStrip) -> Array32:
    """Frame of the timeline and value of each key, in time, k x 2."""
    curve = curve_of(strip)
    assert curve is not None  # strip_of() gives none without
    timeline = np.empty(len(curve.keyframe_points) * 2, np.float32)
    curve.keyframe_points.foreach_get("co", timeline)
    timeline = timeline.reshape(-1, 2)
    timeline[:, 0] = strip.frame_start + (timeline[:, 0] - strip.action_frame_start) * strip.scale
    return timeline


def value_at(strip: bpy.types.NlaStrip, frame: float) -> float:
    """What is played at a frame of the timeline."""
    curve = curve_of(strip)
    assert curve is not None  # strip_of() gives none without
    within = min(max(frame, strip.frame_start), strip.frame_end)
    return float(curve.evaluate(strip.action_frame_start + (within - strip.frame_start) / strip.scale))
