# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a lattice is that fits round points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..plane.frame import Array

MOST_AN_AXIS = 64  # points; Blender's own limit
MOST = 32000  # points in all; beyond it Blender takes some away
# Of the largest extent: what is flatter gets a lattice as thick as that, so that its points lie apart.
THINNEST = 1e-2


def fitted_box(low: Array, high: Array, counts: Sequence[int], free: int) -> tuple[Array, Array]:
    """The centre (3,) and size (3,) of a lattice round a box, along the lattice's axes.

    The size is that from the first point of an axis to the last. `free`: so many whole cells on each side are
    outside of the box; for B-splines and Catmull-Rom it takes one, or the border's points count double in it.
    Raises ValueError where the counts leave no cell for the box, or are more than Blender has.
    """
    if max(counts) > MOST_AN_AXIS or np.prod(np.array(counts, np.int64)) > MOST:
        raise ValueError(
            f"That is {' x '.join(map(str, counts))} points: a lattice has {MOST_AN_AXIS} at most in an "
            f"axis, and {MOST} in all"
        )
    if max(counts) == 1:
        raise ValueError("A lattice of one point bends nothing: raise the Resolution")
    extent = high - low
    extent = np.maximum(extent, THINNEST * extent.max())
    size = np.ones(3)
    for axis, count in enumerate(counts):
        if count == 1:
            continue
        inside = count - 1 - 2 * free
        if inside < 1:
            raise ValueError(
                f"{count} points leave no cell for the objects between {free} free ones on each side: raise "
                "the Resolution, or lower Free Cells"
            )
        size[axis] = extent[axis] * (count - 1) / inside
    return 0.5 * (low + high), size
