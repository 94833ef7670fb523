# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of a pose that are turned over, set right by Hold Shape with all around them held."""

from __future__ import annotations

import numpy as np

from ... import native
from ..plane.cutout import signed_areas
from ..plane.frame import Array, Indices, Mask

RINGS = (1, 2, 4, 8)  # of triangles about those that are turned over, which may move
HELD = 1e6  # weight of what is held, a thousand times a pin's: it is put back exactly in the end


def turned_over(positions: Array, triangles: Indices) -> Mask:
    """Which of m triangles are turned over on n x 2 positions, as float32 has them, or have no area."""
    stored = positions.astype(np.float32).astype(np.float64)
    return np.asarray(signed_areas(stored, triangles) <= 0.0)


def set_right(rest: Array, triangles: Indices, positions: Array) -> Array | None:
    """The positions n x 2 with no triangle turned over, changed only about those that were.

    `triangles` m x 3 are counter-clockwise at rest. None where that cannot be done.
    """
    over = turned_over(positions, triangles)
    if not over.any():
        return positions
    free = np.zeros(len(rest), bool)
    free[triangles[over]] = True
    grown = 0
    for rings in RINGS:
        while grown < rings:
            free[triangles[free[triangles].any(axis=1)]] = True
            grown += 1
        found = _solved(rest, triangles, positions, free)
        if found is not None and not turned_over(found, triangles).any():
            return found
    return None


def _solved(rest: Array, triangles: Indices, positions: Array, free: Mask) -> Array | None:
    """The positions with what is free where Hold Shape has it, between what is not."""
    rows, compact = np.unique(triangles[free[triangles].any(axis=1)], return_inverse=True)
    held = np.flatnonzero(~free[rows])
    if not len(held):
        return None
    try:
        poser = native.Poser(rest[rows], compact.reshape(-1, 3), method="hold", pin_weight=HELD)
        poser.set_handles(held)
        poser.move(positions[rows[held]])
        found = poser.settle()
    except native.SolveError:
        return None
    result = positions.copy()
    result[rows[free[rows]]] = found[free[rows]]
    return result
