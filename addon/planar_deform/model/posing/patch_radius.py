# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches by how far they reach about their pin, on n x 2 positions and within the pin's own part."""

from __future__ import annotations

import numpy as np

from ..plane.frame import Array, Indices
from .pins import Holder

FEWEST = 2  # vertices that have a direction, by which a patch is turned


def vertices_within(holder: Holder, positions: Array, radius: float) -> Indices:
    """The vertices that are at most `radius` from a pin; empty where they are too few for a patch."""
    found = np.flatnonzero(_distances(holder, positions) <= radius).astype(np.int32)
    return found if len(found) >= FEWEST else found[:0]


def least_radius(holder: Holder, positions: Array) -> float:
    """The smallest radius that makes a patch."""
    return float(np.sort(_distances(holder, positions))[FEWEST - 1])


def _distances(holder: Holder, positions: Array) -> Array:
    """Of the vertices from the pin (n,); infinite in other parts."""
    distances = np.linalg.norm(positions - holder.place(positions), axis=1)
    return np.where(holder.cutout.parts == holder.part, distances, np.inf)
