# SPDX-License-Identifier: GPL-3.0-or-later
"""From the samples of a drag under a running timeline to the way that is solved, frame by frame.

What was shown meanwhile depends on how fast the machine was. So it is not kept: the pins' way is, at each
frame, and is solved again once it is known, which also is what smoothing needs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from ..plane.frame import Array
from ..posing.posing import Sample

# Refinements of each pose that is kept. A frame's move is short, so that few are needed.
REFINEMENTS = 3


class Recording:
    """The samples of a drag by time, counted in frames since its start.

    `frames`: how many there are, from the first to the end of the range; with `loop` the first follows the
    last again, else nothing does. None: there is no end.
    """

    def __init__(self, frames: int | None = None, *, loop: bool = False) -> None:
        self._frames, self._loop = frames, loop
        self._times, self._samples = [0.0], [(0.0, 0.0, 0.0)]

    def add(self, time: float, sample: Sample) -> None:
        """The pins are at this sample from now on; times only grow."""
        self._times.append(time)
        self._samples.append(sample)

    def frame_at(self, time: float) -> int:
        """The frame, from 0, to be shown at a time."""
        if self._frames is None:
            return int(time)
        return int(time) % self._frames if self._loop else min(int(time), self._frames - 1)

    def over(self, time: float) -> bool:
        """Whether the end of the range has been reached, and with it that of the recording."""
        return self._frames is not None and not self._loop and time >= self._frames - 1

    def by_frame(self, time: float) -> list[Sample]:
        """A sample for each frame that was shown until a time, from those there are in proportion to time.

        Of frames that were shown more than once, the last time counts.
        """
        last = self.frame_at(time)
        times = np.arange(last + 1.0)
        if self._loop and self._frames is not None and time >= self._frames:
            times = np.arange(float(self._frames))
            times += self._frames * np.floor((time - times) / self._frames)
        columns = np.array(self._samples).T
        return _rows(np.stack([np.interp(times, self._times, column) for column in columns], axis=1))


class Layer:
    """What was there before: pins that are not dragged go on as they did.

    Called with the number of a sample it gives the shape (n x 2) of its frame, as Posing.played asks for it.
    While it is recorded that is the frame `now`.
    """

    def __init__(self, shape_of: Callable[[int], Array]):
        """`shape_of` reads the shape of a frame, from 0; only when told to, here."""
        self._shape_of = shape_of
        self._shapes: dict[int, Array] = {}
        self._now = 0
        self._frames: list[int] | None = None

    def show(self, frame: int) -> None:
        """This frame is shown now."""
        self._read(frame)
        self._now = frame

    def follow(self, poses: Poses[Any]) -> None:
        """The samples to come are those of these poses."""
        for frame in sorted(set(poses.frames)):
            self._read(frame)
        self._frames = poses.frames

    def __call__(self, number: int) -> Array:
        frames = self._frames
        return self._shapes[self._now if frames is None else frames[min(number, len(frames) - 1)]]

    def _read(self, frame: int) -> None:
        if frame not in self._shapes:
            self._shapes[frame] = self._shape_of(frame)


def smoothed(path: list[Sample], frames: float) -> list[Sample]:
    """The path without what is quicker than some `frames`: a Gaussian of that standard deviation.

    Its ends stay: beyond each the path goes on as it came, turned about the end by half a turn.
    """
    values = np.array(path)
    reach = min(int(np.ceil(3.0 * frames)), len(path) - 1)
    if reach < 1:
        return list(path)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / frames) ** 2)
    before = 2.0 * values[0] - values[reach:0:-1]
    after = 2.0 * values[-1] - values[-2 : -reach - 2 : -1]
    long = np.concatenate([before, values, after])
    columns = [np.convolve(column, kernel / kernel.sum(), mode="valid") for column in long.T]
    return _rows(np.stack(columns, axis=1))


class AlongPath(Protocol):
    """What a posing, or several together, has come to."""

    @property
    def path(self) -> list[Sample]: ...

    @property
    def positions(self) -> Array | list[Array]: ...


SolvedT = TypeVar("SolvedT", bound=AlongPath)


class Poses(Generic[SolvedT]):
    """The poses that are kept of a path with a sample for each frame: the last, and every `frame_step`th."""

    def __init__(self, path: list[Sample], frame_step: int):
        self.samples: list[Sample] = []  # to be solved; those of kept poses are repeated, to refine them
        self.frames: list[int] = []  # of each sample
        self.by_frame: dict[int, Any] = {}  # the positions, filled in by `seen`
        self.last: SolvedT | None = None
        self._ends: dict[int, int] = {}  # a number of samples -> the frame whose pose they lead to
        for frame, sample in enumerate(path):
            self.samples.append(sample)
            if frame % frame_step == 0 or frame == len(path) - 1:
                self.samples += [sample] * REFINEMENTS
                self._ends[len(self.samples)] = frame
            self.frames += [frame] * (len(self.samples) - len(self.frames))

    def seen(self, solved: SolvedT) -> None:
        """All that is solved of the samples goes through here, in order; from whatever thread."""
        frame = self._ends.get(len(solved.path))
        if frame is not None:
            self.by_frame[frame] = solved.positions
            self.last = solved

    @property
    def share(self) -> float:
        """How much of it is solved, from 0 to 1."""
        return len(self.by_frame) / len(self._ends)


def _rows(values: Array) -> list[Sample]:
    """Samples as a posing takes them: rounded to float32."""
    return [(float(du), float(dv), float(angle)) for du, dv, angle in values.astype(np.float32)]
