# SPDX-License-Identifier: GPL-3.0-or-later
"""One pose sequence made of those of drawings that have been joined: each part plays on as it did.

Where the curves are the same, the shapes of each eval_time are put together, and the curve stays. Otherwise
there is a pose wherever one of the parts has one, and what comes in between is as union.py tells.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import bpy
import numpy as np

from ... import compat
from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.timing.ease import LINEAR
from ...model.timing.played_curve import SAME_EVAL_TIME, SAME_FRAME, Rows
from ...model.timing.union import Stop, Track, is_same, union
from ..storage import changes, points
from ..storage.shape_keys import POSE_KEY
from . import playback, pose_curve, pose_showing, pose_state, stretches
from .joined_parts import (
    Came,
    Fresh,
    Part,
    Played,
    Poses,
    Still,
    foreign,
    is_sequence,
    listed,
    parts_of,
    settings_of,
)
from .playback import Block, Record, inbetween_name
from .pose_blocks import FIRST, add, own_curve, played, shown_curve, take_out
from .pose_edit import begin_sequence
from .pose_insertion import free_names


@dataclass(frozen=True)
class _Before:
    """The poses of an object before a join, which may be undone of the mesh alone."""

    count: int  # of its vertices
    poses: Poses
    settings: Record
    merged: Poses  # after it


_before: dict[int, _Before] = {}  # by the object's session_uid


def merge(obj: bpy.types.Object, owner: int, came: Sequence[Came], rest: Array32 | None) -> list[str]:
    """After a join, make the poses of all parts those of the object; what could not be kept.

    `came`: what has been joined, in the order of its vertices; the rest as parts_of() has it. The lists are
    as they were remembered. Nothing is done where no part has poses.
    """
    keys = obj.data.shape_keys
    ours = pose_state.is_ours(obj)
    if not ours and not any(is_sequence(one) for one in came):
        return []
    others = [] if ours else foreign(keys, came)
    if others:
        return [
            f"The joined poses are plain shape keys now, as '{obj.name}' has its own ({others[0]}). "
            "Undo, and join it to the drawing with the poses"
        ]
    parts, lost = parts_of(obj, owner, came, rest)
    if ours and (reason := pose_state.animation_refusal(keys)) is not None:
        if any(isinstance(part, Played) for part in parts[1:]):
            lost.append(f"What was joined stays as it was shown. {reason}")
        parts[1:] = [Still(part.rows, part.shown(), part.rest, part.before) for part in parts[1:]]
    before = listed(obj) if ours else [], settings_of(obj)
    try:
        _put_together(obj, parts)
    except Refusal as refusal:
        lost.append(f"The poses stay as Blender has joined them. {refusal}")
    _before[obj.session_uid] = _Before(parts[0].rows.stop, *before, listed(obj))
    return lost


def undone() -> None:
    """Blender may undo a join of the mesh alone, as nothing else of the object was changed by it."""
    for obj in bpy.data.objects:
        before = _before.get(obj.session_uid)
        if before is None or obj.type != "MESH" or len(obj.data.vertices) != before.count:
            continue
        if listed(obj) == before.merged:
            playback.write_list(obj, before.poses)
            for name, value in before.settings.items():
                setattr(obj.planar, name, value)


def forget() -> None:
    """Of another file nothing is known."""
    _before.clear()


def _put_together(obj: bpy.types.Object, parts: Sequence[Part]) -> None:
    sequences = [part for part in parts if isinstance(part, Played)]
    base = sequences[0]
    alike = all(part.modifiers == base.modifiers for part in sequences)
    tracks = [part.track(modified=not alike) for part in sequences]
    same = alike and all(is_same(track, tracks[0]) for track in tracks[1:])
    same = same and (tracks[0].rows is not None or (len(tracks) == 1 and base is parts[0]))
    shown = _all(parts, lambda part: part.shown())
    unkeyed = any(part.unkeyed for part in sequences)
    if base is parts[0]:
        active = obj.active_shape_key.name
        for name in set(obj.data.shape_keys.key_blocks.keys()) - set(base.names):
            take_out(obj, obj.data.shape_keys.key_blocks[name])
        obj.active_shape_key_index = max(0, obj.data.shape_keys.key_blocks.find(active))
    else:
        _adopt(obj, parts, base)
    _write_below(obj, parts)
    for block in played(obj.data.shape_keys):
        points.write_block(block, _shape(parts, block.frame))
    stops = [] if same else union(tracks, _ends(sequences, alike))
    if stops:
        _Union(obj, parts, sequences, tracks, stops).write(alike)
    else:
        _mark(obj, base.known.fresh)
    pose_showing.drop_scratch(obj)
    pose_showing.show_frame(obj)
    if unkeyed:
        pose_showing.show_unkeyed(obj, shown)
        pose_showing.keep(obj)
    points.update(obj)


def _mark(obj: bpy.types.Object, fresh: Fresh) -> None:
    """Let what is generated behind these poses belong to them as they are now."""
    changes.tell(obj)
    for edited in (False, True):
        stretches.mark(obj, [pose for pose, was in fresh.items() if was == edited], edited=edited)


def _all(parts: Sequence[Part], of: Callable[[Part], Array32]) -> Array32:
    return np.concatenate([of(part) for part in parts])


def _shape(parts: Sequence[Part], at: float) -> Array32:
    return _all(parts, lambda part: part.shape(at))


def _adopt(obj: bpy.types.Object, parts: Sequence[Part], base: Played) -> None:
    """Give an object without poses those of a part."""
    obj.shape_key_clear()
    points.write(obj, _all(parts, lambda part: part.before))
    begin_sequence(obj, _all(parts, lambda part: part.rest))
    for at, name in base.blocks:
        add(obj, name, at, _shape(parts, at))
    playback.write_list(obj, base.known.poses)
    for name, value in base.known.settings.items():
        if name != "key_before":
            setattr(obj.planar, name, value)
    animation = base.keys.animation_data
    if animation is not None and animation.action is not None:
        own = obj.data.shape_keys.animation_data_create()
        compat.assign_action(own, animation.action, compat.slot_of(animation))


def _write_below(obj: bpy.types.Object, parts: Sequence[Part]) -> None:
    """The shape before the sequence and, at last, the rest."""
    keys = obj.data.shape_keys
    below = [block for block in keys.key_blocks if block.frame < FIRST - SAME_EVAL_TIME]
    points.write_block(below[-1], _all(parts, lambda part: part.before))
    rest = _all(parts, lambda part: part.rest)
    points.write_block(keys.reference_key, rest)
    points.write(obj, rest)  # Blender keeps the Basis there


def _ends(sequences: Sequence[Played], alike: bool) -> list[float]:
    """Up to where poses are shown that no keys stand at."""
    if alike or not any(part.endless for part in sequences):
        return []
    scene = bpy.context.scene
    return [float(scene.frame_start), float(scene.frame_end)]


class _Union:
    """The sequence that plays several ones."""

    def __init__(
        self,
        obj: bpy.types.Object,
        parts: Sequence[Part],
        sequences: Sequence[Played],
        tracks: Sequence[Track],
        stops: Sequence[Stop],
    ):
        self._obj, self._parts = obj, parts
        self._sequences, self._tracks, self._stops = sequences, tracks, stops
        self._blocks: list[Block] = []
        self._block_of: list[int] = []  # of each stop
        self._listed: set[tuple[int, int]] = set()  # sequences and their poses
        self._names: set[str] = set()
        self._edited: set[str] = set()

    def write(self, alike: bool) -> None:
        """Lay it. `alike`: the modifiers of the curves are the same, and stay."""
        for stop in self._stops:
            posed = self._posed(stop)
            if not stop.held or set(posed) - self._listed:
                self._blocks.append(self._block(stop, posed))
            self._listed |= set(posed)
            self._block_of.append(len(self._blocks) - 1)
            name = self._blocks[-1].name
            self._blocks += [
                Block(inbetween_name(name, number), partial(self._shape, values), inbetween=True)
                for number, values in enumerate(stop.passed or (), 1)
            ]
        self._blocks += self._never_played()
        playback.run(playback.relay(self._obj, self._blocks, partial(self._time, alike)))
        self._obj.planar.curve_before = ""
        poses = enumerate(self._obj.planar.poses)
        _mark(self._obj, {index: pose.name in self._edited for index, pose in poses})

    def _posed(self, stop: Stop) -> list[tuple[int, int]]:
        """Which sequences have one of their poses at a stop, and which."""
        return [
            (number, index)
            for number, part in enumerate(self._sequences)
            for index, (at, _) in enumerate(part.known.poses)
            if abs(at - stop.values[number]) < SAME_EVAL_TIME
            and (np.abs(self._tracks[number].frames - stop.frame) < SAME_FRAME).any()
        ]

    def _block(self, stop: Stop, posed: Sequence[tuple[int, int]]) -> Block:
        """A pose for a stop, named as one of those there, which is not listed yet."""
        new = next((which for which in posed if which not in self._listed), None)
        record = {} if new is None else self._kept(*new)
        name = self._named(record)
        if any(self._sequences[number].known.fresh.get(index, False) for number, index in posed):
            self._edited.add(name)
        return Block(name, partial(self._shape, stop.values), pose=record)

    def _never_played(self) -> list[Block]:
        """Poses without a key, behind all others."""
        found = []
        for number, part in enumerate(self._sequences):
            there = {at for at, _ in part.blocks}
            for index, (at, _) in enumerate(part.known.poses):
                if (number, index) not in self._listed and at in there:
                    values = [float(track.at[0]) for track in self._tracks]
                    values[number] = at
                    record = self._kept(number, index)
                    found.append(Block(self._named(record), partial(self._shape, values), pose=record))
        return found

    def _kept(self, sequence: int, pose: int) -> Record:
        """What a pose keeps that is laid anew."""
        known = self._sequences[sequence].known.poses[pose][1]
        return {name: value for name, value in known.items() if name in {"name", "turns"}}

    def _named(self, record: Record) -> str:
        name = str(record.get("name", POSE_KEY))
        if name in self._names:
            name = next(free_names(self._names))
        self._names.add(name)
        return name

    def _shape(self, values: Sequence[float]) -> Array32:
        """Of all parts, where the sequences show these eval_times."""
        at = dict(zip(map(id, self._sequences), values, strict=True))
        return _all(self._parts, lambda part: part.shape(at.get(id(part), 0.0)))

    def _time(self, alike: bool, obj: bpy.types.Object, _old: Array, _new: Array) -> None:
        """Give the object a curve of its own that stops at the stops."""
        keys = obj.data.shape_keys
        at = playback.eval_times_of(self._blocks)[self._block_of]
        if shown_curve(keys) is None:
            pose_curve.key(obj, {self._stops[0].frame: at[0]}, LINEAR)
        animation = keys.animation_data
        # Undo of the join brings the action back that there was, and knows nothing of what is done to it now.
        compat.assign_action(animation, animation.action.copy(), compat.slot_of(animation))
        curve = own_curve(keys)
        assert curve is not None  # it has one now
        if not alike:
            for modifier in list(curve.modifiers):
                curve.modifiers.remove(modifier)
            curve.extrapolation = "CONSTANT"
        pose_curve.replace(curve, *self._keys(at))

    def _keys(self, at: Array) -> tuple[Rows, pose_curve.KeySettings]:
        """A key for each stop, and how it goes on from there: as it did, else on a straight line."""
        frames = np.array([stop.frame for stop in self._stops])
        keys = np.stack([frames, at], axis=1)
        aside = np.array([1.0, 0.0])
        left, right = keys - aside, keys + aside
        handle = pose_curve.number_of("handle_left_type", LINEAR.handles)
        types = np.full((len(frames), 2), handle, np.int32)
        amplitude = np.zeros(len(frames))
        settings = pose_curve.settings_of_new(len(frames), LINEAR)
        for index, stop in enumerate(self._stops):
            for track, part in zip(self._tracks, self._sequences, strict=True):
                there = np.flatnonzero(np.abs(track.frames - stop.frame) < SAME_FRAME)
                if len(there) and "type" in part.key_settings:
                    settings["type"][index] = part.key_settings["type"][there[0]]
                    break
            if stop.like is None or index + 1 == len(frames):
                continue
            number, key = stop.like
            rows, change = self._tracks[number].rows, at[index + 1] - at[index]
            assert rows is not None  # there is a way
            ratio = change / (rows.keys[key + 1, 1] - rows.keys[key, 1])
            for handles, this, of in ((right, index, rows.right[key]), (left, index + 1, rows.left[key + 1])):
                near = rows.keys[key + this - index]
                handles[this] = keys[this] + (of - near) * (1.0, ratio)
            types[index, 1], types[index + 1, 0] = rows.types[key, 1], rows.types[key + 1, 0]
            amplitude[index] = rows.amplitude[key] * abs(ratio)
            for name in ("interpolation", "easing", "back", "period"):
                settings[name][index] = self._sequences[number].key_settings[name][key]
        places, left, right = (pair.astype(np.float32) for pair in (keys, left, right))
        return Rows(places, left, right, types, amplitude.astype(np.float32)), settings
