# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens: generated shapes between the keyed poses, one for each whole frame from one to the next.

They are blocks between those of the poses. The curve's values follow, so that a pose is shown when it was, and
with linear timing every generated shape at its frame; all timing stays a matter of the curve. Taking them out
takes the values back, to the bit.

The curve cannot come back to an earlier pose through the blocks in between. Where it does, as in a loop, a
pose of its own repeats the earlier one, and follows it until it is edited; poses that have been moved past one
another in time are put in order. Taking in-betweens out undoes that, too.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import bpy
import numpy as np

from .. import native
from ..model.frame import Array, Indices
from ..model.order_of_time import Entry, frames_between
from ..model.played_curve import SAME_FRAME, SAME_PLACE, Offsets, moved, offsets, remember
from . import digests, playback, pose_curve, sequence
from . import pins as scene_pins
from .errors import ObjectGone, Refusal
from .playback import Block
from .pose_blocks import (
    FIRST,
    HOLD,
    SCRATCH,
    SPACING,
    block_at,
    keyed,
    own_curve,
    points_of,
)
from .shape import SceneShape, is_outline, shape_refusal
from .stretches import Stamps, Stretch, entries_of, has_inbetweens, mark, stale, stretches

__all__ = ["Plan", "between", "has_inbetweens", "mark", "plan", "refusal", "remove", "stale", "way", "write"]

Progress = Callable[[float], bool | None]

