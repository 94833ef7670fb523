# SPDX-License-Identifier: GPL-3.0-or-later
"""The curve that plays a pose sequence: which poses it visits when, and its values before and after filling.

A value of the curve is the eval_time of a shape: poses are SPACING apart without generated shapes, which come
in between. What the keys' values and handles were before is remembered as offsets from the eval_time of the
pose at or below the key, so that taking the generated shapes out restores them to the bit. What is not
remembered keeps its progress, see progress.py.
"""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..plane.frame import Array, Array32, Indices, Mask

SAME_FRAME = 0.01  # of two keys of a curve, as in Blender
SAME_EVAL_TIME = 0.05  # of two blocks, which are at least twice as far apart


@dataclass(frozen=True)
class Visit:
    """A time over which the curve stays at one pose."""

    pose: int
    first: float
    last: float


def visits(timeline: Array32, eval_times: Sequence[float]) -> list[Visit]:
    """The poses at `eval_times` (ascending) that keys (k x 2: frame, value, in order of time) stand at.

    Keys of other values are retiming, and no visits.
    """
    found: list[Visit] = []
    at = np.searchsorted(eval_times, timeline[:, 1] - SAME_EVAL_TIME)
    for (frame, value), pose in zip(timeline.tolist(), at.tolist(), strict=True):
        if pose == len(eval_times) or eval_times[pose] > value + SAME_EVAL_TIME:
            continue
        if found and found[-1].pose == pose:
            found[-1] = Visit(pose, found[-1].first, frame)
        else:
            found.append(Visit(pose, frame, frame))
    return found


def whole_frames(first: float, last: float) -> int:
    """How many whole frames are strictly between two frames."""
    return max(0, math.ceil(last - SAME_FRAME) - math.floor(first + SAME_FRAME) - 1)


def moved(values: Array, old: Array, new: Array) -> Array:
    """Values carried from `old` eval_times (ascending) to `new`, in proportion; outside by the ends'."""
    outside = np.minimum(values - old[0], 0.0) + np.maximum(values - old[-1], 0.0)
    result: Array = np.interp(values, old, new) + outside
    return result


@dataclass(frozen=True)
class Rows:
    """The keys of a curve as it stores them."""

    keys: Array32  # k x 2: frame, value
    left: Array32  # k x 2, the handles
    right: Array32
    types: Indices  # k x 2, of the handles, as Blender numbers them
    amplitude: Array32  # k, of what swings behind the key

    @property
    def values(self) -> Array:
        """Of the key and its two handles, k x 3."""
        values = np.stack([self.keys[:, 1], self.left[:, 1], self.right[:, 1]], axis=1)
        return np.asarray(values, np.float64)

    def at(self, values: Array, types: Indices, amplitude: Array32) -> Rows:
        """The same frames with these values (k x 3)."""
        parts = zip((self.keys, self.left, self.right), values.T, strict=True)
        keys, left, right = (np.stack([old[:, 0], new], axis=1).astype(np.float32) for old, new in parts)
        return Rows(keys, left, right, types, amplitude)


@dataclass(frozen=True)
class Offsets:
    """The keys of a curve relative to the poses, without generated shapes in between."""

    pose: Indices  # k: the pose at or below the key
    values: Array  # k x 3: of the key and its two handles, from the eval_time of that pose
    sides: Array32  # k x 2 float32: the frames of the handles
    types: Indices  # k x 2
    amplitude: Array32  # k
    exact: Mask  # k x 3 bool: which are to the bit what they were, with what belongs to them

    def restored(self, rows: Rows, values: Array) -> Rows:
        """The keys as they are in `rows`, but what is exact as it was, with these values (k x 3)."""
        chosen = np.where(self.exact, values, rows.values)
        amplitude = np.where(self.exact[:, 0], self.amplitude, rows.amplitude)
        result = rows.at(chosen, self.types, amplitude)
        result.left[:, 0], result.right[:, 0] = self.sides.T
        return result


