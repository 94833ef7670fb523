# SPDX-License-Identifier: GPL-3.0-or-later
"""One posing: pins move from where they are, the solver follows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from ..work import Progress
from .pins import Holder, Pin, turned

# One sample of a drag: offset along u and v in world lengths and turn in radians, each since the start.
Sample = tuple[float, float, float]

# A way that nobody recorded, straight or carried along, is taken in this many samples: enough that each turns
# and stretches the drawing little, which is what a step of a Killing field assumes.
RAMP_SAMPLES = 12

# Refinements in a row that settling takes at most. A pose converges in far fewer, or never.
MOST_REFINEMENTS = 100
# Of those the ones on a dense drawing itself, where each takes longer than a move. Poses take 2 to 15, but
# for some in which it lies folded over.
MOST_SLOW = 20


class Poser(Protocol):
    """What a posing asks of a solver, as native.Poser has it."""

    @property
    def report(self) -> native.Report | native.LatticeReport: ...

    def set_handles(self, handles: tuple[Indices, Array], /, *, weights: Array, groups: Indices) -> None: ...

    def move(self, targets: Array, /) -> Array: ...

    def refine(self, *, progress: Progress | None = None) -> Array: ...

    def settle(self, *, progress: Progress | None = None) -> Array: ...


class MakePoser(Protocol):
    """Gives a solver that stands where a posing starts. `progress` is asked where making it takes long."""

    def __call__(self, *, progress: Progress | None = None) -> Poser: ...


@dataclass(frozen=True)
class PinResult:
    """Where a posing left one pin."""

    key: int
    part: int  # of the cutout
    target: Array  # (2,) where it was asked to be
    reached: Array  # (2,) where it is
    angle: float
    scale: float  # what a patch was asked to grow by
    reached_scale: float  # and has


@dataclass(frozen=True)
class Solved:
    """What a posing has come to."""

    positions: Array  # n x 2
    results: list[PinResult]
    report: native.Report | native.LatticeReport  # of the solver, on the last sample
    path: list[Sample]  # that led here


class Posing:
    """Moves the pins whose keys are in `moving` by samples since the start; the other enabled pins hold.

    `positions` is the shape to start from: n x 2, or n x 3 with depths, which the pins keep. `make_poser`
    gives a solver standing there; it is called at the first move, which may be in another thread. Equal
    samples in equal order give equal bits.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        moving: Iterable[int],
        make_poser: MakePoser,
        pivot: Array | None = None,
    ):
        self._start = positions
        self._make_poser = make_poser
        self._holders = [Holder(pin, cutout) for pin in pins if pin.enabled]
        if not cutout.flat:
            self._holders = [holder.as_shown(positions) for holder in self._holders]
        if not self._holders:
            raise ValueError("pins: none is enabled")
        self._moving = frozenset(moving)
        self._starts = self._begun = [start_of(holder, positions) for holder in self._holders]
        self._scales = self._scales_begun = [start_scale_of(holder, positions) for holder in self._holders]
        # Asked while something takes longer than a move, a refinement or making the solver; where it answers
        # False that raises native.Cancelled, and the posing is as it was before.
        self.progress: Progress | None = None
        # Gives the shape (n x 2) in whose places the pins are that do not move, at the sample of a number;
        # None: they stay. Asked wherever it is solved, which may be in another thread.
        self.played: Callable[[int], Array | None] | None = None
        # By the key of a pin that goes along with a moving one, seen in a mirror across u: that one's.
        self.mirrored: Mapping[int, int] = {}
        self.companions = 0  # how many pins of other drawings move with these, see together.py
        if pivot is None:
            movers = [
                place
                for holder, (place, _) in zip(self._holders, self._starts, strict=True)
                if self._moves(holder)
            ]
            pivot = np.mean(movers, axis=0) if movers else np.zeros(positions.shape[1])
        self.pivot: Array = np.asarray(pivot, dtype=np.float64)
        self.restart()

    @staticmethod
    def seen_in(sample: Sample, axes: Array, side: float) -> Sample:
        """A sample told in another plane, in this one; see together.Plane."""
        du, dv, angle = sample
        (a, b), (c, d) = axes.tolist()
        return a * du + b * dv, c * du + d * dv, side * angle

    @property
    def movers(self) -> int:
        """How many pins are moved by themselves."""
        return sum(self._moves(holder) for holder in self._holders)

    def restart(self) -> None:
        """Back to the start, as if nothing had been moved yet."""
        self._poser: Poser | None = None
        self.positions = self._start  # n x 2, after the last move
        self.path: list[Sample] = []
        self._refinements = self._slow_ones = 0
        self._starts, self._scales = self._begun, self._scales_begun
        self._playing: Array | None = None

    @property
    def settled(self) -> bool:
        """Whether refining would change nothing worth seeing, or has been tried for long enough."""
        return (
            self._poser is None
            or self._poser.report.converged
            or self._refinements >= MOST_REFINEMENTS
            or self._slow_ones >= MOST_SLOW
        )

    @property
    def refines_slowly(self) -> bool:
        """Whether there is nothing left to do but on a dense drawing itself."""
        return (
            self._poser is not None
            and isinstance(report := self._poser.report, native.Report)
            and report.coarse_settled
        )

    def move(self, du: float, dv: float, angle: float) -> Array:
        """Take the pins to a total offset and turn since the start (rounded to float32); n x 2 positions.

        The sample before once more: the drawing comes closer to the shape that belongs to it, by one bounded
        refinement. So a path tells not only where the pins went but also how long they rested.
        """
        sample = (float(np.float32(du)), float(np.float32(dv)), float(np.float32(angle)))
        if self._poser is None:
            self._poser = self._make_poser(progress=self.progress)
            self._set_handles(self._poser)
        if not self._play() and self.path and self.path[-1] == sample:
            slow = self.refines_slowly
            self.positions = self._poser.refine(progress=self.progress)
            self._refinements += 1
            self._slow_ones += slow
        else:
            self.positions = self._poser.move(self._targets(sample))
            self._refinements = self._slow_ones = 0
        self.path.append(sample)
        return self.positions

    def _play(self) -> bool:
        """Let the pins that do not move be where they play by now; whether that is elsewhere."""
        shape = None if self.played is None else self.played(len(self.path))
        if shape is None or shape is self._playing:
            return False
        self._playing = shape
        self._starts = [
            start if self._moves(holder) else (holder.place(shape), holder.fitted_angle(shape))
            for holder, start in zip(self._holders, self._begun, strict=True)
        ]
        self._scales = [
            scale if self._moves(holder) else holder.held_scale(shape)
            for holder, scale in zip(self._holders, self._scales_begun, strict=True)
        ]
        return True

    def settle(self) -> Array:
        """Refine until there is nothing left to do; n x 2 positions."""
        while not self.settled:
            self.move(*self.path[-1])
        return self.positions

    def solved(self) -> Solved:
        """What there is now, which later moves do not change."""
        if self._poser is None:
            raise ValueError("nothing has been moved yet")
        return Solved(self.positions, self.results(), self._poser.report, list(self.path))

    def results(self) -> list[PinResult]:
        """Where each enabled pin was asked to be and where it is, now."""
        sample = self.path[-1] if self.path else (0.0, 0.0, 0.0)
        results = []
        for index, holder in enumerate(self._holders):
            results.append(result_of(holder, self.positions, *self._aim_of(index, sample)))
        return results

    def _moves(self, holder: Holder) -> bool:
        return holder.pin.key in self._moving

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, begun = start
        du, dv, angle = sample
        aim: Array = self.pivot + turned(place - self.pivot, angle)
        aim[:2] += du, dv
        return aim, begun + angle

    def _grown(self, _holder: Holder, begun: float, _sample: Sample) -> float:
        """What a patch has to have grown by since rest; `begun` at the start."""
        return begun

    def _targets(self, sample: Sample) -> Array:
        targets = [
            self._handle_targets(holder, *self._aim_of(index, sample), sample)
            for index, holder in enumerate(self._holders)
        ]
        return np.concatenate(targets)

    def _aim_of(self, index: int, sample: Sample) -> tuple[Array, float, float]:
        """Where a pin is to be, how far turned and scaled from rest: by itself, or as the one it mirrors."""
        holder, start, scale = self._holders[index], self._starts[index], self._scales[index]
        led_by = self.mirrored.get(holder.pin.key)
        if led_by is None:
            return *self._aim(holder, start, sample), self._grown(holder, scale, sample)
        leader = next(i for i, other in enumerate(self._holders) if other.pin.key == led_by)
        (place, angle), before = self._starts[leader], self._scales[leader]
        aim, turned_to, grown = self._aim_of(leader, sample)
        way = aim - place
        way[0] *= -1.0
        return start[0] + way, start[1] - (turned_to - angle), scale * grown / before

    def _handle_targets(
        self, holder: Holder, target: Array, angle: float, scale: float, _sample: Sample
    ) -> Array:
        """Where the handles of a pin should be that is to be at a target, turned and scaled from rest."""
        return holder.handle_targets(target, angle, scale)

    def _set_handles(self, poser: Poser) -> None:
        triangles, corners, weights, groups = self._told()
        poser.set_handles((triangles, corners), weights=weights, groups=groups)

    def _told(self) -> tuple[Indices, Array, Array, Indices]:
        """Triangles and barycentric weights of all handles, how strong they are, and of which pin."""
        parts = [holder.handle_vertices() for holder in self._holders]
        counts = [len(triangles) for triangles, _ in parts]
        return (
            np.concatenate([triangles for triangles, _ in parts]),
            np.concatenate([corners for _, corners in parts]),
            np.repeat([holder.pin.weight for holder in self._holders], counts),
            np.repeat(np.arange(len(parts)), counts).astype(np.int32),
        )


