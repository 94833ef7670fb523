# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a cutout's shape leaves its plane: the depths of its points, which nothing else keeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...model.plane.cutout import diagonal_of
from ...model.plane.frame import Array, Indices, Mask, part_means, spread
from ...model.posing.depths import DEEPEST, DEPTH

# Of the diagonal: what is as near to the plane of its rest as rounding has no depths, and its own plane.
EVEN = 1e-5


@dataclass(frozen=True, eq=False)
class Relief:
    """Of n points; heights are along the normal of the plane."""

    rest: Array  # n, heights at rest
    parts: Indices  # n
    unit: float  # how far a depth of 1 raises a point; negative: against the normal

    def depths(self, heights: Array) -> Array:
        """The depths (n,) of points at n heights."""
        depths: Array = self._above(heights) / self.unit
        return depths

    def is_of_depths(self, heights: Array, size: float) -> bool:
        """Whether points at n heights differ from rest by depths, for all that heights tell of it."""
        above = float(np.abs(self._above(heights)).max())
        return EVEN * size < above <= 1.01 * DEEPEST * abs(self.unit)

    def _above(self, heights: Array) -> Array:
        """How far n heights are above those at rest.

        A part that has been moved farther than depths reach, by hand, lies in another plane now.
        """
        above = heights - self.rest
        means = part_means(above, self.parts)
        away = np.abs(means) > 1.5 * DEEPEST * abs(self.unit)
        result: Array = above - np.where(away, means, 0.0)[self.parts]
        return result


def relief(heights: Array, known: Mask, parts: Indices, *, front: float, diagonal: float) -> Relief:
    """That of points of which these `known` rest at n heights; the others rest where their parts do.

    `front`: 1 where the faces show their fronts on the side of the normal, -1 where they do not. `diagonal`:
    of the rest shape.
    """
    if not known.all():
        counts = np.bincount(parts, weights=known)
        sums = np.bincount(parts, weights=np.where(known, heights, 0.0))
        heights = np.where(known, heights, (sums / np.maximum(counts, 1.0))[parts])
    return Relief(heights, parts, (front or 1.0) * DEPTH * diagonal)


def level(points: Array, rest: Array) -> Array:
    """Points k x 3 of a part without its depths, which would tilt it, where others rest at n x 3 places.

    How far the part as a whole is raised is not known.
    """
    if len(rest) < 3:
        return points
    normal = spread(rest - rest.mean(axis=0))[2]
    heights = (points - points.mean(axis=0)) @ normal
    if np.abs(heights).max() > 2.0 * DEEPEST * DEPTH * diagonal_of(points):
        return points
    result: Array = points - np.outer(heights, normal)
    return result
