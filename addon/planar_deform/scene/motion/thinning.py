# SPDX-License-Identifier: GPL-3.0-or-later
"""A recording, or any row of poses, thinned to the few between which in-betweens do for the others."""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array
from ...model.timing.played_curve import SAME_EVAL_TIME
from ...model.timing.thinning import Thinned, thin
from ...model.work import Progress, Work
from ..inbetweens import planning, writing
from ..objects.any_object import begin_shape
from ..objects.lattice_object import space_refusal
from ..sequence import pose_state
from ..sequence.pose_blocks import keyed, shown_curve

LOOK = 0.01  # seconds for which the thread is waited for at a time


def thin_refusal(context: bpy.types.Context) -> str | None:
    """Why there is nothing to thin, and what to do about it; None if there may be."""
    count = len(context.object.planar.poses)
    return None if count > 2 else f"There are {count} poses: Record a motion first, or key more of them"


class Thinning:
    """The poses of the active object, and which of them have to stay. Raises Refusal; changes nothing."""

    def __init__(self, context: bpy.types.Context, tolerance: float):
        obj = context.object
        reason = pose_state.refusal(obj) or planning.refusal(obj) or space_refusal(obj)
        reason = reason or thin_refusal(context)
        if reason is not None:
            raise Refusal(reason)
        self._drawing = begin_shape(context, unkeyed=True)  # the pose that is shown may go
        self._tolerance = tolerance
        self._times, self._fixed = _timing(obj)
        self._way = planning.way(self._drawing, range(len(self._times)), self._times.tolist())

    def solve(self, progress: Progress) -> Thinned:
        """Which poses stay; for a thread."""
        share, reach = 0.0, int(self._way.smooth)

        def between(kept: list[int], number: int) -> Array:
            around = kept[max(0, number - reach) : number + 2 + reach]
            motion = self._way.among(around).motion(progress=lambda _: progress(share))
            return motion.at(self._times[kept[number] + 1 : kept[number + 1]])

        def told(value: float) -> None:
            nonlocal share
            share = value
            if not progress(share):
                raise native.Cancelled

        tolerance = self._tolerance * self._drawing.diagonal
        return thin(self._way.keys, self._fixed, between, tolerance, told, reach=reach)

    def write(self, thinned: Thinned) -> Generator[float, None, None]:
        """Put in-betweens in place of the poses that go; the share done. Closed before its end: as it was."""
        if len(thinned.kept) == len(self._times):
            raise Refusal(f"All {len(self._times)} poses are needed for this tolerance: allow more")
        plan = planning.plan(self._drawing, poses=thinned.kept)
        work = Work(plan.solve)
        try:
            while not work.wait(LOOK):
                yield 0.5 * work.share
        finally:
            work.stop()
        for share in writing.write(self._drawing, plan, work.result()):
            yield 0.5 + 0.5 * share

    def summary(self, thinned: Thinned) -> str:
        """What to tell the user of it."""
        return (
            f"{len(self._times)} poses → {len(thinned.kept)}, furthest "
            f"{thinned.furthest / self._drawing.diagonal:.2%} of the size"
        )


def _timing(obj: bpy.types.Object) -> tuple[Array, set[int]]:
    """Times of the poses, ascending, and which of them have to stay.

    A pose may go if it has one key, which stands on an even way from the pose before it to the one behind it:
    there times are frames, and tell where between these it belongs. Elsewhere they only keep the order.
    """
    keys = obj.data.shape_keys
    timeline = keyed(keys).astype(np.float64)
    curve = shown_curve(keys)
    assert curve is not None  # two keys at least are on it
    even = [point.interpolation == "LINEAR" for point in curve.keyframe_points]
    at = np.array([pose.at for pose in obj.planar.poses])
    shown = np.abs(timeline[:, 1, None] - at) < SAME_EVAL_TIME
    pose_of = np.where(shown.any(axis=1), shown.argmax(axis=1), -1)  # of each key
    steps, fixed = np.ones(len(at)), set()  # from the pose before
    for pose in range(len(at)):
        own = np.flatnonzero(pose_of == pose)
        around = pose_of[own[0] - 1 : own[0] + 2].tolist() if len(own) == 1 else []
        if around == [pose - 1, pose, pose + 1] and even[own[0] - 1] and even[own[0]]:
            steps[pose : pose + 2] = np.diff(timeline[own[0] - 1 : own[0] + 2, 0])
        else:
            fixed.add(pose)
    return np.cumsum(steps), fixed
