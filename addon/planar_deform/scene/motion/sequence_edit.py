# SPDX-License-Identifier: GPL-3.0-or-later
"""A change of what one frame of a pose sequence shows, spread over the sequence."""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np

from ... import native
from ...errors import ObjectGone, Refusal
from ...model.plane.frame import Array, Array32
from ...model.work import Progress
from ..objects.any_object import begin_shape
from ..objects.lattice_object import space_refusal
from ..sequence import pose_showing, pose_state, stretches
from ..sequence.pose_blocks import played, share_of, shown_curve
from ..storage import points

# Where a frame is blended of a kept pose and another shape, the other takes all of the change. With less than
# this share in the blend it would have to overdo it.
LEAST_SHARE = 0.5


def edit_refusal(context: bpy.types.Context) -> str | None:
    """Why there is no change that could be spread, and what to do; None if there is one."""
    if shown_curve(context.object.data.shape_keys) is None:
        return "No pose has a key, so that nothing is played: use Key Pose at two frames first"
    if pose_state.unkeyed(context.object):
        return None
    if pose_state.pose_at(context.object, context.scene.frame_current_final) is not None:
        return "A pose is keyed at this frame, and posing changes it alone: pose at a frame beside it instead"
    return "Nothing is changed at this frame: pose the drawing first, that change is spread over the sequence"


class SequenceEdit:
    """The unkeyed pose that is shown, as a change of the sequence. Raises Refusal; changes nothing."""

    def __init__(self, context: bpy.types.Context, keep_poses: bool):
        obj, frame = context.object, context.scene.frame_current_final
        reason = pose_state.refusal(obj) or edit_refusal(context) or space_refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        self._drawing = begin_shape(context)
        keys = obj.data.shape_keys
        blocks = played(keys)
        at = np.round([block.frame for block in blocks]).tolist()
        listed = {round(pose.at): pose.name for pose in obj.planar.poses}
        kept = {index for index, eval_time in enumerate(at) if keep_poses and eval_time in listed}
        curve = shown_curve(keys)
        assert curve is not None  # or there is a reason
        eval_time = float(np.clip(curve.evaluate(frame), at[0], at[-1]))
        high = int(np.searchsorted(at, eval_time))
        low = high if at[high] == eval_time else high - 1
        share = 0.0 if low == high else float(share_of(at[low], at[high], eval_time))
        shares = {low: 1.0 - share, high: share} if low < high else {low: 1.0}
        free = [index for index in shares if index not in kept]
        if kept and sum(shares[index] for index in free) < LEAST_SHARE:
            nearest = max(shares, key=shares.__getitem__)
            raise Refusal(
                f"This frame shows nothing but kept poses, mostly '{listed[at[nearest]]}': edit one "
                "that Generate In-Betweens has filled in, or turn off Keep Poses"
            )
        first = max((index for index in kept if index <= low), default=0)
        last = min((index for index in kept if index >= high), default=len(blocks) - 1)
        for block in blocks[first : last + 1]:
            if block.lock_shape:
                raise Refusal(f"Shape key '{block.name}' is locked: open its lock in the Shape Keys panel")
        self._names = [block.name for block in blocks[first : last + 1]]
        self._shapes = [points.read_block(obj, block) for block in blocks[first : last + 1]]
        self._kept = {index - first for index in kept if first <= index <= last}
        self._shares = {index - first: value for index, value in shares.items()}
        # The eval_times of the poses behind which there are shapes that change.
        self._stretches = {eval_time for eval_time in at[first : last + (not kept)] if eval_time in listed}

    def solve(self, progress: Progress) -> dict[int, Array32]:
        """The changed shapes, see storage/points.py, by their number; for a thread."""
        drawing = self._drawing
        frames = [drawing.flattened(shape) for shape in self._shapes]
        edits = self._edits(frames) | {index: frames[index] for index in self._kept}
        edited = native.edit_sequence(frames, edits, **drawing.elements)
        return {
            index: drawing.moved(shape, edited[index])
            for index, shape in enumerate(self._shapes)
            if index not in self._kept
        }

    def _edits(self, frames: list[Array]) -> dict[int, Array]:
        """What the shapes that make up the frame have to become for it to show the change."""
        wanted = self._drawing.positions
        if len(self._shares) == 1:
            return dict.fromkeys(self._shares, wanted)
        low, high = self._shares
        for kept, other in ((low, high), (high, low)):
            if kept in self._kept:
                return {other: frames[kept] + (wanted - frames[kept]) / self._shares[other]}
        # Both take on the same change of each edge, and one linear system puts them together from edges: so
        # their blend is what is wanted, not only nearly so.
        blend = self._shares[low] * frames[low] + self._shares[high] * frames[high]
        three = native.edit_sequence(
            [frames[low], blend, frames[high]], {1: wanted}, **self._drawing.elements
        )
        return {low: three[0], high: three[2]}

    def write(self, shapes: dict[int, Array32]) -> Generator[float, None, None]:
        """Write the changed shapes, one at each step; the share done. Closed before its end: as it was."""
        written: list[int] = []
        try:
            for index, shape in shapes.items():
                self._put(index, shape)
                written.append(index)
                yield len(written) / len(shapes)
        except BaseException:
            for index in written:
                self._put(index, self._shapes[index])
            raise
        obj = self._drawing.resolve()
        poses = [index for index, pose in enumerate(obj.planar.poses) if round(pose.at) in self._stretches]
        stretches.mark(obj, poses, edited=True)
        pose_showing.drop_scratch(obj)
        pose_showing.show_frame(obj)

    def _put(self, index: int, shape: Array32) -> None:
        obj = self._drawing.resolve()
        block = obj.data.shape_keys.key_blocks.get(self._names[index])
        if block is None:
            raise ObjectGone(f"Shape key '{self._names[index]}' is gone")
        points.write_block(block, shape)
        points.update(obj)