PLANTED = 1e-3  # of the diagonal: a pin that has moved less between two poses stands still
_SAMPLED = 0.1  # of the share of the work: sampling, after solving


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Why nothing can be generated for an object, and what to do; None when it can. Cheap enough for polls."""
    reason = shape_refusal(obj)
    if reason is None and (not sequence.is_ours(obj) or len(keyed(obj.data.shape_keys)) < 2):
        return "Key two poses first: Key Pose at one frame, then another one at a later frame"
    return reason


@dataclass
class Plan:
    """What is to be generated: plain data, so that it can be solved in a thread."""

    scene: SceneShape
    shapes: list[np.ndarray]  # of the poses in the order of time, as stored
    keys: list[Array]  # the same n x 2
    rest: Array  # n x 2
    elements: dict[str, Indices]
    times: list[float]  # of the keys: frames, without those over which a pose is held
    samples: list[int]  # of each transition k -> k + 1: how many to generate
    turns: list[int]
    held: list[Indices]  # vertices of each pin in each part
    path: str  # "STRAIGHT" | "ARC"
    smooth: bool
    # For write(): the order of the blocks, which of them is the first key, the transitions whose generated
    # shapes stay, and what there was.
    entries: list[Entry] = field(default_factory=list)
    first: int = 0
    kept: set[int] = field(default_factory=set)
    starts: list[float] = field(default_factory=list)
    dropped: list[float] = field(default_factory=list)

    @property
    def anchors(self) -> list[Indices | None]:
        """Of each transition the vertices whose mean moves on the path: of planted pins, or else of all pins.

        Each part goes by its own pins.
        """
        found: list[Indices | None] = []
        for before, after in zip(self.keys, self.keys[1:], strict=False):
            gaps = [
                np.linalg.norm(before[rows].mean(axis=0) - after[rows].mean(axis=0)) for rows in self.held
            ]
            near = PLANTED * self.scene.diagonal
            planted = [rows for rows, gap in zip(self.held, gaps, strict=True) if gap <= near]
            parts = {int(self.scene.parts[rows[0]]) for rows in planted}
            others = [rows for rows in self.held if int(self.scene.parts[rows[0]]) not in parts]
            chosen = planted + others
            found.append(np.unique(np.concatenate(chosen)).astype(np.int32) if chosen else None)
        return found

    def among(self, chosen: Sequence[int]) -> Plan:
        """The way through some of the keys alone, for motion()."""
        turns = [sum(self.turns[before:after]) for before, after in itertools.pairwise(chosen)]
        return replace(
            self,
            shapes=[self.shapes[key] for key in chosen],
            keys=[self.keys[key] for key in chosen],
            times=[self.times[key] for key in chosen],
            turns=turns,
            samples=[0] * len(turns),
        )

    def motion(
        self, first: int = 0, last: int | None = None, progress: Progress | None = None
    ) -> native.Inbetweens:
        """The way through keys `first` to `last`, at their `times`. Raises SolveError, Cancelled."""
        last = len(self.keys) - 1 if last is None else last
        return native.Inbetweens(
            np.stack(self.keys[first : last + 1]),
            **self.elements,
            rest=self.rest,
            key_times=self.times[first : last + 1],
            turns=np.array(self.turns[first:last], np.int32)[:, None],
            anchor=self.anchors[first:last],
            anchor_path=self.path.lower(),
            smooth=self.smooth,
            progress=progress,
        )

    def solve(self, progress: Progress | None = None) -> list[Array]:
        """The generated positions, n x 2 each, in order. Raises SolveError and Cancelled."""
        found: list[Array] = []
        runs = self._runs()
        for number, (first, last) in enumerate(runs):

            def solved(share: float, number: int = number) -> bool | None:
                done = (number + (1.0 - _SAMPLED) * share) / len(runs)
                return True if progress is None else progress(done)

            motion = self.motion(first, last, solved)
            for transition in range(first, last):
                if self.samples[transition]:
                    found += list(motion.at(self._sample_times(transition)))
                share = (transition + 1 - first) / (last - first)
                if progress is not None and progress((number + share) / len(runs)) is False:
                    raise native.Cancelled
        return found

    def coordinates(self, transition: int, share: float, positions: Array) -> np.ndarray:
        """The shape that shows n x 2 positions at this share of a transition; below 0 and above 1, too.

        What the plane does not tell goes from one pose to the other in proportion. Raises Refusal beyond what
        Blender can store.
        """
        before, after = self.shapes[transition], self.shapes[transition + 1]
        blended = before * np.float32(1.0 - share) + after * np.float32(share)
        return self.scene.moved(blended, positions)

    def _sample_times(self, transition: int) -> Array:
        count = self.samples[transition]
        before, after = self.times[transition : transition + 2]
        return np.asarray(before + (after - before) * np.arange(1, count + 1) / (count + 1))

    def _runs(self) -> list[tuple[int, int]]:
        """The first and last keys of transitions in a row that are to be solved, with what decides on them."""
        around = 1 if self.smooth else 0
        runs: list[tuple[int, int]] = []
        for transition, count in enumerate(self.samples):
            if count:
                first = max(0, transition - around)
                last = min(len(self.samples), transition + 1 + around)
                if runs and first <= runs[-1][1]:
                    first = runs.pop()[0]
                runs.append((first, last))
        return runs


def plan(
    scene: SceneShape,
    *,
    poses: Sequence[int] | None = None,
    path: str | None = None,
    smooth: bool | None = None,
) -> Plan:
    """What is to be generated for all poses, or for those chosen as if there were no others.

    `path` ("STRAIGHT" or "ARC") and `smooth` are the object's own unless told.

    Stretches that have been edited since they were generated are left as they are, while their poses are the
    same. Raises Refusal; changes nothing.
    """
    obj = scene.resolve()
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    digests.forget()
    found = stretches(obj)
    dropped = set() if poses is None else _places(obj, set(range(len(obj.planar.poses))) - set(poses))
    found = [stretch for stretch in found if stretch.start.source not in dropped]
    starts = [stretch.start.source for stretch in found]
    entries = entries_of(obj, starts)
    played = [index for index, entry in enumerate(entries) if entry.first is not None]
    if len(played) < 2:
        raise Refusal("The curve shows one pose only: key another one at a later frame")
    entries_played = entries[played[0] : played[-1] + 1]
    listed = {pose.at: pose for pose in obj.planar.poses}
    stamps = Stamps(obj)
    made_of, shapes, turns = [], [], []
    for entry in entries_played:
        pose = listed.get(starts[entry.block])
        place = starts[entry.block]
        if pose is not None and (original := stamps.original(pose)) is not None:
            place = original.at
        made_of.append(stamps.digest(place))
        shapes.append(points_of(obj, block_at(obj.data.shape_keys, place)))
        turns.append(0 if pose is None or entry.copy else pose.turns)
    result = _plan_of(scene, obj, shapes, turns[:-1])
    if path is not None:
        result.path = path
    if smooth is not None:
        result.smooth = smooth
    result.times = _times(entries_played)
    result.entries, result.first = entries, played[0]
    result.starts, result.dropped = starts, sorted(dropped)
    for transition, (before, after) in enumerate(zip(entries_played, entries_played[1:], strict=False)):
        start, end = found[before.block].start, found[after.block].start
        count = frames_between(before, after)
        if start.pose is None or end.pose is None or made_of[transition] == made_of[transition + 1]:
            count = 0
        elif _stays(stamps, found[before.block], before, after, made_of, transition, result):
            result.kept.add(transition)
            count = 0
        result.samples.append(count)
    if not any(result.samples) and not result.kept:
        raise Refusal("There are no frames to fill between the poses: move their keys apart")
    generated = sum(result.samples) + sum(
        found[entries_played[k].block].start.pose["generated"] for k in result.kept
    )
    if FIRST + SPACING * (len(entries) + generated) >= HOLD:
        raise Refusal(f"{generated} in-betweens are too many for one object: cut the shot into pieces")
    return result


def between(scene: SceneShape, poses: Sequence[int], times: Sequence[float]) -> Plan:
    """The way through some poses (indices) at these times; for motion() and coordinates(). Raises Refusal."""
    obj = scene.resolve()
    chosen = [obj.planar.poses[pose] for pose in poses]
    shapes = [points_of(obj, block_at(obj.data.shape_keys, pose.at)) for pose in chosen]
    result = _plan_of(scene, obj, shapes, [pose.turns for pose in chosen[:-1]])
    result.times = list(times)
    return result


def write(scene: SceneShape, plan: Plan, shapes: Sequence[Array]) -> Iterator[float]:
    """Put in what plan.solve() gave, in place of what was generated before; yields the share that is done.

    Closed before its end, or where anything fails, everything is back to the bit. Raises ObjectGone where the
    poses are not those of the plan any more, Refusal beyond what Blender can store.
    """
    obj = scene.resolve()
    found = [stretch for stretch in stretches(obj) if stretch.start.source not in plan.dropped]
    if [stretch.start.source for stretch in found] != plan.starts:
        raise ObjectGone(f"The poses of '{obj.name}' have changed meanwhile")
    blocks, starts = _blocks(obj, plan, found, shapes)
    was_unkeyed = sequence.unkeyed(obj)

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        obj.planar.anchor_path, obj.planar.smooth = plan.path, plan.smooth
        _drop_keys(obj, plan.dropped)
        _expand(obj, plan, playback.places_of(blocks)[starts])

    yield from playback.relay(obj, blocks, then)
    _show(scene.resolve(), was_unkeyed)


def remove(obj: bpy.types.Object) -> None:
    """Take all in-betweens out: what was there before they were generated is back, to the bit.

    Poses that have been keyed, deleted or edited since stay so. Raises Refusal.
    """
    reason = sequence.refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    digests.forget()
    found = stretches(obj)
    folded = _folded(obj, found)  # places of repeated poses, and where the poses are that they repeat
    order = _order_before([stretch for stretch in found if stretch.start.source not in folded])
    shown = np.array([stretch.start.source for stretch in found])
    plain = FIRST + SPACING * np.arange(len(found))
    settings = obj.planar
    blocks = [stretch.start for stretch in order]
    for block in blocks:
        block.free = 0
        if block.pose is not None:
            block.pose |= {"stamp": "", "edited": False, "order_before": 0}
    at = {block.source: place for block, place in zip(blocks, playback.places_of(blocks), strict=True)}
    final = np.array([at[folded.get(place, place)] for place in shown.tolist()])
    active = settings.poses[settings.active_pose].at if settings.active_pose < len(settings.poses) else None
    was_unkeyed = sequence.unkeyed(obj)

    def then(obj: bpy.types.Object, old: Array, new: Array) -> None:
        curve = own_curve(obj.data.shape_keys)
        if curve is not None:
            was = offsets(pose_curve.rows(curve), shown, plain, settings.curve_before)
            pose_curve.write_rows(curve, final[was.pose][:, None] + was.values, was)
        settings.curve_before = ""

    playback.run(playback.relay(obj, blocks, then))
    for index, pose in enumerate(settings.poses):
        if active in folded and pose.at == at[folded[active]]:
            settings.active_pose = index
    _show(obj, was_unkeyed)


def _plan_of(scene: SceneShape, obj: bpy.types.Object, shapes: list[np.ndarray], turns: list[int]) -> Plan:
    """A plan for these poses, without times and samples."""
    return Plan(
        scene=scene,
        shapes=shapes,
        keys=[scene.flattened(shape) for shape in shapes],
        rest=scene.rest,
        elements=scene.elements,
        times=[],
        samples=[],
        turns=turns,
        held=_held(scene, obj),
        path=obj.planar.anchor_path,
        smooth=obj.planar.smooth,
    )


def _held(scene: SceneShape, obj: bpy.types.Object) -> list[Indices]:
    """The vertices of each enabled pin in each part."""
    pins = [] if is_outline(obj) else scene_pins.model_pins(obj, scene)
    return [
        pin.vertices[scene.parts[pin.vertices] == part]
        for pin in pins
        if pin.enabled
        for part in np.unique(scene.parts[pin.vertices])
    ]


def _times(entries: Sequence[Entry]) -> list[float]:
    times = [0.0]
    for before, after in zip(entries, entries[1:], strict=False):
        times.append(times[-1] + max(after.first - before.last, SAME_FRAME))
    return times


def _stays(
    stamps: Stamps,
    stretch: Stretch,
    before: Entry,
    after: Entry,
    made_of: list[str],
    transition: int,
    plan: Plan,
) -> bool:
    """Whether what is generated behind a pose has been edited, and is to be generated from the same."""
    record = stretch.start.pose
    if not (record["edited"] and stretch.samples) or before.copy or after.block != before.block + 1:
        return False
    return bool(record["stamp"] == stamps.of(made_of, transition, record["turns"], plan.path, plan.smooth))


def _places(obj: bpy.types.Object, poses: set[int]) -> set[float]:
    return {pose.at for index, pose in enumerate(obj.planar.poses) if index in poses}


def _blocks(
    obj: bpy.types.Object, plan: Plan, found: list[Stretch], shapes: Sequence[Array]
) -> tuple[list[Block], list[int]]:
    """The played range to be, and which of its blocks are those of the plan's entries."""
    stamps = Stamps(obj)
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
            blocks += stretch.samples
            continue
        count = plan.samples[transition] if 0 <= transition < len(plan.samples) else 0
        stamp = ""
        if count:
            stamp = stamps.of(made_of, transition, plan.turns[transition], plan.path, plan.smooth)
        start.pose |= {"edited": False, "stamp": stamp}
        before = [] if entry.copy or len(stretch.samples) != count else stretch.samples
        for sample in range(count):
            share = (sample + 1) / (count + 1)
            shape = partial(plan.coordinates, transition, share, next(waiting))
            source = before[sample].source if before else None
            blocks.append(Block(_sample_name(start.name, sample + 1), shape, source, sample=True))
    return blocks, starts


