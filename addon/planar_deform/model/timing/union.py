# SPDX-License-Identifier: GPL-3.0-or-later
"""The timing of several pose sequences made one: what each of them shows at which frame, by one curve.

One curve stops at every frame at which one of them has a pose. Between two stops it goes as they went where
those that move went the same way; otherwise what they showed at each frame comes in between, on a straight
line, as generated shapes do.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..plane.frame import Array, Indices
from .played_curve import SAME_EVAL_TIME, SAME_FRAME, Rows, whole_frames

SAME_WAY = 1e-3  # of the way from key to key, and of an eval_time


@dataclass(frozen=True)
class Track:
    """The timing of one sequence."""

    at: Array  # the eval_times of all shapes that can be played, ascending
    poses: Array  # those of its poses
    rows: Rows | None  # the keys of its curve; None where it has none of its own
    ways: Array  # k x anything: what tells the way behind each key, beside its handles
    bezier: Indices  # k: whether the handles tell it
    frames: Array  # of the keys, as they are played
    values: Array
    value: Callable[[float], float]  # what is played at a frame


@dataclass
class Stop:
    """A frame at which one of the sequences has a pose."""

    frame: float
    values: list[float]  # the eval_time that each sequence shows
    held: bool = False  # that is what was shown at the stop before, and all the time since
    passed: list[list[float]] | None = None  # what comes in between, up to the next stop
    like: tuple[int, int] | None = None  # the way there is that behind this key of this track


def union(tracks: Sequence[Track], also: Iterable[float] = ()) -> list[Stop]:
    """The stops of all tracks, in time; `also`: at these frames as well."""
    stops = [Stop(frame, [track.value(frame) for track in tracks]) for frame in _frames(tracks, also)]
    for before, after in itertools.pairwise(stops):
        count = whole_frames(before.frame, after.frame)
        within = np.linspace(before.frame, after.frame, count + 2)
        shown = np.array([[track.value(frame) for track in tracks] for frame in within.tolist()])
        moving = np.flatnonzero(np.ptp(shown, axis=0) >= SAME_EVAL_TIME).tolist()
        after.held = not moving
        ways = {index: _way(tracks[index], before.frame, after.frame, shown[:, index]) for index in moving}
        found = [way for way in ways.values() if way is not None]
        if moving and len(found) == len(moving) and all(way.is_like(found[0]) for way in found):
            before.like = moving[0], found[0].key
            before.passed = [
                [
                    way.passed[number] if (way := ways.get(index)) is not None else before.values[index]
                    for index in range(len(tracks))
                ]
                for number in range(len(found[0].passed))
            ]
        elif not all(_is_straight(tracks[index], shown[:, index]) for index in moving):
            before.passed = shown[1:-1].tolist()
    return stops


def is_same(first: Track, second: Track) -> bool:
    """Whether two tracks show equal eval_times at all frames, by equal keys and of equal blocks."""
    if first.rows is None or second.rows is None:
        return False
    pairs = [(getattr(first, name), getattr(second, name)) for name in ("at", "ways", "bezier", "frames")]
    pairs += [(first.rows.values, second.rows.values), (first.rows.left, second.rows.left)]
    pairs += [(first.rows.right, second.rows.right), (first.poses, second.poses)]
    return all(a.shape == b.shape and np.allclose(a, b, rtol=0.0, atol=SAME_WAY) for a, b in pairs)


@dataclass(frozen=True)
class _Way:
    """From one key to the next, from shape to shape."""

    key: int
    passed: list[float]  # eval_times of the shapes in between
    shape: Array

    def is_like(self, other: _Way) -> bool:
        same = len(self.passed) == len(other.passed) and self.shape.shape == other.shape.shape
        return same and np.allclose(self.shape, other.shape, rtol=0.0, atol=SAME_WAY)


def _frames(tracks: Sequence[Track], also: Iterable[float]) -> list[float]:
    found: list[float] = []
    posed = (track.frames[_near(track.values, track.poses)].tolist() for track in tracks)
    for frame in sorted(itertools.chain(also, *posed)):
        if not found or frame - found[-1] > SAME_FRAME:
            found.append(frame)
    return found


def _near(values: Array, at: Array) -> Array:
    return np.asarray((np.abs(values[:, None] - at[None, :]) < SAME_EVAL_TIME).any(axis=1))


def _way(track: Track, first: float, last: float, shown: Array) -> _Way | None:
    """From the key at one frame to that at another, if it is the next one and shapes evenly lie between.

    `shown`: on the way. What goes beyond the two keys depends on what is next door, and has no way.
    """
    keys = np.flatnonzero(np.abs(track.frames - first) < SAME_FRAME)
    if track.rows is None or not len(keys) or keys[-1] + 1 == len(track.frames):
        return None
    key = int(keys[-1])
    ends = track.values[key : key + 2]
    if abs(track.frames[key + 1] - last) >= SAME_FRAME or not _near(ends, track.at).all():
        return None
    low, high = sorted(ends.tolist())
    if shown.min() < low - SAME_EVAL_TIME or shown.max() > high + SAME_EVAL_TIME:
        return None
    inner = track.at[(track.at > low + SAME_EVAL_TIME) & (track.at < high - SAME_EVAL_TIME)]
    steps = np.diff(np.concatenate([[low], inner, [high]]))
    if np.ptp(steps) > SAME_EVAL_TIME:
        return None
    shape = track.ways[key]
    change = float(ends[1] - ends[0])
    if track.bezier[key]:
        handles = np.stack([track.rows.right[key], track.rows.left[key + 1]]).astype(np.float64)
        start, scale = np.array([track.frames[key], ends[0]]), np.array([last - first, change])
        shape = np.concatenate([shape, ((handles - start) / scale).ravel()])
    else:
        shape = np.append(shape, track.rows.amplitude[key] / abs(change))
    return _Way(key, (inner if change > 0.0 else inner[::-1]).tolist(), shape)


def _is_straight(track: Track, shown: Array) -> bool:
    """Whether a straight line from the first to the last of these shapes goes through all of them."""
    low, high = shown.min(), shown.max()
    if ((track.at > low + SAME_EVAL_TIME) & (track.at < high - SAME_EVAL_TIME)).any():
        return False
    line = np.linspace(shown[0], shown[-1], len(shown))
    return bool(np.abs(shown - line).max() < SAME_WAY * max(1.0, high - low))
