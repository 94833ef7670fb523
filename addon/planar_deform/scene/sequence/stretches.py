# SPDX-License-Identifier: GPL-3.0-or-later
"""The stretches of a pose sequence, from one pose to the next: what is generated there, what is stale."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...model.timing.order_of_time import Entry, durations, frames_between, in_order
from ...model.timing.played_curve import SAME_EVAL_TIME, visits
from ..storage.digests import digest, of_block
from ..storage.points import bits
from . import conditions, pose_state
from .playback import Block, blocks_of, whole
from .pose_blocks import SPACING, block_at, eval_times, keyed


@dataclass(frozen=True)
class Stretch:
    """A block of the played range that is not generated, and the generated ones behind it."""

    start: Block
    inbetweens: list[Block]


def stretches(obj: bpy.types.Object) -> list[Stretch]:
    """The played range as it is."""
    found: list[Stretch] = []
    for block in blocks_of(obj):
        if block.inbetween:
            found[-1].inbetweens.append(block)
        else:
            found.append(Stretch(block, []))
    return found


def entries_of(obj: bpy.types.Object, starts: Sequence[float]) -> list[Entry]:
    """The blocks at these eval_times in the order in which the curve plays them."""
    return in_order(len(starts), visits(keyed(obj.data.shape_keys), starts))


class Stamps:
    """What in-betweens would be made from now, in short."""

    def __init__(self, obj: bpy.types.Object):
        self._obj = obj
        present = set(
            whole(eval_times(obj.data.shape_keys)).tolist()
        )  # a block may have been removed by hand
        self._names = {pose.name: pose for pose in obj.planar.poses if pose.at in present}

    def digest(self, eval_time: float) -> str:
        """Of the bits of the block at an eval_time."""
        return of_block(self._obj, eval_time, lambda: self._bits(eval_time))

    def original(self, pose: bpy.types.PropertyGroup) -> bpy.types.PropertyGroup | None:
        """The pose that this one repeats; None if it is one of its own, or has been made that."""
        found = self._names.get(pose.copy_of) if pose.copy_of else None
        if found is None or found == pose or self.digest(pose.at) not in {pose.copied, self.digest(found.at)}:
            return None
        return found

    def shown(self, pose: bpy.types.PropertyGroup) -> str:
        """The digest of what a pose will be when in-betweens are generated: a repeated one is renewed."""
        original = self.original(pose)
        return self.digest((pose if original is None else original).at)

    def of(
        self,
        digests: Sequence[str],
        transition: int,
        turns: int,
        path: str,
        smooth: bool,
        depths_held: bool,
    ) -> str:
        """The stamp of what is generated behind one of the poses with these digests, in order of time."""
        chain = list(digests[transition : transition + 2])
        if smooth:  # then the neighbours' poses count as well
            chain += digests[max(0, transition - 1) : transition]
            chain += ["", *digests[transition + 2 : transition + 3]]
        made_from = [*chain, self.digest(0.0), str(turns), path, str(smooth)]
        if depths_held:  # otherwise as it was before there were depths
            made_from.append("HELD")
        return digest("|".join(made_from).encode())

    def _bits(self, eval_time: float) -> bytes:
        return bits(self._obj, block_at(self._obj.data.shape_keys, eval_time))


def depths_held(obj: bpy.types.Object) -> bool:
    """Whether in-betweens have the depths of the pose before: those of a drawing, as nothing else has any."""
    return bool(obj.type == "MESH" and obj.planar.depth_between == "HELD")


def has_inbetweens(obj: bpy.types.Object) -> bool:
    """Whether anything is generated."""
    return pose_state.has_blocks(obj) and any(pose.generated for pose in obj.planar.poses)


def stale(obj: bpy.types.Object) -> list[tuple[int, int]]:
    """The stretches to be generated again, as indices of their two poses.

    Of a sequence without in-betweens there are none. Cheap while the shapes stay what they are.
    """
    if not has_inbetweens(obj) or not pose_state.is_ours(obj):
        return []
    if block_at(obj.data.shape_keys, 0.0) is None:
        return []  # nothing can be generated, see pose_state.refusal()
    played = _Played(obj)
    return [
        (played.indices[before.block], played.indices[after.block])
        for number, (before, after) in enumerate(itertools.pairwise(played.entries))
        if not played.fresh(number, before, after)
    ]


def why_stale(obj: bpy.types.Object, pose: int) -> list[str]:
    """What beside the poses has changed since in-betweens were generated behind this one (its index)."""
    played = _Played(obj)
    numbers = [number for number, entry in enumerate(played.entries) if played.indices[entry.block] == pose]
    return (
        conditions.changed(obj.planar.poses[pose].made_with, played.made_with(numbers[0])) if numbers else []
    )


def mark(obj: bpy.types.Object, poses: Iterable[int], *, edited: bool) -> None:
    """Make what is generated behind these poses (indices) belong to the poses as they are now."""
    played = _Played(obj)
    for number, entry in enumerate(played.entries):
        pose = played.poses[entry.block]
        if played.indices[entry.block] in poses and pose.generated:
            pose.stamp, pose.edited = played.stamp(number), edited
            pose.made_with = played.made_with(number)


class _Played:
    """The keyed poses in the order in which the curve plays them."""

    def __init__(self, obj: bpy.types.Object):
        self._way = obj.planar.anchor_path, obj.planar.smooth, depths_held(obj)
        self._present = whole(eval_times(obj.data.shape_keys))
        present = set(self._present.tolist())
        self._stamps = Stamps(obj)
        self.indices = [index for index, pose in enumerate(obj.planar.poses) if pose.at in present]
        self.poses = [obj.planar.poses[index] for index in self.indices]
        entries = entries_of(obj, [pose.at for pose in self.poses])
        self.entries = [entry for entry in entries if entry.first is not None]
        self._conditions = conditions.conditions(obj)
        self._durations = durations(self.entries)
        played = [self.poses[entry.block] for entry in self.entries]
        self._digests = [self._stamps.shown(pose) for pose in played]
        self._renewed = [
            digest != self._stamps.digest(pose.at) for digest, pose in zip(self._digests, played, strict=True)
        ]

    def stamp(self, number: int) -> str:
        """Of what would be generated behind an entry now."""
        turns = self.poses[self.entries[number].block].turns
        return self._stamps.of(self._digests, number, turns, *self._way)

    def made_with(self, number: int) -> str:
        """With what it would be generated behind an entry now."""
        pose = self.poses[self.entries[number].block].name
        return self._conditions.of(self._durations, number, self._way[1], pose)

    def fresh(self, number: int, before: Entry, after: Entry) -> bool:
        """Whether generating again would change nothing behind an entry."""
        pose, following = self.poses[before.block], self.poses[after.block]
        if before.copy or after.copy or after.block != before.block + 1:
            return False  # they are to be put in the order of time
        if self._renewed[number] or self._renewed[number + 1]:
            return False
        low, high = np.searchsorted(self._present, (pose.at + SAME_EVAL_TIME, following.at))
        between = self._present[low:high]
        generated = pose.at + SPACING * np.arange(1, pose.generated + 1)
        if pose.edited and np.isin(between, generated).any() and pose.stamp == self.stamp(number):
            return True  # left alone, even if some have been removed by hand
        if not np.array_equal(between, generated):
            # Generated blocks have been removed by hand; or there are blocks of the user, and nothing else.
            return len(between) > 0 and not np.isin(between, generated).any()
        if pose.generated:
            as_it_was = not conditions.changed(pose.made_with, self.made_with(number))
            return bool(pose.stamp == self.stamp(number)) and as_it_was
        same = self._digests[number] == self._digests[number + 1]
        return same or frames_between(before, after) == 0
