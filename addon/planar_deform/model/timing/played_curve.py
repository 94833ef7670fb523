# SPDX-License-Identifier: GPL-3.0-or-later
"""The curve that plays a pose sequence: which poses it visits when, and its values before and after filling.

A value of the curve is the eval_time of a shape: poses are SPACING apart without generated shapes, which come
in between. What the keys' values and handles were before is remembered as offsets from the eval_time of the
pose at or below the key, so that taking the generated shapes out restores them to the bit.
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
    """The keys of a curve as it stores them, float32."""

    keys: Array32  # k x 2: frame, value
    left: Array32  # k x 2, the handles
    right: Array32


@dataclass(frozen=True)
class Offsets:
    """The keys of a curve relative to the poses, without generated shapes in between."""

    pose: Indices  # k: the pose at or below the key
    values: Array  # k x 3: of the key and its two handles, from the eval_time of that pose
    sides: Array32  # k x 2 float32: the frames of the handles
    exact: Mask  # k x 3 bool: which are to the bit what they were


def offsets(rows: Rows, shown: Array, plain: Array, remembered: str) -> Offsets:
    """Where keys are, of poses that are shown at eval_times `shown` and would be at `plain`.

    `remembered` is what remember() told when the eval_times were made what they are; values that have not
    changed since are what they were then.
    """
    values = np.stack([rows.keys[:, 1], rows.left[:, 1], rows.right[:, 1]], axis=1).astype(np.float64)
    pose = np.maximum(np.searchsorted(shown, values[:, 0] + SAME_EVAL_TIME, side="right") - 1, 0).astype(
        np.int32
    )
    result = moved(values, shown, plain) - plain[pose, None]
    sides = np.stack([rows.left[:, 0], rows.right[:, 0]], axis=1)
    exact = np.zeros(values.shape, bool)
    known = _unpacked(remembered)
    for index, parts in enumerate(_parts(rows)):
        for column, part in enumerate(parts):
            if known.get(part):
                offset, side = known[part].pop(0)
                result[index, column], exact[index, column] = offset, True
                if column:
                    sides[index, column - 1] = side
    return Offsets(pose, result, sides, exact)


def remember(rows: Rows, before: Offsets) -> str:
    """What offsets() needs to know of keys that have become `rows`."""
    table = np.concatenate([rows.keys, rows.left, rows.right, before.sides], axis=1, dtype=np.float32)
    packed = table.tobytes() + before.values.astype(np.float64).tobytes()
    return base64.b85encode(zlib.compress(packed)).decode()


def _unpacked(remembered: str) -> dict[bytes, list[tuple[float, float]]]:
    known: dict[bytes, list[tuple[float, float]]] = {}
    if not remembered:
        return known
    packed = zlib.decompress(base64.b85decode(remembered))
    count = len(packed) // (8 * 4 + 3 * 8)
    table = np.frombuffer(packed, np.float32, count * 8).reshape(-1, 8)
    values = np.frombuffer(packed, np.float64, count * 3, offset=count * 32).reshape(-1, 3)
    rows = Rows(table[:, :2], table[:, 2:4], table[:, 4:6])
    for parts, sides, offset in zip(_parts(rows), table[:, 6:].tolist(), values.tolist(), strict=True):
        for part, was in zip(parts, zip(offset, (0.0, *sides), strict=True), strict=True):
            known.setdefault(part, []).append(was)
    return known


def _parts(rows: Rows) -> list[tuple[bytes, bytes, bytes]]:
    """The bits of each key, and of each handle together with its key."""
    return [
        (b"k" + key.tobytes(), b"l" + key.tobytes() + left.tobytes(), b"r" + key.tobytes() + right.tobytes())
        for key, left, right in zip(rows.keys, rows.left, rows.right, strict=True)
    ]