def start_of(holder: Holder, positions: Array) -> tuple[Array, float]:
    """Where a pin is held at the start of a posing: its target, if it has one, else where it is."""
    if holder.pin.target is not None:
        return holder.pin.target, holder.pin.angle
    return holder.place(positions), holder.fitted_angle(positions)


def start_scale_of(holder: Holder, positions: Array) -> float:
    """What a patch is held at likewise."""
    return holder.pin.scale if holder.pin.target is not None else holder.held_scale(positions)


def result_of(holder: Holder, positions: Array, target: Array, angle: float, scale: float) -> PinResult:
    """That of a pin on n x 2 positions, of which these were asked."""
    place, reached_scale = holder.place(positions), holder.fitted_scale(positions)
    return PinResult(holder.pin.key, holder.part, target, place, angle, scale, reached_scale)


def carried_path(
    path: list[Sample], *, offset: tuple[float, float] | None = None, angle: float | None = None
) -> list[Sample]:
    """The path whose end has been edited to `offset` or `angle`; the same path when it ends there already.

    An edited offset turns and scales the whole path about its start (the similarity that takes the recorded
    end to the edited one), an edited angle scales its turns. A path that is empty or ends where it started,
    in what is edited, has no direction to carry along: the result runs straight to the edited end. An edited
    path cannot give the bits that were recorded, so it keeps only as many samples as a straight one, and no
    rests.
    """
    du, dv, turn = path[-1] if path else (0.0, 0.0, 0.0)
    if offset is not None:
        edited = complex(float(np.float32(offset[0])), float(np.float32(offset[1])))
        recorded = complex(du, dv)
        if path and edited == recorded:
            return list(path)
        if recorded == 0.0:
            return [(edited.real * t, edited.imag * t, turn * t) for t in ramp()]
        ratio = edited / recorded
        carried = [(complex(u, v) * ratio, a) for u, v, a in thinned(path)[:-1]] + [(edited, turn)]
        return [(z.real, z.imag, a) for z, a in carried]
    if angle is not None:
        wanted = float(np.float32(angle))
        if path and wanted == turn:
            return list(path)
        if turn == 0.0:
            return [(du * t, dv * t, wanted * t) for t in ramp()]
        return [(u, v, a * (wanted / turn)) for u, v, a in thinned(path)[:-1]] + [(du, dv, wanted)]
    return list(path)


def thinned(path: list[Sample]) -> list[Sample]:
    """At most RAMP_SAMPLES of the path, the last one among them, none equal to the one before."""
    moves = [sample for sample, before in zip(path, [None, *path], strict=False) if sample != before]
    last, steps = len(moves) - 1, min(len(moves), RAMP_SAMPLES)
    return [moves[last - (steps - 1 - step) * last // max(1, steps - 1)] for step in range(steps)]


def ramp() -> list[float]:
    """Shares of a straight way."""
    return [step / RAMP_SAMPLES for step in range(1, RAMP_SAMPLES + 1)]
