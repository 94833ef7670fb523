# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way from a common centre, or towards it; in all directions, or along one axis."""

from __future__ import annotations

import numpy as np

from ..plane.frame import Array
from .pins import LEAST_SCALE, Holder
from .posing import Posing, Sample, ramp, thinned


class Spreading(Posing):
    """Takes the moving pins straight away from the pivot, patches unturned; the others hold.

    A patch that moves alone is scaled where it is, unless along an axis.

    A sample is what is added to the unit matrix that takes the pins' arms from the pivot to what they become:
    uu, vv and uv of a symmetric one, see growth().
    """

    scales_patches = False  # all that move, with the ways between them

    @staticmethod
    def seen_in(sample: Sample, axes: Array, side: float) -> Sample:
        uu, vv, uv = sample
        if uu == vv and not uv:
            return sample  # in all directions alike
        (a, c), (b, d) = (axes @ np.array([[uu, uv], [uv, vv]]) @ axes.T).tolist()
        return a, d, 0.5 * (b + c)

    def _grown(self, holder: Holder, begun: float, sample: Sample) -> float:
        uu, vv, uv = sample
        alone = self.movers + self.companions == 1
        if not self._moves(holder) or not (alone or self.scales_patches) or uu != vv or uv:
            return begun
        return max(begun * (1.0 + uu), LEAST_SCALE)

    def _aim(self, holder: Holder, start: tuple[Array, float], sample: Sample) -> tuple[Array, float]:
        if not self._moves(holder):
            return start
        place, turned = start
        uu, vv, uv = sample
        aim = place.copy()
        aim[:2] += np.array([[uu, uv], [uv, vv]]) @ (place - self.pivot)[:2]
        return aim, turned


class ScalingSpread(Spreading):
    """Scales patches as it spreads them."""

    scales_patches = True


def growth(share: float, axis: tuple[float, float] | None = None) -> Sample:
    """The sample by which distances grow by a share: all of them, or those along an axis of the plane."""
    if axis is None:
        return share, share, 0.0
    u, v = axis
    return share * u * u, share * v * v, share * u * v


def carried_growth(path: list[Sample], share: float, axis: tuple[float, float] | None = None) -> list[Sample]:
    """The path whose end has been edited to a growth(), at the same shares of the way.

    The same path when it ends there already, to what float32 tells of a factor of 1 and the share. Otherwise
    as carried_path() of offsets and turns.
    """
    whole = path[-1][0] + path[-1][1] if path else 0.0
    grown = whole if axis is not None else 0.5 * whole
    as_told = np.float32(1.0 + grown) == np.float32(1.0 + share)
    if path and as_told and np.allclose(path[-1], growth(grown, axis), atol=1e-6):
        return list(path)
    shares = [(uu + vv) / whole for uu, vv, _ in thinned(path)[:-1]] + [1.0] if whole else ramp()
    uu, vv, uv = growth(share, axis)
    return [(uu * part, vv * part, uv * part) for part in shares]
