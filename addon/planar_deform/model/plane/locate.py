# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding the point of a mesh that lies at, or nearest to, a place in its plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .frame import Array, Indices, Mask

# A point this far outside a triangle (in barycentric weight) still counts as inside: rounding on shared
# edges.
INSIDE = -1e-9


@dataclass(frozen=True)
class MeshPoint:
    """A point of the mesh: a triangle and three weights that sum to 1."""

    triangle: int
    weights: Array  # 3
    distance: float = 0.0  # from the place asked for; 0 inside


def at(positions: Array, triangles: Indices, point: MeshPoint) -> Array:
    """Where a mesh point is (2,) on n x 2 positions."""
    place: Array = point.weights @ positions[triangles[point.triangle]]
    return place


def nearest_point(positions: Array, triangles: Indices, place: Array, among: Indices) -> MeshPoint | None:
    """The mesh point at `place` (2,), or nearest to it, in the triangles listed in `among`.

    Of several triangles that hold the place, the one it lies deepest in (by barycentric weight) is taken, so
    that a rounding error on an edge never decides. Triangles of zero area are only reached through their
    edges.
    """
    if not len(among):
        return None
    around = among[_around(positions, triangles[among], place)]
    if len(around):
        weights = barycentric(positions[triangles[around]], place)
        depth = weights.min(axis=1)
        best = int(np.argmax(depth))
        if depth[best] >= INSIDE:
            inside = np.clip(weights[best], 0.0, 1.0)
            return MeshPoint(int(around[best]), inside / inside.sum())
    corners = positions[triangles[among]]
    starts, ends = corners, corners[:, [1, 2, 0]]
    sides = ends - starts
    lengths = np.einsum("ijk,ijk->ij", sides, sides)
    reach = np.einsum("ijk,ijk->ij", place - starts, sides)
    share = np.clip(np.divide(reach, lengths, out=np.zeros_like(reach), where=lengths > 0.0), 0.0, 1.0)
    gaps = starts + share[:, :, None] * sides - place
    row, side = np.unravel_index(int(np.argmin(np.einsum("ijk,ijk->ij", gaps, gaps))), share.shape)
    result = np.zeros(3)
    result[side], result[(side + 1) % 3] = 1.0 - share[row, side], share[row, side]
    return MeshPoint(int(among[row]), result, float(np.linalg.norm(gaps[row, side])))


def _around(positions: Array, triangles: Indices, place: Array) -> Mask:
    """Which triangles (mask m) have the place within their bounding boxes; all that it is inside of do."""
    found = np.ones(len(triangles), bool)
    for column, value in zip(positions.T, place, strict=True):
        rounding = -INSIDE * float(np.ptp(column))
        for beside in (column <= value + rounding, column >= value - rounding):
            first, second, third = (beside[corner] for corner in triangles.T)
            found &= first | second | third
    return found


def barycentric(corners: Array, place: Array) -> Array:
    """Barycentric weights k x 3 in k x 3 x 2 triangles of a place (2,), or of one for each (k x 2).

    They are -inf where there is no area.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac, ap = b - a, c - a, place - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    flat = area == 0.0
    area = np.where(flat, 1.0, area)
    second = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / area
    third = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / area
    weights: Array = np.stack([1.0 - second - third, second, third], axis=1)
    weights[flat] = -np.inf
    return weights
