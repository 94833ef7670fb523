# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way back to where they are at rest."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ..plane.cutout import Cutout
from ..plane.frame import Array
from .pins import Holder, Pin
from .posing import RAMP_SAMPLES, Poser, Posing, Sample


class PinReset(Posing):
    """Takes the moving pins straight to where they hold the rest shape, unturned; the others hold.

    The first value of a sample is the share of the way.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        moving: Iterable[int],
        make_poser: Callable[[], Poser],
    ):
        super().__init__(cutout, positions, pins, moving, make_poser)
        self._rest = cutout.rest

    def run(self) -> None:
        """All the way, and until there is nothing left to do."""
        for step in range(1, RAMP_SAMPLES + 1):
            self.move(step / RAMP_SAMPLES, 0.0, 0.0)
        self.settle()

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, turned = start
        share = sample[0]
        return place + share * (holder.place(self._rest) - place), turned * (1.0 - share)
