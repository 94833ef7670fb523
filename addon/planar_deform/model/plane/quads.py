# SPDX-License-Identifier: GPL-3.0-or-later
"""Quads cut into triangles."""

from __future__ import annotations

import numpy as np

from .frame import Array, Array32, Indices

EQUAL = 1e-6  # of a triangle's worth: where rounding would decide, all quads of a grid are cut alike


def cut(quads: Indices, points: Array | Array32) -> Indices:
    """Two triangles (q x 2 x 3) of each of q x 4 quads of k x 3 points.

    The cut is along the diagonal whose triangles are both turned to the same side, and whose worse one has
    more area for its girth; from the first corner to the third where both are as good.
    """
    a, b, c, d = (points[corners].astype(np.float64) for corners in quads.T)
    first = _worth((a, b, c), (a, c, d))
    second = _worth((a, b, d), (b, c, d))
    other = second > first * (1.0 + EQUAL)
    triangles = quads[:, [0, 1, 2, 0, 2, 3]]
    triangles[other] = quads[other][:, [0, 1, 3, 1, 2, 3]]
    return triangles.reshape(-1, 2, 3)


def _worth(one: tuple[Array, Array, Array], other: tuple[Array, Array, Array]) -> Array:
    """Of pairs of triangles, by their corners q x 3."""
    areas = [np.cross(b - a, c - a) for a, b, c in (one, other)]
    shares = [
        np.linalg.norm(area, axis=1)
        / np.maximum(
            sum(np.linalg.norm(end - start, axis=1) for start, end in ((a, b), (b, c), (c, a))), 1e-300
        )
        for area, (a, b, c) in zip(areas, (one, other), strict=True)
    ]
    alike = np.einsum("ij,ij->i", *areas) > 0.0
    return np.where(alike, np.minimum(*shares), 0.0)
