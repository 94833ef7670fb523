# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies in front where a drawing lies on itself: depths of pins, spread over their parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array
from . import solver_cache
from .pins import Holder

# Of the diagonal, how far a depth of 1 raises the drawing out of its plane. Cycles, Workbench and EEVEE
# (dithered) draw that clean, and nobody sees it from the side.
DEPTH = 5e-4
DEEPEST = 10.0  # the largest depth, to either side
HELD = 1e-6  # of a pin's weight: corners with less do not hold it


def depth_of(holder: Holder, depths: Array) -> float:
    """The depth of a pin where the points have n depths."""
    return float(holder.place(depths[:, None])[0])


def spread(
    key: int, cutout: Cutout, holders: Sequence[Holder], asked: Mapping[int, float], depths: Array
) -> Array:
    """The depths (n,) in which pins have those that are asked for (by key), and the other ones stay.

    `key`: of the object, for which the factored system is kept as long as its pins hold the same vertices.

    Between pins they change as gently as they can (harmonically), and nowhere beyond the pins' own. Pins that
    are off hold nothing; parts without pins stay as they are in `depths` (n,). Raises native.SolveError.
    """
    count = len(depths)
    sums, counts = np.zeros(count), np.zeros(count)
    for holder in holders:
        if holder.pin.enabled:
            triangles, weights = holder.handle_vertices()
            rows = np.unique(cutout.triangles[triangles][weights > HELD])
            sums[rows] += asked.get(holder.pin.key, depth_of(holder, depths))
            counts[rows] += 1.0
    held = np.flatnonzero(counts).astype(np.int32)
    if not len(held):
        return depths
    rest, triangles = cutout.rest, cutout.triangles
    harmonic = solver_cache.kept(
        ("depths", key), (triangles, rest, held), lambda: native.Harmonic(rest, triangles, held)
    )
    values = harmonic.spread(sums[held] / counts[held])
    among = np.isin(cutout.parts, cutout.parts[held])
    return np.where(among, values, depths)
