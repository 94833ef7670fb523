# SPDX-License-Identifier: GPL-3.0-or-later
"""The played range of a pose sequence laid anew: the one way in which its blocks come, go and move.

A block cannot be moved: it is taken out and added again at its new eval_time, and the curve's values follow.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...errors import ObjectGone, naming, try_all
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_EVAL_TIME, moved
from ..storage.points import read_block, write_block
from . import pose_curve
from .pose_blocks import (
    FIRST,
    HOLD,
    SPACING,
    STILL,
    add,
    blended,
    block_at,
    eval_times,
    shown_curve,
    take_out,
)

Record = dict[str, Any]

# What Blender keeps of a block beside its name, eval_time and shape.
_SETTINGS = (
    *("interpolation", "lock_shape", "mute", "vertex_group"),
    *("slider_min", "slider_max", "value"),
)


@dataclass(eq=False)
class Block:
    """A block of the played range, as it is or is to be."""

    name: str
    # See storage/points.py; a function makes it when it is written. None: what `source` holds.
    shape: Array32 | Callable[[], Array32] | None = None
    source: float | None = (
        None  # eval_time of the block of the file that it is, with Blender's settings of it
    )
    pose: Record | None = None  # of a listed pose: what the list keeps of it
    inbetween: bool = False  # generated, for the pose before it
    free: int = 0  # empty eval_times before it, where the user has removed generated blocks

    @property
    def stands_at(self) -> float:
        """The eval_time of the block of the file; blocks_of() gives none without one."""
        assert self.source is not None
        return self.source


def record_of(pose: bpy.types.PropertyGroup) -> Record:
    """What the list keeps of a pose, without its eval_time and what the curve tells."""
    names = [prop.identifier for prop in pose.bl_rna.properties if not prop.is_readonly]
    return {name: getattr(pose, name) for name in names if name not in {"rna_type", "at", "frame"}}


def blocks_of(obj: bpy.types.Object) -> list[Block]:
    """The played range as it is."""
    keys = obj.data.shape_keys
    poses = {pose.at: pose for pose in obj.planar.poses}
    present = whole(eval_times(keys))
    behind = _generated_behind(obj, set(present.tolist()))
    blocks: list[Block] = []
    owned, latest = (
        0,
        FIRST,
    )  # generated eval_times that are still to come, and the eval_time before the next of them
    for block, eval_time in zip(keys.key_blocks, present.tolist(), strict=True):
        if not FIRST - SAME_EVAL_TIME < eval_time < HOLD:
            continue
        found = Block(block.name, source=eval_time)
        steps = round((eval_time - latest) / SPACING)
        if eval_time in behind:
            found.pose, found.free = record_of(poses[eval_time]), owned
            owned, latest = behind[eval_time], eval_time
        elif 0 < steps <= owned and eval_time == latest + steps * SPACING:
            found.inbetween, found.free = True, steps - 1
            owned, latest = owned - steps, eval_time
        blocks.append(found)
    return blocks


def _generated_behind(obj: bpy.types.Object, present: set[float]) -> dict[float, int]:
    """How many are generated behind each pose, by its eval_time; those of a lost pose are the last one's."""
    behind: dict[float, int] = {}
    latest = None
    for pose in obj.planar.poses:
        if pose.at in present:
            latest = pose.at
            behind[latest] = pose.generated
        elif latest is not None and (behind[latest] or pose.generated):
            behind[latest] += 1 + pose.generated
    return behind


def whole(at: Array) -> Array:
    """Places freed of Blender's rounding."""
    whole = np.round(at)
    return np.asarray(np.where(np.abs(at - whole) < SAME_EVAL_TIME, whole, at))


def eval_times_of(blocks: Sequence[Block]) -> Array:
    """Where these blocks will be."""
    steps = np.cumsum([1 + block.free for block in blocks], dtype=np.float64)
    return np.asarray(FIRST + SPACING * (steps - steps[0]) if len(steps) else steps)


def inbetween_name(pose: str, number: int) -> str:
    """A name that tells where it belongs, no longer than Blender's names can be."""
    behind = f" +{number}"
    return pose.encode()[: 63 - len(behind)].decode(errors="ignore") + behind


Steps = Generator[float, None, None]  # something done step by step, which yields the share done


def run(steps: Iterator[float]) -> None:
    """Do all of something that is done step by step."""
    for _ in steps:
        pass


def named(name: str | None, steps: Steps) -> Steps:
    """The same, whose refusals tell which object they are of; None: it is the only one."""
    with naming(name):
        yield from steps


def together(several: Sequence[Steps]) -> Steps:
    """Do several things, each step by step: all of them, or none.

    When all that can go wrong of one is done it yields 1; closed there, it still takes everything back. One
    that ends before has nothing to take back. This yields 1 likewise.
    """
    try:
        for number, steps in enumerate(several):
            for share in steps:
                if share >= 1.0:
                    break
                yield (number + share) / len(several)
        yield 1.0
    except BaseException:
        try_all(steps.close for steps in reversed(several))
        raise
    for steps in several:
        run(steps)


