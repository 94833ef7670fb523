# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a mesh is too coarse to bend: it bends where there are vertices between its two sides."""

from __future__ import annotations

import numpy as np

from .connectivity import counted_edges
from .cutout import signed_areas
from .frame import Array, Indices

# A bar whose ends are bent up: of one row of triangles it is distorted by 0.04 to 0.05 above the 2 of no
# distortion, however many there are along it; of two rows by 0.012, of eight by 0.008.
HINGED = 0.1  # of the area; meshes that artists have made for posing have up to 0.015
FEWEST = 50  # vertices: with two rows, fewer leave bends of 0.03 and more in the angles


def is_coarse(rest: Array, triangles: Indices) -> bool:
    """Whether a mesh with these rest positions n x 2 and triangles m x 3 bends badly for want of vertices."""
    return len(rest) < FEWEST or hinged(rest, triangles) > HINGED


def hinged(rest: Array, triangles: Indices) -> float:
    """The share of the area, 0 to 1, in which a single row of triangles reaches from rim to rim.

    All corners of such a triangle are on the rim: the drawing folds there as at a hinge, and what is
    between two hinges stays stiff.
    """
    found, count = counted_edges(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    rim = np.zeros(len(rest), bool)
    rim[found[count == 1]] = True
    areas = np.abs(signed_areas(rest, triangles))
    total = float(areas.sum())
    return float(areas[rim[triangles].all(axis=1)].sum()) / total if total > 0.0 else 0.0
