# SPDX-License-Identifier: GPL-3.0-or-later
"""The way between the poses keyed around the present frame, any place of which can be shown."""

from __future__ import annotations

import bpy

from ...errors import Refusal
from ...model.input.breakdown import nearest_share
from ...model.plane.frame import Array
from ...model.posing.joints import Joint
from ...model.posing.pins import Holder
from ...model.work import Progress
from ..objects.any_object import begin_shape
from ..objects.cutout_object import CutoutObject
from ..pins import joint_list, pin_list
from ..sequence import pose_state
from ..sequence.neighbours import KeyedPose, around
from ..view import snapshot
from . import planning


def refusal(obj: bpy.types.Object, frame: float) -> str | None:
    """Why there is no way at this frame, and what to do; None when there is one."""
    before, behind = around(obj, frame) if pose_state.is_ours(obj) else (None, None)
    if before is None or behind is None or before.at == behind.at:
        return "A breakdown lies between two keyed poses: key them, and go to a frame between them"
    return None


class Way:
    """The shapes that Generate In-Betweens would put between the two poses; solve() before anything is shown.

    On a keyed frame these are the poses around it, as that one is to be made again. What is shown goes where
    all unkeyed poses go. Holds no reference to Blender's data.
    """

    def __init__(self, context: bpy.types.Context, obj: bpy.types.Object):
        """Of an object. Raises Refusal, with nothing changed."""
        self.drawing = begin_shape(context, obj, unkeyed=True)
        self.frame = context.scene.frame_current_final
        reason = refusal(obj, self.frame)
        if reason is not None:
            raise Refusal(reason)
        before, behind = around(obj, self.frame)
        assert before is not None  # or there is a reason
        assert behind is not None
        self._take_way(obj, before, behind)
        self._holders: list[Holder] = []
        self._joints: list[Joint] = []
        if isinstance(self.drawing, CutoutObject):
            self._holders = [
                Holder(pin, self.drawing.cutout) for pin in pin_list.model_pins(obj, self.drawing)
            ]
            self._joints = joint_list.bound_joints(obj, self.drawing)
        self.start = 0.5  # where on the way the shape is that is shown at first, once it is solved
        self._start = self._share_played(obj, before, behind)
        self._shown = self.drawing.positions

    def solve(self, progress: Progress | None = None) -> None:
        """Find the way. Needs no Blender data: of dense drawings this takes a while, in a thread.

        Raises native.SolveError and native.Cancelled.
        """
        self._within = self._beyond = self._plan.motion(progress=progress)
        if len(self._plan.keys) > 2:
            self._beyond = self._plan.motion(self._first, self._first + 1, progress)
        self.start = nearest_share(self._at, self._shown) if self._start is None else self._start

    def show(self, share: float) -> None:
        """Show the shape at a share of the way, 0 to 1, or beyond the poses. Raises ObjectGone."""
        positions = self._at(share)
        self.drawing.show(self._plan.coordinates(self._first, share, positions))
        if isinstance(self.drawing, CutoutObject) and self._holders:
            joints = joint_list.carried(self._joints, self.drawing, positions)
            snapshot.follow(self.drawing, positions, [*pin_list.carried(self._holders, positions), *joints])

    def restore(self) -> None:
        """Put everything back as it was, to the bit. Raises ObjectGone."""
        self.drawing.restore()

    def _take_way(self, obj: bpy.types.Object, before: KeyedPose, behind: KeyedPose) -> None:
        poses, times = [before.pose, behind.pose], [0.0, behind.frame - before.frame]
        self._first = 0  # which of the poses is the one before
        if obj.planar.smooth:  # then the next ones on both sides decide on the way, too
            if (further := _further(obj, before, 0)) is not None:
                poses, times, self._first = [further[0], *poses], [-further[1], *times], 1
            if (further := _further(obj, behind, 1)) is not None:
                poses, times = [*poses, further[0]], [*times, times[-1] + further[1]]
        self._plan = planning.way(self.drawing, poses, times)

    def _at(self, share: float) -> Array:
        """Positions n x 2 at a share of the way."""
        start, end = self._plan.times[self._first : self._first + 2]
        motion = self._within if 0.0 <= share <= 1.0 else self._beyond
        positions: Array = motion.at([start + share * (end - start)], overshoot=True)[0]
        return positions

    def _share_played(self, obj: bpy.types.Object, before: KeyedPose, behind: KeyedPose) -> float | None:
        """Where on the way the timeline has the shape that is shown; None where it shows another."""
        if pose_state.pose_at(obj, self.frame) is not None or pose_state.unkeyed(obj):
            return None
        share = (obj.data.shape_keys.eval_time - before.at) / (behind.at - before.at)
        return float(min(max(share, 0.0), 1.0))


def _further(obj: bpy.types.Object, pose: KeyedPose, side: int) -> tuple[int, float] | None:
    """The next pose before (side 0) or behind (1) one that may be held, and how many frames that is away."""
    following = around(obj, pose.frame)[side]
    while following is not None and following.at == pose.at:
        pose = following
        following = around(obj, pose.frame)[side]
    return None if following is None else (following.pose, abs(following.frame - pose.frame))
