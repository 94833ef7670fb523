# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way from a common centre, or towards it."""

from __future__ import annotations

from ..plane.frame import Array
from .pins import Holder
from .posing import Posing, Sample


class Spreading(Posing):
    """Takes the moving pins straight away from the pivot, patches unturned; the others hold.

    The first value of a sample is the share by which their distances from it have grown: -1 is in the pivot.
    """

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, turned = start
        aim = place.copy()
        aim[:2] += sample[0] * (place - self.pivot)[:2]
        return aim, turned