Follow = Callable[[bpy.types.Object, Array, Array], None]


def follow(obj: bpy.types.Object, old: Array, new: Array) -> None:
    """What the curve does by default when blocks go from old to new eval_times."""
    if len(old):
        pose_curve.follow(obj.data.shape_keys, old, new)


def relay(obj: bpy.types.Object, blocks: Sequence[Block], then: Follow = follow) -> Steps:
    """Replace the played range by these blocks, one a step; yields the share that is done, see together().

    `then` is called at the end, with the old and new eval_times of the blocks that stay in order, to edit the
    curve. Between the steps the object shows what it showed. Closed before its end, or where anything fails,
    everything is back to the bit. A first block has `free` 0.
    """
    find = finder(obj)
    undo = _Undo(obj)
    try:
        yield from _lay(find, undo, blocks, then)
        yield 1.0
    except BaseException:
        with contextlib.suppress(ObjectGone):
            undo.restore(find())
        raise


def _lay(
    find: Callable[[], bpy.types.Object], undo: _Undo, blocks: Sequence[Block], then: Follow
) -> Iterator[float]:
    obj = find()
    keys = obj.data.shape_keys
    at = eval_times_of(blocks)
    kept = {
        block.source: eval_time
        for block, eval_time in zip(blocks, at, strict=True)
        if block.source is not None
    }
    by_source = {block.source: block for block in blocks if block.source is not None}
    present = whole(eval_times(keys))
    present = present[(present > FIRST - SAME_EVAL_TIME) & (present < HOLD)].tolist()
    names = dict(zip(whole(eval_times(keys)).tolist(), keys.key_blocks.keys(), strict=True))
    leaving = [
        eval_time
        for eval_time in present
        if kept.get(eval_time) != eval_time or by_source[eval_time].name != names[eval_time]
    ]
    gone = set(leaving)
    work = len(leaving) + len(blocks)
    undo.show_still(obj)
    settings: dict[float | None, Record] = {}
    for done, eval_time in enumerate(leaving):
        obj = find()
        old = undo.take_out(obj, eval_time)
        settings[eval_time] = old.settings
        if eval_time in by_source and by_source[eval_time].shape is None:
            by_source[eval_time].shape = old.shape
        obj.data.shape_keys.eval_time = STILL
        yield done / work
    for done, (block, eval_time) in enumerate(zip(blocks, at, strict=True), len(leaving)):
        obj = find()
        shape = block.shape() if callable(block.shape) else block.shape
        if block.source != eval_time or eval_time in gone:
            assert shape is not None  # a block that is new has one, of the others it has been read
            block.name = undo.add(obj, block.name, eval_time, shape, settings.get(block.source))
        elif shape is not None:
            undo.overwrite(obj, eval_time, shape)
        obj.data.shape_keys.eval_time = STILL
        yield done / work
    obj = find()
    pairs = sorted((old, new) for old, new in kept.items() if old in present)
    undo.show_as_before(obj, dict(pairs))
    _list(obj, blocks, at, dict(pairs))
    old, new = np.array(pairs, np.float64).reshape(-1, 2).T
    then(obj, old, new)


def _list(obj: bpy.types.Object, blocks: Sequence[Block], at: Array, moved: Mapping[float, float]) -> None:
    poses = obj.planar.poses
    active = obj.planar.active_pose
    active_at = moved.get(poses[active].at) if 0 <= active < len(poses) else None
    listed: list[tuple[float, Record]] = []
    # A new pose may have the name of one that is gone, which others repeated.
    there = {block.name for block in blocks if block.pose is not None and block.source is not None}
    for block, eval_time in zip(blocks, at.tolist(), strict=True):
        if listed and (block.inbetween or block.pose is not None):
            listed[-1][1]["generated"] += block.free + block.inbetween
        if block.pose is not None:
            record = {**block.pose, "name": block.name, "generated": 0}
            if record.get("copy_of") not in there:
                record["copy_of"] = ""
            listed.append((eval_time, record))
    write_list(obj, listed)
    for index, pose in enumerate(poses):
        if pose.at == active_at:
            obj.planar.active_pose = index
    obj.planar.active_pose = max(0, min(obj.planar.active_pose, len(poses) - 1))
    if not any(block.inbetween for block in blocks):
        obj.planar.curve_before = ""  # the curve is as it would be without having been filled


def write_list(obj: bpy.types.Object, listed: Sequence[tuple[float, Record]]) -> None:
    """Let the list have these poses, by their eval_times.

    What it has becomes other poses and stays in memory: this may be done while Blender sets a property of one
    of them.
    """
    poses = obj.planar.poses
    while len(poses) < len(listed):
        poses.add()
    while len(poses) > len(listed):
        poses.remove(len(poses) - 1)
    for pose in poses:
        for name in ("at", *record_of(pose)):  # without its eval_time a new name renames no block
            pose.property_unset(name)
    for pose, (eval_time, record) in zip(poses, listed, strict=True):
        for name, value in record.items():
            setattr(pose, name, value)
        pose.at = eval_time