def _free_name(name: str, taken: set[str]) -> str:
    names = itertools.chain([f"{name} Repeat"], (f"{name} Repeat {number}" for number in itertools.count(2)))
    found = next(name for name in names if name not in taken)
    taken.add(found)
    return found


def _sample_name(pose: str, number: int) -> str:
    """A name that tells where it belongs, no longer than Blender's names can be."""
    behind = f" +{number}"
    return pose.encode()[: 63 - len(behind)].decode(errors="ignore") + behind


def _drop_keys(obj: bpy.types.Object, dropped: Sequence[float]) -> None:
    keys = obj.data.shape_keys
    values = keyed(keys)[:, 1]
    at = np.array(dropped).reshape(1, -1)
    pose_curve.remove_keys(keys, (np.abs(values[:, None] - at) < SAME_PLACE).any(axis=1))


def _expand(obj: bpy.types.Object, plan: Plan, shown: Array) -> None:
    """Take the curve to where the plan's entries are shown now."""
    settings = obj.planar
    curve = own_curve(obj.data.shape_keys)
    rows = pose_curve.rows(curve)
    old = np.array(plan.starts)
    was = offsets(rows, old, FIRST + SPACING * np.arange(len(old)), settings.curve_before)
    entry = np.array(
        [_entry_of(plan, *key) for key in zip(was.pose.tolist(), rows.keys[:, 0].tolist(), strict=True)]
    )
    plain = FIRST + SPACING * np.arange(len(shown))
    pose_curve.write_rows(curve, moved(plain[entry][:, None] + was.values, plain, shown))
    before = Offsets(entry, was.values, was.sides, was.exact)
    settings.curve_before = remember(pose_curve.rows(curve), before)


