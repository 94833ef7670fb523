# SPDX-License-Identifier: GPL-3.0-or-later
"""The keyed poses before and behind a frame."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME
from .pose_blocks import keyed


@dataclass(frozen=True)
class KeyedPose:
    """A pose where the curve has a key for it."""

    pose: int  # its index in the object's list
    frame: float
    at: float  # the eval_time of its block


def around(obj: bpy.types.Object, frame: float) -> tuple[KeyedPose | None, KeyedPose | None]:
    """The last pose keyed before a frame and the first one keyed behind it; None where there is none.

    What is keyed at the frame itself is left out, and so are keys that show no pose.
    """
    poses = obj.planar.poses
    timeline = keyed(obj.data.shape_keys).astype(np.float64)
    if not len(poses) or not len(timeline):
        return None, None
    eval_times = np.empty(len(poses), np.float32)
    poses.foreach_get("at", eval_times)
    order = eval_times.argsort()
    following = np.searchsorted(eval_times[order], timeline[:, 1] - SAME_EVAL_TIME)
    nearest = order[np.minimum(following, len(poses) - 1)]
    shows = np.abs(timeline[:, 1] - eval_times[nearest]) < SAME_EVAL_TIME
    before = np.flatnonzero(shows & (timeline[:, 0] <= frame - SAME_FRAME))
    behind = np.flatnonzero(shows & (timeline[:, 0] >= frame + SAME_FRAME))

    def found(keys: NDArray[np.intp]) -> list[KeyedPose]:
        return [KeyedPose(int(nearest[k]), float(timeline[k, 0]), float(timeline[k, 1])) for k in keys]

    return next(iter(found(before[-1:])), None), next(iter(found(behind[:1])), None)
