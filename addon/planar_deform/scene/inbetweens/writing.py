# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated shapes put into a pose sequence, and taken out; planning.py tells how they are kept."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import partial

import bpy
import numpy as np

from ...errors import ObjectGone, Refusal
from ...model.plane.frame import Array, Mask
from ...model.timing import progress
from ...model.timing.played_curve import (
    SAME_EVAL_TIME,
    Offsets,
    Rows,
    moved,
    offsets,
    pose_below,
    remember,
)
from ..objects.any_object import AnyObject
from ..sequence import playback, pose_curve, pose_showing, pose_state
from ..sequence.conditions import conditions
from ..sequence.playback import Block, Steps, inbetween_name
from ..sequence.pose_blocks import FIRST, SPACING, keyed, own_curve
from ..sequence.stretches import Stamps, Stretch, stretches
from ..storage import changes, digests
from .plan import Plan


def write(drawing: AnyObject, plan: Plan, shapes: Sequence[Array]) -> Steps:
    """Put in what plan.solve() gave, in place of what was generated before; yields the share that is done, as
    playback.together() asks.

    Closed before its end, or where anything fails, everything is back to the bit. Raises ObjectGone where the
    poses are not those of the plan any more, Refusal beyond what Blender can store.
    """
    obj = drawing.resolve()
    found = [stretch for stretch in stretches(obj) if stretch.start.source not in plan.dropped]
    if [stretch.start.source for stretch in found] != plan.starts:
        raise ObjectGone(f"The poses of '{obj.name}' have changed meanwhile")
    blocks, starts = _blocks(obj, plan, found, shapes)
    was_unkeyed = pose_state.unkeyed(obj)

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        obj.planar.anchor_path, obj.planar.smooth = plan.path, plan.smooth
        _drop_keys(obj, plan.dropped)
        _expand(obj, plan, playback.eval_times_of(blocks)[starts])

    yield from playback.relay(obj, blocks, then)
    pose_showing.show(drawing.resolve(), was_unkeyed)


def removing(obj: bpy.types.Object) -> Steps:
    """Take all in-betweens out, step by step: what was there before them is back, to the bit.

    Poses that have been keyed, deleted or edited since stay so. Raises Refusal; yields the share done, see
    playback.together().
    """
    reason = pose_state.refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    changes.tell(obj)  # of what a script has done Blender tells later
    found = stretches(obj)
    folded = _folded(obj, found)  # eval_times of repeated poses, and where the poses are that they repeat
    order = _order_before([stretch for stretch in found if stretch.start.source not in folded])
    shown = np.array([stretch.start.source for stretch in found])
    plain = FIRST + SPACING * np.arange(len(found))
    settings = obj.planar
    remembered = settings.curve_before
    blocks = [stretch.start for stretch in order]
    for block in blocks:
        block.free = 0
        if block.pose is not None:
            block.pose |= {"stamp": "", "made_with": "", "edited": False, "order_before": 0}
    at = {
        block.source: eval_time
        for block, eval_time in zip(blocks, playback.eval_times_of(blocks), strict=True)
    }
    final = np.array([at[folded.get(eval_time, eval_time)] for eval_time in shown.tolist()])
    active = settings.poses[settings.active_pose].at if settings.active_pose < len(settings.poses) else None
    was_unkeyed = pose_state.unkeyed(obj)

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        curve = own_curve(obj.data.shape_keys)
        if curve is not None:
            rows = pose_curve.rows(curve)
            was = offsets(rows, shown, plain, remembered)
            fallback = final[was.pose][:, None] + was.values
            wanted = progress.kept(rows, was.exact[:, 0] | _stands(rows, shown, was), fallback)
            pose_curve.write_rows(curve, was.restored(wanted, fallback), was.exact)

    yield from playback.relay(obj, blocks, then)
    for index, pose in enumerate(settings.poses):
        if active in folded and pose.at == at[folded[active]]:
            settings.active_pose = index
    pose_showing.show(obj, was_unkeyed)


