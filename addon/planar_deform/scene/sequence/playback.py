# SPDX-License-Identifier: GPL-3.0-or-later
"""The played range of a pose sequence laid anew: the one way in which its blocks come, go and change places.

A block cannot be moved: it is taken out and added again at its new place, and the curve's values follow.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...errors import ObjectGone
from ...model.plane.frame import Array, Array32
from ...model.timing.played_curve import SAME_PLACE, moved
from ..storage.points import read_block, write_block
from . import pose_curve
from .pose_blocks import FIRST, HOLD, SPACING, STILL, add, blended, block_at, places, shown_curve, take_out

Record = dict[str, Any]

# What Blender keeps of a block beside its name, place and shape.
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
    source: float | None = None  # place of the block of the file that it is, with Blender's settings of it
    pose: Record | None = None  # of a listed pose: what the list keeps of it
    sample: bool = False  # generated, for the pose before it
    free: int = 0  # empty places before it, where the user has removed generated blocks

    @property
    def stands_at(self) -> float:
        """The place of the block of the file; blocks_of() gives none without one."""
        assert self.source is not None
        return self.source


def record_of(pose: bpy.types.PropertyGroup) -> Record:
    """What the list keeps of a pose, without its place and what the curve tells."""
    names = [prop.identifier for prop in pose.bl_rna.properties if not prop.is_readonly]
    return {name: getattr(pose, name) for name in names if name not in {"rna_type", "at", "frame"}}


def blocks_of(obj: bpy.types.Object) -> list[Block]:
    """The played range as it is."""
    keys = obj.data.shape_keys
    poses = {pose.at: pose for pose in obj.planar.poses}
    present = whole(places(keys))
    behind = _generated_behind(obj, set(present.tolist()))
    blocks: list[Block] = []
    owned, latest = 0, FIRST  # generated places that are still to come, and the place before the next of them
    for block, place in zip(keys.key_blocks, present.tolist(), strict=True):
        if not FIRST - SAME_PLACE < place < HOLD:
            continue
        found = Block(block.name, source=place)
        steps = round((place - latest) / SPACING)
        if place in behind:
            found.pose, found.free = record_of(poses[place]), owned
            owned, latest = behind[place], place
        elif 0 < steps <= owned and place == latest + steps * SPACING:
            found.sample, found.free = True, steps - 1
            owned, latest = owned - steps, place
        blocks.append(found)
    return blocks


def _generated_behind(obj: bpy.types.Object, present: set[float]) -> dict[float, int]:
    """Generated places behind each pose, by its place; those of a pose that is lost are the last one's."""
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
    return np.asarray(np.where(np.abs(at - whole) < SAME_PLACE, whole, at))


def places_of(blocks: Sequence[Block]) -> Array:
    """Where these blocks will be."""
    steps = np.cumsum([1 + block.free for block in blocks], dtype=np.float64)
    return np.asarray(FIRST + SPACING * (steps - steps[0]) if len(steps) else steps)


def sample_name(pose: str, number: int) -> str:
    """A name that tells where it belongs, no longer than Blender's names can be."""
    behind = f" +{number}"
    return pose.encode()[: 63 - len(behind)].decode(errors="ignore") + behind


def run(steps: Iterator[float]) -> None:
    """Do all of something that is done step by step."""
    for _ in steps:
        pass


Follow = Callable[[bpy.types.Object, Array, Array], None]


def follow(obj: bpy.types.Object, old: Array, new: Array) -> None:
    """What the curve does by default when blocks go from old to new places."""
    if len(old):
        pose_curve.follow(obj.data.shape_keys, old, new)


def relay(obj: bpy.types.Object, blocks: Sequence[Block], then: Follow = follow) -> Iterator[float]:
    """Replace the played range by these blocks, one a step; yields the share that is done.

    `then` is called at the end, with the old and new places of the blocks that stay in order, to edit the
    curve. Between the steps the object shows what it showed. Closed before its end, or where anything fails,
    everything is back to the bit. A first block has `free` 0.
    """
    find = finder(obj)
    undo = _Undo(obj)
    try:
        yield from _lay(find, undo, blocks, then)
    except BaseException:
        with contextlib.suppress(ObjectGone):
            undo.restore(find())
        raise


