# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way back to where they are at rest."""

from __future__ import annotations

from collections.abc import Iterable

from ..plane.cutout import Cutout
from ..plane.frame import Array
from .pins import Holder, Pin
from .posing import RAMP_SAMPLES, MakePoser, Posing, Sample


class PinReset(Posing):
    """Takes the moving pins straight to where they hold the rest shape, unturned; the others hold.

    The first value of a sample is the share of the way. In space, where no angle tells how a patch is turned,
    its vertices go straight.
    """

    def __init__(
        self,
        cutout: Cutout,
        positions: Array,
        pins: Iterable[Pin],
        moving: Iterable[int],
        make_poser: MakePoser,
    ):
        used = list(pins)
        super().__init__(cutout, positions, used, moving, make_poser)
        self._rest = cutout.rest
        self._resting = {pin.key: Holder(pin, cutout) for pin in used}

    def run(self) -> None:
        """All the way, and until there is nothing left to do."""
        for step in range(1, RAMP_SAMPLES + 1):
            self.move(step / RAMP_SAMPLES, 0.0, 0.0)
        self.settle()

    def _handle_targets(
        self, holder: Holder, target: Array, angle: float, scale: float, sample: Sample
    ) -> Array:
        targets = super()._handle_targets(holder, target, angle, scale, sample)
        if holder.cutout.flat or not self._moves(holder):
            return targets
        resting = self._resting[holder.pin.key].handle_targets(target, 0.0)
        return targets + sample[0] * (resting - targets)

    def _grown(self, holder: Holder, begun: float, sample: Sample) -> float:
        return begun + sample[0] * (1.0 - begun) if self._moves(holder) else begun

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, turned = start
        share = sample[0]
        return place + share * (holder.place(self._rest) - place), turned * (1.0 - share)