def _blocks(
    obj: bpy.types.Object, plan: Plan, found: list[Stretch], shapes: Sequence[Array]
) -> tuple[list[Block], list[int]]:
    """The played range to be, and which of its blocks are those of the plan's entries."""
    stamps, made = Stamps(obj), conditions(obj)
    lasts = np.diff(plan.times).tolist()
    listed = {pose.at: pose for pose in obj.planar.poses}
    taken = {block.name for block in obj.data.shape_keys.key_blocks}
    order = [entry.block for entry in plan.entries if not entry.copy]
    made_of = [digests.digest(shape.tobytes()) for shape in plan.shapes]
    waiting = iter(shapes)
    blocks: list[Block] = []
    starts: list[int] = []
    for number, entry in enumerate(plan.entries):
        stretch = found[entry.block]
        transition = number - plan.first
        start = stretch.start
        if entry.copy:
            start = Block(_free_name(start.name, taken), plan.shapes[transition], pose={})
            start.pose = {"copy_of": stretch.start.name, "copied": made_of[transition]}
        elif start.pose is not None:
            if order != sorted(order) and not start.pose["order_before"]:
                start.pose["order_before"] = entry.block + 1
            if 0 <= transition < len(made_of) and stamps.original(listed[start.source]) is not None:
                start.shape, start.pose["copied"] = plan.shapes[transition], made_of[transition]
        start.free = 0
        starts.append(len(blocks))
        blocks.append(start)
        if start.pose is None:
            continue
        if transition in plan.kept:
            blocks += stretch.inbetweens
            continue
        count = plan.counts[transition] if 0 <= transition < len(plan.counts) else 0
        stamp = ""
        if count:
            way = plan.path, plan.smooth, plan.depths_held
            stamp = stamps.of(made_of, transition, plan.turns[transition], *way)
        pose = "" if entry.copy else listed[start.stands_at].name
        made_with = made.of(lasts, transition, plan.smooth, pose) if count else ""
        start.pose |= {"edited": False, "stamp": stamp, "made_with": made_with}
        before = [] if entry.copy or len(stretch.inbetweens) != count else stretch.inbetweens
        for number in range(count):
            share = (number + 1) / (count + 1)
            shape = partial(plan.coordinates, transition, share, next(waiting))
            source = before[number].source if before else None
            blocks.append(Block(inbetween_name(start.name, number + 1), shape, source, inbetween=True))
    return blocks, starts


def _free_name(name: str, taken: set[str]) -> str:
    names = itertools.chain([f"{name} Repeat"], (f"{name} Repeat {number}" for number in itertools.count(2)))
    found = next(name for name in names if name not in taken)
    taken.add(found)
    return found


def _drop_keys(obj: bpy.types.Object, dropped: Sequence[float]) -> None:
    keys = obj.data.shape_keys
    values = keyed(keys)[:, 1]
    at = np.array(dropped).reshape(1, -1)
    pose_curve.remove_keys(keys, (np.abs(values[:, None] - at) < SAME_EVAL_TIME).any(axis=1))


def _expand(obj: bpy.types.Object, plan: Plan, shown: Array) -> None:
    """Take the curve to where the plan's entries are shown now."""
    settings = obj.planar
    curve = own_curve(obj.data.shape_keys)
    rows = pose_curve.rows(curve)
    old = np.array(plan.starts)
    old_plain = FIRST + SPACING * np.arange(len(old))
    was = offsets(rows, old, old_plain, settings.curve_before)
    times: dict[int, list[int]] = {}  # the entries of each block
    for index, known in enumerate(plan.entries):
        times.setdefault(known.block, []).append(index)
    keys = zip(was.pose.tolist(), rows.keys[:, 0].tolist(), strict=True)
    entry = np.array([_entry_at(plan, times[block], frame) for block, frame in keys])
    plain = FIRST + SPACING * np.arange(len(shown))
    fallback = moved(plain[entry][:, None] + was.values, plain, shown)
    wanted = progress.kept(rows, _stands(rows, old, was), fallback)
    wanted.types[:] = was.types
    pose_curve.write_rows(curve, wanted)
    # What is remembered is reckoned from the pose below the key as it is now, which may be another one.
    under = np.array([known.block for known in plan.entries])[pose_below(wanted.values[:, 0], shown)]
    another = under != was.pose
    was.values[another] += (old_plain[was.pose] - old_plain[under])[another, None]
    if not settings.curve_before:
        was.exact[:] = True
    settings.curve_before = remember(pose_curve.rows(curve), was)


def _stands(rows: Rows, eval_times: Array, was: Offsets) -> Mask:
    """Which keys stand at poses; the others retime."""
    return np.asarray(np.abs(rows.keys[:, 1] - eval_times[was.pose]) < SAME_EVAL_TIME)


def _entry_at(plan: Plan, found: Sequence[int], frame: float) -> int:
    """Which of the times that a block is played is meant by a key at a frame."""
    begun = [index for index in found if (first := plan.entries[index].first) is not None and first <= frame]
    return begun[-1] if begun else found[0]


def _folded(obj: bpy.types.Object, found: list[Stretch]) -> dict[float, float]:
    """eval_times of poses that repeat others still, and of those."""
    stamps = Stamps(obj)
    there = {stretch.start.source for stretch in found}
    originals = {pose.at: stamps.original(pose) for pose in obj.planar.poses if pose.at in there}
    return {
        eval_time: original.at
        for eval_time, original in originals.items()
        if original is not None and originals.get(original.at) is None
    }


def _order_before(found: list[Stretch]) -> list[Stretch]:
    """The order from before poses were put in that of time; what is new stays behind what it is behind."""
    ranks = []
    latest = 0
    for stretch in found:
        if stretch.start.pose is not None and stretch.start.pose["order_before"]:
            latest = stretch.start.pose["order_before"]
        ranks.append(latest)
    return [found[index] for index in sorted(range(len(found)), key=lambda index: ranks[index])]
