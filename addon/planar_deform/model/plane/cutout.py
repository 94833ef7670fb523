# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat mesh as the solver sees it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .frame import Array, Indices
from .locate import MeshPoint


@dataclass(frozen=True)
class Cutout:
    """Rest positions and triangles of the vertices that belong to a face.

    Of what is posed by a lattice there is a third column, the depth across the plane.
    """

    rest: Array  # n x 2 or n x 3, world lengths
    triangles: Indices  # m x 3, counter-clockwise in rest
    parts: Indices  # n, the connected part of each vertex, counted from 0
    diagonal: float  # of the rest shape's bounding box
    stiffness: Array | None = None  # m factors, None: all 1
    cage: int | None = None  # about how many vertices a coarse mesh has that is solved in its place
    flat: bool = True  # nothing is turned out of the plane, so that turns count from rest
    # Points of it that have been looked for, by what they are the middle of, see posing/pins.py.
    found: dict[bytes, MeshPoint] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def first_corners(self) -> Indices:
        """Of each vertex, its first corner among all of the triangles, of which every vertex has one."""
        corners = np.zeros(len(self.rest), np.int32)
        flat = self.triangles.ravel()
        corners[flat[::-1]] = np.arange(flat.size - 1, -1, -1, dtype=np.int32)
        return corners


# A fully painted triangle resists this many times as much as a neutral one, an erased one as many times less.
STIFFEST = 100.0
NEUTRAL = 0.5  # the painted weight that changes nothing


def make_cutout(
    rest: Array,
    triangles: Indices,
    parts: Indices,
    painted: Array | None = None,
    cage: int | None = None,
) -> Cutout:
    """A cutout of n x 2 rest positions; clockwise triangles are turned (for the solve only).

    `painted` (n,) are the vertices' weights of stiffness, 0 to 1, None where nothing is painted.
    """
    stiffness = None if painted is None else stiffness_of(painted, triangles)
    return Cutout(rest, oriented(rest, triangles), parts, diagonal_of(rest), stiffness, cage)


def stiffness_of(painted: Array, triangles: Indices) -> Array:
    """The factor (m,) of each triangle's stiffness, 1/STIFFEST to STIFFEST, from weights (n,) from 0 to 1.

    A triangle takes the mean of its corners, and the factor grows by equal ratios for equal steps of weight:
    what the brush adds is felt the same everywhere.
    """
    mean = painted[triangles].mean(axis=1)
    factors: Array = STIFFEST ** ((mean - NEUTRAL) / NEUTRAL)
    return factors


def diagonal_of(points: Array) -> float:
    """Length of the diagonal of the bounding box of k x d points; 0 for none."""
    return float(np.linalg.norm(np.ptp(np.ascontiguousarray(points.T), axis=1))) if len(points) else 0.0


def signed_areas(points: Array, triangles: Indices) -> Array:
    """Signed area (m,) of each triangle on n x 2 points, positive when counter-clockwise."""
    x, y = np.ascontiguousarray(points.T)
    i, j, k = np.ascontiguousarray(triangles.T)
    areas: Array = 0.5 * ((x[j] - x[i]) * (y[k] - y[i]) - (y[j] - y[i]) * (x[k] - x[i]))
    return areas


def oriented(rest: Array, triangles: Indices) -> Indices:
    """The triangles with two corners swapped where they are clockwise in rest."""
    result = triangles.copy()
    clockwise = signed_areas(rest, triangles) < 0.0
    result[clockwise] = result[clockwise][:, [0, 2, 1]]
    return result


def connected_parts(count: int, cells: Indices) -> Indices:
    """The connected part of each of `count` vertices, counted from 0 in order of their first vertex.

    `cells` are edges k x 2 or triangles k x 3.

    Each round hooks the larger root of every edge between two trees below the smaller one and flattens the
    trees, which takes O(log n) rounds of whole-array operations in practice.
    """
    root = np.arange(count, dtype=np.int32)
    starts, ends = cells[:, :-1].T.ravel(), cells[:, 1:].T.ravel()
    while True:
        one, other = root[starts], root[ends]
        between = np.flatnonzero(one != other)
        if not len(between):
            break
        one, other, starts, ends = one[between], other[between], starts[between], ends[between]
        np.minimum.at(root, np.maximum(one, other), np.minimum(one, other))
        while not np.array_equal(root[root], root):
            root = root[root]
    parts: Indices = (np.cumsum(root == np.arange(count), dtype=np.int32) - 1)[root]
    return parts
