# SPDX-License-Identifier: GPL-3.0-or-later
"""What each part of a joined drawing showed before the join, and when.

A join makes shape keys of equal names one, whatever their eval_times, and adds the others; the list of poses
goes with its object, and the curve stays behind with the old shape keys, on a mesh that nothing uses. So each
part still has its shapes, found by the names of the old keys, and its timing. Lists are remembered by the
owner of the mesh (storage/migration.py), as long as Blender runs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import bpy
import numpy as np

from ...model.plane.frame import Array32
from ...model.timing.played_curve import SAME_EVAL_TIME
from ...model.timing.union import Track
from ..storage import points, shape_keys
from . import playback, pose_curve, pose_state
from .playback import Record, whole
from .pose_blocks import FIRST, HOLD, SCRATCH, eval_times, keyed, played_value, share_of, shown_curve

# What of the object's settings belongs to its poses.
SETTINGS = ("curve_before", "anchor_path", "smooth", "depth_between", "active_pose", "key_before")

_NUMBERS = {"BOOLEAN", "INT", "FLOAT", "ENUM"}  # what is set of modifiers of curves
_OF_PANELS = {"active", "show_expanded"}

Poses = Sequence[tuple[float, Record]]  # eval_times, and what the list keeps
Fresh = Mapping[int, bool]  # poses whose in-betweens are up to date, and whether these have been edited
Shapes = Mapping[str, Array32]  # of all shape keys of the joined drawing, by name


@dataclass(frozen=True)
class Known:
    """A sequence as it was last seen."""

    names: tuple[str, ...]  # of all blocks
    poses: Poses
    settings: Record
    fresh: Fresh
    unkeyed_at: float | None = None  # the frame at which an unkeyed pose was shown


@dataclass(frozen=True)
class Came:
    """A drawing that has come by a join."""

    rows: slice  # its vertices
    keys: bpy.types.Key | None  # as it had them
    owner: int

    @property
    def names(self) -> list[str]:
        """Of its shape keys."""
        return [] if self.keys is None else list(self.keys.key_blocks.keys())


_known: dict[int, Known] = {}  # by owner


def remember(obj: bpy.types.Object, owner: int, fresh: Fresh) -> None:
    """Keep what a join takes of the poses of an object, which is the owner of its mesh."""
    _known.pop(owner, None)
    if owner and pose_state.is_ours(obj):
        names = tuple(obj.data.shape_keys.key_blocks.keys())
        _known[owner] = Known(names, listed(obj), settings_of(obj), dict(fresh), _unkeyed_at(obj))


def _unkeyed_at(obj: bpy.types.Object) -> float | None:
    return bpy.context.scene.frame_current_final if pose_state.unkeyed(obj) else None


def listed(obj: bpy.types.Object) -> Poses:
    """The list of poses of an object."""
    return [(pose.at, playback.record_of(pose)) for pose in obj.planar.poses]


def settings_of(obj: bpy.types.Object) -> Record:
    """What else the object keeps of its poses."""
    return {name: getattr(obj.planar, name) for name in SETTINGS}


def forget() -> None:
    """Of another file nothing is known."""
    _known.clear()


class Still:
    """A part that has no poses: it shows one shape all the time."""

    def __init__(self, rows: slice, shape: Array32, rest: Array32, before: Array32):
        self.rows, self.rest, self.before = rows, rest, before  # `before` the sequence is begun
        self._shape = shape

    def shape(self, _eval_time: float) -> Array32:
        """What is shown at any eval_time."""
        return self._shape

    def shown(self) -> Array32:
        """What is shown at present."""
        return self._shape


class Played:
    """A part with a sequence of its own."""

    def __init__(self, rows: slice, keys: bpy.types.Key, names: Sequence[str], known: Known, read: Shapes):
        self.rows, self.keys, self.known = rows, keys, known
        at = dict(zip(keys.key_blocks.keys(), whole(eval_times(keys)).tolist(), strict=True))
        self._blocks = sorted((at[name], name) for name in names if name in read)
        self._at = np.array([at for at, _ in self._blocks])
        self._read = read
        below = [name for at, name in self._blocks if at < FIRST - SAME_EVAL_TIME]
        self.rest, self.before = read[below[0]][rows], read[below[-1]][rows]
        self._eval_time = keys.eval_time
        if known.unkeyed_at == bpy.context.scene.frame_current_final and SCRATCH in self._at:
            self._eval_time = SCRATCH  # a join makes Blender read the curve anew
        self.unkeyed = self._eval_time > HOLD
        curve = shown_curve(keys)
        self.modifiers = [] if curve is None else [_plain(modifier) for modifier in curve.modifiers]
        # What goes on beyond the keys.
        self.endless = curve is not None and (
            curve.extrapolation == "LINEAR"
            or any(modifier.type != "STEPPED" and not modifier.mute for modifier in curve.modifiers)
        )
        self.key_settings = {} if curve is None else pose_curve.key_settings(curve)

    @property
    def names(self) -> list[str]:
        """Of all its blocks."""
        return [name for _, name in self._blocks]

    @property
    def blocks(self) -> list[tuple[float, str]]:
        """Those of the played range."""
        return [(at, name) for at, name in self._blocks if FIRST - SAME_EVAL_TIME < at < HOLD]

    def shape(self, eval_time: float) -> Array32:
        """What is shown at an eval_time."""
        upper = int(np.searchsorted(self._at, eval_time - SAME_EVAL_TIME))
        if upper in (0, len(self._at)) or self._at[upper] - eval_time < SAME_EVAL_TIME:
            return self._block(min(upper, len(self._at) - 1))
        share = share_of(self._at[upper - 1], self._at[upper], eval_time)
        return self._block(upper - 1) * (np.float32(1.0) - share) + self._block(upper) * share

    def shown(self) -> Array32:
        """What is shown at present."""
        return self.shape(self._eval_time)

    def _block(self, index: int) -> Array32:
        return self._read[self._blocks[index][1]][self.rows]

    def track(self, *, modified: bool) -> Track:
        """Its timing. `modified`: as the modifiers of its curve have it."""
        keys, curve = self.keys, shown_curve(self.keys)
        timeline = keyed(keys).astype(np.float64)
        value = played_value if modified or curve is None else pose_curve.value_at
        rows, count = (None, len(timeline)) if curve is None else (pose_curve.rows(curve), 0)
        ways, bezier = np.zeros((count, 0)), np.zeros(count, bool)
        if curve is not None:
            ways, bezier = pose_curve.ways(curve)
        at = np.array([at for at, _ in self.blocks])
        posed = np.array([at for at, _ in self.known.poses])
        return Track(at, posed, rows, ways, bezier, timeline[:, 0], timeline[:, 1], partial(value, keys))


Part = Still | Played


def parts_of(
    obj: bpy.types.Object, owner: int, came: Sequence[Came], rest: Array32 | None
) -> tuple[list[Part], list[str]]:
    """The parts of an object, its own first, and what of them is lost. `owner`: of its own mesh.

    `rest`: count x 3, of the vertices that had no shape keys, and 0 elsewhere.
    """
    keys = obj.data.shape_keys
    read = {block.name: points.read_block(obj, block) for block in keys.key_blocks}
    own = slice(0, came[0].rows.start)
    lost: list[str] = []
    parts: list[Part] = []
    if pose_state.is_ours(obj):
        known = _known.get(owner)
        names = _own_names(keys, known, came)
        unkeyed_at = None if known is None else known.unkeyed_at
        fresh = {} if known is None else known.fresh
        known = Known(tuple(names), listed(obj), settings_of(obj), fresh, unkeyed_at)
        parts.append(Played(own, keys, names, known, read))
    else:
        parts.append(_still(obj, own, keys, read, rest))
    for one in came:
        if one.rows.start > parts[-1].rows.stop:  # of a mesh of which nothing is known
            parts.append(_still(obj, slice(parts[-1].rows.stop, one.rows.start), None, read, rest))
        if one.keys is not None and is_sequence(one):
            known = _known.get(one.owner) or _guessed(one.keys)
            parts.append(Played(one.rows, one.keys, one.names, known, read))
            continue
        parts.append(_still(obj, one.rows, one.keys, read, rest))
        others = [name for name in one.names[1:] if name != shape_keys.POSE_KEY]
        if others:
            lost.append(f"Shape keys that were joined are the shape they showed now: {', '.join(others)}")
    if parts[-1].rows.stop < len(obj.data.vertices):
        parts.append(_still(obj, slice(parts[-1].rows.stop, len(obj.data.vertices)), None, read, rest))
    return parts, lost


def is_sequence(came: Came) -> bool:
    """Whether what has come has a sequence of its own."""
    keys = came.keys
    if keys is None or keys.use_relative:
        return False
    return came.owner in _known or (eval_times(keys).max() >= FIRST and len(keyed(keys)) > 0)


def foreign(keys: bpy.types.Key, came: Sequence[Came]) -> list[str]:
    """Shape keys of an object without a sequence of its own that stand in the way of one."""
    names = {keys.reference_key.name, shape_keys.POSE_KEY, *(name for one in came for name in one.names)}
    return [block.name for block in keys.key_blocks if block.name not in names]


def _own_names(keys: bpy.types.Key, known: Known | None, came: Sequence[Came]) -> list[str]:
    """The blocks that the object itself had."""
    names = keys.key_blocks.keys()
    if known is not None and set(known.names) <= set(names):
        return list(known.names)
    others = {name for one in came for name in one.names}
    return [name for name in names if name not in others or name == keys.reference_key.name]


def _guessed(keys: bpy.types.Key) -> Known:
    """Of a sequence that was never seen: the poses are what keys stand at."""
    values, names = keyed(keys)[:, 1], keys.key_blocks.keys()
    poses = [
        (at, {"name": name})
        for at, name in zip(whole(eval_times(keys)).tolist(), names, strict=True)
        if (np.abs(values - at) < SAME_EVAL_TIME).any()
    ]
    return Known(tuple(names), poses, {}, {})


def _still(
    obj: bpy.types.Object, rows: slice, keys: bpy.types.Key | None, read: Shapes, rest: Array32 | None
) -> Still:
    """A part without poses; `keys`: the shape keys it had, relative ones."""
    # A join gives a part without shape keys its own shape in all of them; the Basis may be its rest by now.
    shape = read[obj.data.shape_keys.key_blocks[-1].name][rows]
    unposed = shape
    if keys is not None:
        unposed = read[keys.reference_key.name][rows]
        added = np.zeros(unposed.shape)
        for key in keys.key_blocks:
            if shape_keys.counts(keys, key):
                offsets = read[key.name].astype(np.float64) - read[key.relative_key.name]
                added += (offsets * (key.value * shape_keys.mask(obj, key)))[rows]
        shape = (unposed + added).astype(np.float32)
    if rest is not None and rest[rows].any():
        unposed = rest[rows]
    return Still(rows, shape, unposed, shape)


def _plain(modifier: bpy.types.FModifier) -> dict[str, object]:
    """All that is set of a modifier of a curve."""
    numbers = [prop.identifier for prop in modifier.bl_rna.properties if prop.type in _NUMBERS]
    found = {name: getattr(modifier, name) for name in numbers if name not in _OF_PANELS}
    if modifier.type == "STEPPED":  # steps begin anywhere
        found["frame_offset"] = modifier.frame_offset % modifier.frame_step
    return {name: tuple(value) if hasattr(value, "__len__") else value for name, value in found.items()}
