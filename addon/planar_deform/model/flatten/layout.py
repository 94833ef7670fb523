# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat patches in their places: beside each other, onto each other, in the square of a UV map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..plane.frame import Array, Indices

Complex = NDArray[np.complex128]

GAP = 0.05  # between patches, of the larger side of the largest one
ROW = 2.0  # how long rows may be, in sides of a square with the area of all patches


@dataclass(frozen=True)
class Unit:
    """How a flat shape lies in a UV map: `scale * place + offset`."""

    scale: float
    offset: tuple[float, float]

    def of(self, places: Array) -> Array:
        """k x 2 places in the map."""
        placed: Array = self.scale * places + np.array(self.offset)
        return placed


def fitted_unit(places: Array) -> Unit:
    """The one that puts k x 2 places into the middle of the square from 0 to 1, as large as they fit."""
    low, high = places.min(axis=0), places.max(axis=0)
    size = float((high - low).max())
    scale = 1.0 / size if size > 0.0 else 1.0
    offset = 0.5 - scale * 0.5 * (low + high)
    return Unit(scale, (float(offset[0]), float(offset[1])))


def side_by_side(flat: Array, patch: Indices) -> Array:
    """n x 2 places with the patches (n,) in rows from the left upper corner; the middle of all is 0."""
    boxes = [
        (flat[patch == number].min(axis=0), flat[patch == number].max(axis=0))
        for number in range(patch.max() + 1)
    ]
    sizes = np.array([high - low for low, high in boxes])
    gap = GAP * float(sizes.max())
    longest = max(float(sizes[:, 0].max()), ROW * float(np.sqrt((sizes + gap).prod(axis=1).sum())))
    placed = flat.copy()
    x = y = height = 0.0
    for number, (low, _) in enumerate(boxes):
        width, tall = sizes[number]
        if x > 0.0 and x + width > longest:
            x, y, height = 0.0, y - height - gap, 0.0
        placed[patch == number] += np.array([x, y - tall]) - low
        x, height = x + width + gap, max(height, float(tall))
    result: Array = placed - 0.5 * (placed.min(axis=0) + placed.max(axis=0))
    return result


@dataclass(frozen=True)
class Motion:
    """A rigid motion of the plane."""

    turn: complex  # of size 1
    centre: complex  # what is turned about,
    goal: complex  # and where that goes

    def of(self, places: Array) -> Array:
        """k x 2 places, moved."""
        return _pairs(self.goal + self.turn * (_complex(places) - self.centre))

    def back(self, places: Array) -> Array:
        """k x 2 places, moved the other way."""
        return _pairs(self.centre + self.turn.conjugate() * (_complex(places) - self.goal))


def nearest_motion(places: Array, goals: Array) -> Motion:
    """The one that takes k x 2 places, at least one, nearest to goals."""
    start, end = _complex(places), _complex(goals)
    centre, goal = complex(start.mean()), complex(end.mean())
    product = complex(np.vdot(start - centre, end - goal))
    return Motion(product / abs(product) if abs(product) > 0.0 else 1.0 + 0.0j, centre, goal)


def size_ratio(places: Array, goals: Array) -> float | None:
    """How much larger k x 2 places lie than goals; None where one of them is a point."""
    spreads = [float(((points - points.mean(axis=0)) ** 2).sum()) for points in (places, goals)]
    return None if min(spreads) <= 0.0 else float(np.sqrt(spreads[0] / spreads[1]))


def _complex(places: Array) -> Complex:
    return np.asarray(places[:, 0] + 1j * places[:, 1])


def _pairs(places: Complex) -> Array:
    return np.stack([places.real, places.imag], axis=1)