def finder(obj: bpy.types.Object) -> Callable[[], bpy.types.Object]:
    """Finds the object again in each step: references die with every undo."""
    name, uid = obj.name, obj.session_uid

    def find() -> bpy.types.Object:
        found = bpy.data.objects.get(name)
        if found is None or found.session_uid != uid or found.data.shape_keys is None:
            raise ObjectGone(f"'{name}' is gone")
        return found

    return find


@dataclass
class _Stored:
    """A block as it was."""

    name: str
    eval_time: float
    shape: Array32
    settings: Record


class _Undo:
    """What was there, piece by piece as it is changed, and what has been added."""

    def __init__(self, obj: bpy.types.Object):
        keys = obj.data.shape_keys
        settings = obj.planar
        self._eval_time, self._frame = keys.eval_time, bpy.context.scene.frame_current_final
        self._active = _active_eval_time(obj)
        self._active_pose = settings.active_pose
        self._poses = [(pose.at, record_of(pose)) for pose in settings.poses]
        names = "curve_before", "anchor_path", "smooth", "depth_between"
        self._before = {name: getattr(settings, name) for name in names}
        self._curve = pose_curve.SavedCurve(keys)
        self._still = False
        self._removed: list[_Stored] = []
        self._overwritten: list[tuple[float, Array32]] = []
        self._added: list[float] = []

    def show_still(self, obj: bpy.types.Object) -> None:
        """Show what is shown, from where no step touches it."""
        shape = blended(obj, self._eval_time)
        self._still = True
        add(obj, "Shown", STILL, shape)

    def take_out(self, obj: bpy.types.Object, eval_time: float) -> _Stored:
        block = block_at(obj.data.shape_keys, eval_time)
        assert block is not None  # the eval_time is one of those there are
        settings = {name: getattr(block, name) for name in _SETTINGS}
        stored = _Stored(block.name, eval_time, read_block(obj, block), settings)
        obj.shape_key_remove(block)
        self._removed.append(stored)
        return stored

    def overwrite(self, obj: bpy.types.Object, eval_time: float, shape: Array32) -> None:
        block = block_at(obj.data.shape_keys, eval_time)
        self._overwritten.append((eval_time, read_block(obj, block)))
        write_block(block, shape)

    def add(
        self, obj: bpy.types.Object, name: str, eval_time: float, shape: Array32, settings: Record | None
    ) -> str:
        """Add a block; the name it has got."""
        block = add(obj, name, eval_time, shape)
        for setting, value in (settings or {}).items():
            setattr(block, setting, value)
        self._added.append(eval_time)
        return str(block.name)

    def show_as_before(self, obj: bpy.types.Object, carried: Mapping[float, float]) -> None:
        """Show the same values again, with the same block active where it is now."""
        take_out(obj, block_at(obj.data.shape_keys, STILL))
        keys = obj.data.shape_keys
        keys.eval_time = self._eval_time
        if shown_curve(keys) is None and carried and self._eval_time < HOLD:
            old, new = np.array(sorted(carried.items())).T
            keys.eval_time = float(moved(np.array([self._eval_time]), old, new)[0])
        _activate(obj, carried.get(self._active, self._active))

    def restore(self, obj: bpy.types.Object) -> None:
        """Everything as it was, to the bit."""
        keys, settings = obj.data.shape_keys, obj.planar
        for eval_time in self._added:
            obj.shape_key_remove(block_at(keys, eval_time))
        for eval_time, shape in self._overwritten:
            write_block(block_at(keys, eval_time), shape)
        for stored in self._removed:
            block = add(obj, stored.name, stored.eval_time, stored.shape)
            for setting, value in stored.settings.items():
                setattr(block, setting, value)
        if self._still and (still := block_at(keys, STILL)) is not None:
            take_out(obj, still)
        write_list(obj, self._poses)
        for name, value in self._before.items():
            setattr(settings, name, value)
        settings.active_pose = self._active_pose
        self._curve.restore(keys)
        keys.eval_time = self._eval_time
        frame, curve = bpy.context.scene.frame_current_final, shown_curve(keys)
        if frame != self._frame and curve is not None:  # the timeline has gone on
            keys.eval_time = curve.evaluate(frame)
        elif self._eval_time >= HOLD:  # Blender reads the curve anew, and would take the unkeyed pose back
            bpy.context.view_layer.update()
            keys.eval_time = self._eval_time
        _activate(obj, self._active)


def _active_eval_time(obj: bpy.types.Object) -> float:
    block = obj.active_shape_key
    return 0.0 if block is None else float(whole(np.array([block.frame]))[0])


def _activate(obj: bpy.types.Object, eval_time: float) -> None:
    """Make the block at an eval_time the active one, or the last one before it."""
    below = np.flatnonzero(eval_times(obj.data.shape_keys) < eval_time + SAME_EVAL_TIME)
    obj.active_shape_key_index = int(below[-1]) if len(below) else 0
