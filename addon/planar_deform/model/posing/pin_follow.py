# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way to places of their own."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array
from . import solved_shapes
from .pins import Holder, Pin
from .posing import RAMP_SAMPLES, MakePoser, Posing, Sample

STEP = 0.1  # of the size of what is posed, that a pin goes at once, unless the way is too long for that
TURN = 0.5  # radians that a patch turns at once, in the same way
# Refinements after which the rest is done at once. Most frames need no more. Where something buckles it may
# be forty, or half their time by settle(), whose steps cost more and go farther.
FEW = 6


class Goal(NamedTuple):
    """Where a pin is to go."""

    place: Array  # (2,), or (3,) with its depth
    angle: float | None = None  # from rest in radians, if a patch is to be turned
    scale: float | None = None  # from rest, if one is to be scaled


class PinFollow(Posing):
    """Takes pins straight to their goals, by the key of a pin; the others hold.

    The first value of a sample is the share of the way.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        goals: Mapping[int, Goal],
        make_poser: MakePoser,
    ):
        super().__init__(cutout, positions, pins, goals, make_poser)
        self._goals = goals
        self._coarse = cutout.cage is not None
        # Where they are, not where they were asked to be: a bake comes from the frame before.
        self._from = {
            holder.pin.key: holder.place(positions) for holder in self._holders if self._moves(holder)
        }

    def run(self) -> None:
        """All the way, the farther in the more steps, and until there is nothing left to do.

        A dense drawing comes to rest on its coarse mesh alone: itself, each frame would take a second.
        """
        solver = self._make_poser()
        there = (1.0, 0.0, 0.0)
        key = solved_shapes.key_of((self._start, *self._told(), self._targets(there)))
        known = solved_shapes.shape_of(solver, key)
        if known is not None:
            self.positions, self.path = known, [there]
            return
        self._poser = solver
        self._set_handles(solver)
        steps = int(np.clip(math.ceil(self._steps()), 1, RAMP_SAMPLES))
        for step in range(1, steps + 1):
            self.move(step / steps, 0.0, 0.0)
        for _ in range(FEW):
            if self.settled or self.refines_slowly:
                break
            self.move(*there)
        if not (self._coarse or self.settled):
            self.positions = solver.settle()
        while not (self.settled or self.refines_slowly):
            self.move(*there)
        solved_shapes.keep(solver, key, self.positions)

    def _steps(self) -> float:
        """How many steps the longest of the ways takes that pins have to go."""
        size = float(np.linalg.norm(np.ptp(self.positions, axis=0)))
        ways = [float(np.linalg.norm(self._goals[key].place - place)) for key, place in self._from.items()]
        turns = [
            abs(goal.angle - angle)
            for holder, (_, angle) in zip(self._holders, self._starts, strict=True)
            if (goal := self._goals.get(holder.pin.key)) is not None and goal.angle is not None
        ]
        return max(max(ways) / (STEP * size), max(turns, default=0.0) / TURN)

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, goal = self._from[holder.pin.key], self._goals[holder.pin.key]
        turn = 0.0 if goal.angle is None else goal.angle - start[1]
        return place + sample[0] * (goal.place - place), start[1] + sample[0] * turn

    def _grown(self, holder: Holder, begun: float, sample: Sample) -> float:
        goal = self._goals.get(holder.pin.key)
        if goal is None or goal.scale is None:
            return begun
        return begun + sample[0] * (goal.scale - begun)


def nearest_turn(angle: float, to: float) -> float:
    """The same direction by the angle that is at most half a turn from another one."""
    return to + math.remainder(angle - to, math.tau)