def _lay(
    find: Callable[[], bpy.types.Object], undo: _Undo, blocks: Sequence[Block], then: Follow
) -> Iterator[float]:
    obj = find()
    keys = obj.data.shape_keys
    at = places_of(blocks)
    kept = {block.source: place for block, place in zip(blocks, at, strict=True) if block.source is not None}
    by_source = {block.source: block for block in blocks if block.source is not None}
    present = whole(places(keys))
    present = present[(present > FIRST - SAME_PLACE) & (present < HOLD)].tolist()
    names = dict(zip(whole(places(keys)).tolist(), keys.key_blocks.keys(), strict=True))
    leaving = [
        place for place in present if kept.get(place) != place or by_source[place].name != names[place]
    ]
    gone = set(leaving)
    work = len(leaving) + len(blocks)
    undo.show_still(obj)
    settings: dict[float | None, Record] = {}
    for done, place in enumerate(leaving):
        obj = find()
        old = undo.take_out(obj, place)
        settings[place] = old.settings
        if place in by_source and by_source[place].shape is None:
            by_source[place].shape = old.shape
        obj.data.shape_keys.eval_time = STILL
        yield done / work
    for done, (block, place) in enumerate(zip(blocks, at, strict=True), len(leaving)):
        obj = find()
        shape = block.shape() if callable(block.shape) else block.shape
        if block.source != place or place in gone:
            assert shape is not None  # a block that is new has one, of the others it has been read
            block.name = undo.add(obj, block.name, place, shape, settings.get(block.source))
        elif shape is not None:
            undo.overwrite(obj, place, shape)
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
    poses.clear()
    latest = None
    # A new pose may have the name of one that is gone, which others repeated.
    there = {block.name for block in blocks if block.pose is not None and block.source is not None}
    for block, place in zip(blocks, at.tolist(), strict=True):
        if latest is not None and (block.sample or block.pose is not None):
            latest.generated += block.free + block.sample
        if block.pose is not None:
            record = {**block.pose, "name": block.name, "generated": 0}
            if record.get("copy_of") not in there:
                record["copy_of"] = ""
            latest = _add_pose(obj, place, record)
    for index, pose in enumerate(poses):
        if pose.at == active_at:
            obj.planar.active_pose = index
    obj.planar.active_pose = max(0, min(obj.planar.active_pose, len(poses) - 1))
    if not any(block.sample for block in blocks):
        obj.planar.curve_before = ""  # the curve is as it would be without having been filled


def _add_pose(obj: bpy.types.Object, place: float, record: Record) -> bpy.types.PropertyGroup:
    pose = obj.planar.poses.add()
    for name, value in record.items():
        setattr(pose, name, value)
    pose.at = place  # from now on a new name renames the block there
    return pose


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
    place: float
    shape: Array32
    settings: Record


class _Undo:
    """What was there, piece by piece as it is changed, and what has been added."""

    def __init__(self, obj: bpy.types.Object):
        keys = obj.data.shape_keys
        settings = obj.planar
        self._eval_time, self._frame = keys.eval_time, bpy.context.scene.frame_current_final
        self._active = _active_place(obj)
        self._active_pose = settings.active_pose
        self._poses = [(pose.at, record_of(pose)) for pose in settings.poses]
        self._before = {name: getattr(settings, name) for name in ("curve_before", "anchor_path", "smooth")}
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

    def take_out(self, obj: bpy.types.Object, place: float) -> _Stored:
        block = block_at(obj.data.shape_keys, place)
        assert block is not None  # the place is one of those there are
        settings = {name: getattr(block, name) for name in _SETTINGS}
        stored = _Stored(block.name, place, read_block(obj, block), settings)
        obj.shape_key_remove(block)
        self._removed.append(stored)
        return stored

    def overwrite(self, obj: bpy.types.Object, place: float, shape: Array32) -> None:
        block = block_at(obj.data.shape_keys, place)
        self._overwritten.append((place, read_block(obj, block)))
        write_block(block, shape)

    def add(
        self, obj: bpy.types.Object, name: str, place: float, shape: Array32, settings: Record | None
    ) -> str:
        """Add a block; the name it has got."""
        block = add(obj, name, place, shape)
        for setting, value in (settings or {}).items():
            setattr(block, setting, value)
        self._added.append(place)
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
        for place in self._added:
            obj.shape_key_remove(block_at(keys, place))
        for place, shape in self._overwritten:
            write_block(block_at(keys, place), shape)
        for stored in self._removed:
            block = add(obj, stored.name, stored.place, stored.shape)
            for setting, value in stored.settings.items():
                setattr(block, setting, value)
        if self._still and (still := block_at(keys, STILL)) is not None:
            take_out(obj, still)
        settings.poses.clear()
        for at, record in self._poses:
            _add_pose(obj, at, record)
        for name, value in self._before.items():
            setattr(settings, name, value)
        settings.active_pose = self._active_pose
        self._curve.restore(keys)
        keys.eval_time = self._eval_time
        frame, curve = bpy.context.scene.frame_current_final, shown_curve(keys)
        if frame != self._frame and curve is not None:  # the timeline has gone on
            keys.eval_time = curve.evaluate(frame)
        _activate(obj, self._active)


def _active_place(obj: bpy.types.Object) -> float:
    block = obj.active_shape_key
    return 0.0 if block is None else float(whole(np.array([block.frame]))[0])


def _activate(obj: bpy.types.Object, place: float) -> None:
    """Make the block at a place the active one, or the last one before it."""
    below = np.flatnonzero(places(obj.data.shape_keys) < place + SAME_PLACE)
    obj.active_shape_key_index = int(below[-1]) if len(below) else 0
