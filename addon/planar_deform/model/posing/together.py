# SPDX-License-Identifier: GPL-3.0-or-later
"""Posings of several drawings, moved as one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.frame import Array, PlaneFrame
from ..work import Progress
from .posing import Posing, Sample, Solved

ROUNDING = 1e-7  # of unit axes: below, two planes have the same


@dataclass(frozen=True)
class Plane:
    """How the plane of a drawing sees what is told in another one."""

    axes: Array  # 2 x 2: u and v of the other one along this one's u and v
    side: float  # of a turn: -1 where the normals are opposite, 0 where the planes are across each other

    @staticmethod
    def of(frame: PlaneFrame, told_in: PlaneFrame) -> Plane | None:
        """That of a frame, where samples are told in another one; None where the two have the same axes."""
        axes = frame.flatten(np.stack([told_in.u, told_in.v])).T
        side = round(float(frame.n @ told_in.n))
        same = side == 1 and np.abs(axes - np.eye(2)).max() < ROUNDING
        return None if same else Plane(np.ascontiguousarray(axes), float(side))


@dataclass(frozen=True)
class SolvedTogether:
    """What posings have come to."""

    each: list[Solved]
    path: list[Sample]  # that was asked for, in the plane of the first

    @property
    def positions(self) -> list[Array]:
        """Of each, n x 2."""
        return [solved.positions for solved in self.each]


@dataclass(frozen=True)
class Part:
    """One of the posings."""

    posing: Posing
    plane: Plane | None = None  # how its plane sees samples; None: as the first one does, to the bit
    name: str | None = None  # of what it poses, for errors; None: it is the only one


class Together:
    """Moves posings by the same samples, which are told in the plane of the first: it stands for all.

    A sample once more refines those that have not settled. Each posing keeps the path that it has gone: when
    it goes that again it gives equal bits.
    """

    def __init__(self, parts: Sequence[Part]):
        self._parts = list(parts)
        self.path: list[Sample] = []

    @property
    def posings(self) -> list[Posing]:
        """Each of them."""
        return [part.posing for part in self._parts]

    @property
    def pivot(self) -> Array:
        """What is turned about, in the plane of the first."""
        return self.posings[0].pivot

    @property
    def progress(self) -> Progress | None:
        """See Posing."""
        return self.posings[0].progress

    @progress.setter
    def progress(self, progress: Progress | None) -> None:
        for posing in self.posings:
            posing.progress = progress

    @property
    def settled(self) -> bool:
        """See Posing; of all."""
        return all(posing.settled for posing in self.posings)

    @property
    def refines_slowly(self) -> bool:
        """Whether there is nothing left to do but on dense drawings themselves."""
        left = [posing for posing in self.posings if not posing.settled]
        return all(posing.refines_slowly for posing in left or self.posings)

    def restart(self) -> None:
        """Back to the start, as if nothing had been moved yet."""
        self.path = []
        for posing in self.posings:
            posing.restart()

    def move(self, du: float, dv: float, angle: float) -> None:
        """Take all pins to a total offset and turn since the start, see Posing.move()."""
        sample = (float(np.float32(du)), float(np.float32(dv)), float(np.float32(angle)))
        rests = self.path[-1:] == [sample]
        for part in self._parts:
            posing, plane = part.posing, part.plane
            if rests and posing.settled and posing.path and posing.played is None:
                continue
            seen = sample if plane is None else posing.seen_in(sample, plane.axes, plane.side)
            with _telling(part.name):
                posing.move(*seen)
        self.path.append(sample)

    def again(self, path: Sequence[Sample], ways: Sequence[Sequence[Sample]]) -> Iterator[None]:
        """Let each posing go its own way (its path) once more, step by step, that came of this path."""
        for part, way in zip(self._parts, ways, strict=True):
            for sample in way:
                with _telling(part.name):
                    part.posing.move(*sample)
                yield
        self.path = list(path)

    def solved(self) -> SolvedTogether:
        """What there is now, which later moves do not change."""
        return SolvedTogether([posing.solved() for posing in self.posings], list(self.path))


@contextmanager
def _telling(name: str | None) -> Iterator[None]:
    """What a solver says tells whose it is."""
    try:
        yield
    except native.SolveError as error:
        if name is None:
            raise
        raise native.SolveError(f"'{name}': {error}") from error
