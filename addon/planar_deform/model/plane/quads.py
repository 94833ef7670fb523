# SPDX-License-Identifier: GPL-3.0-or-later
"""Quads cut into triangles."""

from __future__ import annotations

import numpy as np

from .frame import Array, Array32, Indices


def cut(quads: Indices, points: Array | Array32) -> Indices:
    """Two triangles (q x 2 x 3) of each of q x 4 quads of k x 3 points.

    As Blender does it, the cut goes from the first corner to the third, unless both others lie to one side of
    it: then it goes between these.
    """
    first, second, third, fourth = (points[corners].astype(np.float64) for corners in quads.T)
    triangles = quads[:, [0, 1, 2, 0, 2, 3]]
    with np.errstate(invalid="ignore", over="ignore"):  # whoever takes the places refuses what is no number
        along = third - first
        sides = (np.cross(second - first, along) * np.cross(fourth - first, along)).sum(axis=1)
    other = sides > 0.0
    triangles[other] = quads[other][:, [0, 1, 3, 1, 2, 3]]
    return triangles.reshape(-1, 2, 3)