def _entry_of(plan: Plan, block: int, frame: float) -> int:
    """Which time that a block is played is meant by a key at a frame."""
    found = [index for index, entry in enumerate(plan.entries) if entry.block == block]
    begun = [
        index
        for index in found
        if plan.entries[index].first is not None and plan.entries[index].first <= frame
    ]
    return (begun or found)[-1 if begun else 0]


def _folded(obj: bpy.types.Object, found: list[Stretch]) -> dict[float, float]:
    """Places of poses that repeat others still, and of those."""
    stamps = Stamps(obj)
    there = {stretch.start.source for stretch in found}
    originals = {pose.at: stamps.original(pose) for pose in obj.planar.poses if pose.at in there}
    return {
        place: original.at
        for place, original in originals.items()
        if original is not None and originals.get(original.at) is None
    }


def _order_before(found: list[Stretch]) -> list[Stretch]:
    """The order from before poses were put in the order of time; what is new stays behind what it is behind."""
    ranks = []
    latest = 0
    for stretch in found:
        if stretch.start.pose is not None and stretch.start.pose["order_before"]:
            latest = stretch.start.pose["order_before"]
        ranks.append(latest)
    return [found[index] for index in sorted(range(len(found)), key=lambda index: ranks[index])]


def _show(obj: bpy.types.Object, was_unkeyed: bool) -> None:
    """Show the frame, or the unkeyed pose, which Blender takes back for all animation has been marked."""
    digests.forget()
    sequence.show_frame(obj)
    if was_unkeyed:
        bpy.context.view_layer.update()
        obj.data.shape_keys.eval_time = SCRATCH
        sequence.points.update(obj)
