# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way to places of their own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array
from .pins import Holder, Pin
from .posing import RAMP_SAMPLES, MakePoser, Posing, Sample

STEP = 0.02  # of the size of what is posed, that a pin goes at once, unless the way is too long for that


class PinFollow(Posing):
    """Takes pins straight to their goals, patches unturned; the others hold.

    `goals`: places by the key of a pin. The first value of a sample is the share of the way.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        goals: Mapping[int, Array],
        make_poser: MakePoser,
    ):
        super().__init__(cutout, positions, pins, goals, make_poser)
        self._goals = goals
        # Where they are, not where they were asked to be: a bake comes from the frame before.
        self._from = {
            holder.pin.key: holder.place(positions) for holder in self._holders if self._moves(holder)
        }

    def run(self) -> None:
        """All the way, the farther in the more steps, and until there is nothing left to do."""
        size = float(np.linalg.norm(np.ptp(self.positions, axis=0)))
        steps = int(np.clip(np.ceil(self._farthest() / (STEP * size)), 1, RAMP_SAMPLES))
        for step in range(1, steps + 1):
            self.move(step / steps, 0.0, 0.0)
        self.settle()

    def _farthest(self) -> float:
        """The longest of the ways that pins have to go."""
        return max(float(np.linalg.norm(self._goals[key] - place)) for key, place in self._from.items())

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place = self._from[holder.pin.key]
        return place + sample[0] * (self._goals[holder.pin.key] - place), start[1]
