# SPDX-License-Identifier: GPL-3.0-or-later
"""One action of posing: pins move from where they are, the solver follows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .. import native
from .cutout import Cutout
from .frame import Array
from .pins import Holder, Pin, rotation

# One sample of a drag: offset along u and v in world lengths and turn in radians, each since the start.
Sample = tuple[float, float, float]

# A move with no recorded path runs straight to its end in this many samples: enough that each turns and
# stretches the drawing little, which is what a step of a Killing field assumes.
RAMP_SAMPLES = 24

FINISHING_STEPS = 4
THERE = 1e-4  # of the diagonal


@dataclass(frozen=True)
class PinResult:
    """Where an action left one pin."""

    key: int
    part: int  # of the cutout
    target: Array  # (2,) where it was asked to be
    reached: Array  # (2,) where it is
    angle: float


class PoseAction:
    """Moves the pins whose keys are in `moving` by samples since the start; the other enabled pins hold.

    `positions` (n x 2) is the shape to start from and `poser` a solver standing there. Equal samples in equal
    order give equal bits.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        moving: Iterable[int],
        poser: native.Poser,
        pivot: Array | None = None,
    ):
        self._cutout = cutout
        self._poser = poser
        self._positions = positions
        self._holders = [Holder(pin, cutout) for pin in pins if pin.enabled]
        self._moving = frozenset(moving)
        self._starts = [_start(holder, positions) for holder in self._holders]
        movers = [
            place
            for holder, (place, _) in zip(self._holders, self._starts, strict=True)
            if self._moves(holder)
        ]
        if not movers:
            raise ValueError("moving: none of these pins is enabled and has vertices")
        self.pivot: Array = np.mean(movers, axis=0) if pivot is None else np.asarray(pivot, dtype=np.float64)
        self.path: list[Sample] = []
        self._targets: Array | None = None
        self._set_handles()

    @property
    def report(self) -> native.Report:
        """The solver's report on the last move."""
        return self._poser.report

    @property
    def positions(self) -> Array:
        """The n x 2 positions after the last move."""
        return self._positions

    def move(self, du: float, dv: float, angle: float) -> Array:
        """Take the pins to a total offset and turn since the start (rounded to float32); n x 2 positions."""
        sample = (float(np.float32(du)), float(np.float32(dv)), float(np.float32(angle)))
        targets = [
            holder.handle_targets(*self._aim(holder, start, sample))
            for holder, start in zip(self._holders, self._starts, strict=True)
        ]
        self._targets = np.concatenate(targets)
        self._positions = self._poser.move(self._targets)
        self.path.append(sample)
        return self._positions

    def finish(self) -> Array:
        """A few more steps to the last sample, as at the release of a drag, unless all pins are there; n x 2.

        The solver's own settle() goes on until nothing gets nearer, which takes half a second where pins pull
        hard, too long for a release.
        """
        for _ in range(FINISHING_STEPS):
            if self._targets is None or self.report.furthest_handle <= THERE * self._cutout.diagonal:
                break
            self._positions = self._poser.move(self._targets)
        return self._positions

    def results(self) -> list[PinResult]:
        """Where each enabled pin was asked to be and where it is, now."""
        sample = self.path[-1] if self.path else (0.0, 0.0, 0.0)
        results = []
        for holder, start in zip(self._holders, self._starts, strict=True):
            target, angle = self._aim(holder, start, sample)
            reached = holder.place(self._positions)
            results.append(PinResult(holder.pin.key, holder.part, target, reached, angle))
        return results

    def _moves(self, holder: Holder) -> bool:
        return holder.pin.key in self._moving

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, turned = start
        du, dv, angle = sample
        return self.pivot + rotation(angle) @ (place - self.pivot) + np.array([du, dv]), turned + angle

    def _set_handles(self) -> None:
        parts = [holder.handle_vertices() for holder in self._holders]
        counts = [len(triangles) for triangles, _ in parts]
        self._poser.set_handles(
            (np.concatenate([triangles for triangles, _ in parts]), np.concatenate([w for _, w in parts])),
            weights=np.repeat([holder.pin.weight for holder in self._holders], counts),
            groups=np.repeat(np.arange(len(parts)), counts),
        )


def _start(holder: Holder, positions: Array) -> tuple[Array, float]:
    """Where a pin is held at the start of an action: its target, if it has one, else where it is."""
    if holder.pin.target is not None:
        return holder.pin.target, holder.pin.angle
    return holder.place(positions), holder.fitted_angle(positions)


def carried_path(
    path: list[Sample], *, offset: tuple[float, float] | None = None, angle: float | None = None
) -> list[Sample]:
    """The path whose end has been edited to `offset` or `angle`; the same path when it ends there already.

    An edited offset turns and scales the whole path about its start (the similarity that takes the recorded
    end to the edited one), an edited angle scales its turns. A path that is empty or ends where it started,
    in what is edited, has no direction to carry along: the result runs straight to the edited end.
    """
    du, dv, turn = path[-1] if path else (0.0, 0.0, 0.0)
    if offset is not None:
        edited = complex(float(np.float32(offset[0])), float(np.float32(offset[1])))
        recorded = complex(du, dv)
        if path and edited == recorded:
            return list(path)
        if recorded == 0.0:
            return [(edited.real * t, edited.imag * t, turn * t) for t in _ramp()]
        ratio = edited / recorded
        carried = [(complex(u, v) * ratio, a) for u, v, a in path[:-1]] + [(edited, turn)]
        return [(z.real, z.imag, a) for z, a in carried]
    if angle is not None:
        wanted = float(np.float32(angle))
        if path and wanted == turn:
            return list(path)
        if turn == 0.0:
            return [(du * t, dv * t, wanted * t) for t in _ramp()]
        return [(u, v, a * (wanted / turn)) for u, v, a in path[:-1]] + [(du, dv, wanted)]
    return list(path)


def _ramp() -> list[float]:
    return [step / RAMP_SAMPLES for step in range(1, RAMP_SAMPLES + 1)]