def offsets(rows: Rows, shown: Array, plain: Array, remembered: str) -> Offsets:
    """Where keys are, of poses that are shown at eval_times `shown` and would be at `plain`.

    `remembered` is what remember() told when the eval_times were made what they are; values that have not
    changed since are what they were then.
    """
    values = rows.values
    pose = pose_below(values[:, 0], shown)
    result = moved(values, shown, plain) - plain[pose, None]
    sides = np.stack([rows.left[:, 0], rows.right[:, 0]], axis=1)
    types, amplitude = rows.types.copy(), rows.amplitude.copy()
    exact = np.zeros(values.shape, bool)
    known = _unpacked(remembered)
    for index, parts in enumerate(_parts(rows)):
        for column, part in enumerate(parts):
            if not known.get(part):
                continue
            was = known[part].pop(0)
            result[index, column], exact[index, column] = was.offset, True
            if column:
                sides[index, column - 1], types[index, column - 1] = was.side, was.type
            else:
                amplitude[index] = was.amplitude
    return Offsets(pose, result, sides, types, amplitude, exact)


def pose_below(values: Array, eval_times: Array) -> Indices:
    """The pose at or below each value, of poses at `eval_times` (ascending); the first one below them all."""
    above = np.searchsorted(eval_times, values + SAME_EVAL_TIME, side="right")
    return np.maximum(above - 1, 0).astype(np.int32)


@dataclass(frozen=True)
class _Was:
    offset: float
    side: float
    type: int
    amplitude: float


_HEAD = ":"  # before what remember() tells; files of before there were types have none, and are not read
_ROW = np.dtype(
    [
        *(("now", np.float32, 7), ("now_types", np.int8, 2)),
        *(("sides", np.float32, 2), ("types", np.int8, 2), ("amplitude", np.float32)),
        *(("values", np.float64, 3), ("exact", bool, 3)),
    ]
)


def remember(rows: Rows, before: Offsets) -> str:
    """What offsets() needs to know of keys that have become `rows`: what of `before` is exact."""
    table = np.empty(len(rows.keys), _ROW)
    table["now"] = np.column_stack([rows.keys, rows.left, rows.right, rows.amplitude])
    table["now_types"] = rows.types
    for field in ("sides", "types", "amplitude", "values", "exact"):
        table[field] = getattr(before, field)
    return _HEAD + base64.b85encode(zlib.compress(table.tobytes())).decode()


def _unpacked(remembered: str) -> dict[bytes, list[_Was]]:
    known: dict[bytes, list[_Was]] = {}
    if not remembered.startswith(_HEAD):
        return known
    table = np.frombuffer(zlib.decompress(base64.b85decode(remembered[len(_HEAD) :])), _ROW)
    now = table["now"]
    rows = Rows(now[:, :2], now[:, 2:4], now[:, 4:6], table["now_types"].astype(np.int32), now[:, 6])
    for parts, row in zip(_parts(rows), table, strict=True):
        sides, types = (0.0, *row["sides"].tolist()), (0, *row["types"].tolist())
        for column, part in enumerate(parts):
            if row["exact"][column]:
                was = _Was(
                    float(row["values"][column]), sides[column], types[column], float(row["amplitude"])
                )
                known.setdefault(part, []).append(was)
    return known


def _parts(rows: Rows) -> list[tuple[bytes, bytes, bytes]]:
    """The bits of each key, and of each handle together with its key."""
    types = rows.types.astype(np.int8)
    return [
        (
            b"k" + key.tobytes() + amplitude.tobytes(),
            b"l" + key.tobytes() + left.tobytes() + kinds[0].tobytes(),
            b"r" + key.tobytes() + right.tobytes() + kinds[1].tobytes(),
        )
        for key, left, right, kinds, amplitude in zip(
            rows.keys, rows.left, rows.right, types, rows.amplitude, strict=True
        )
    ]
