# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells of a lattice's grid. Points are numbered u fastest, then v, then w, as Blender does it."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import numpy as np

from ..plane.frame import Array32, Indices

Counts = tuple[int, int, int]  # points along u, v and w

EQUAL = 1e-5  # of the size: layers that differ by less are equal


def axis_across(counts: Counts, shapes: Iterable[Array32]) -> int | None:
    """The axis with one point, or with two layers that are equal in all N x 3 shapes; None if there is none.

    The other two have at least one cell.
    """
    one, two = (
        [axis for axis in (2, 1, 0) if counts[axis] == layers and sum(count > 1 for count in counts) >= least]
        for layers, least in ((1, 2), (2, 3))
    )
    if one or not two:
        return one[0] if one else None
    for shape in shapes:
        two = [axis for axis in two if _equal_layers(counts, axis, shape)]
        if not two:
            return None
    return two[0]


def layers_across(counts: Counts, axis: int) -> list[Indices]:
    """The numbers of the points of each layer across an axis, in their order."""
    return [np.sort(layer, axis=None) for layer in np.moveaxis(_numbers(counts), axis, 0)]


def cells_across(counts: Counts, axis: int) -> Indices:
    """The corners of each cell of each layer across an axis, m x 4, turned alike."""
    layers = np.moveaxis(_numbers(counts), axis, 0)
    corners = layers[:, :-1, :-1], layers[:, 1:, :-1], layers[:, 1:, 1:], layers[:, :-1, 1:]
    cells: Indices = np.stack([corner.ravel() for corner in corners], axis=1)
    return cells


def halves(cells: Indices) -> Indices:
    """Two triangles for each cell, 2 m x 3."""
    triangles: Indices = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    return triangles


def border(counts: Counts) -> Indices:
    """The edges of the grid's box, e x 2: of a flat lattice its outline, in space the twelve edges."""
    numbers, edges = _numbers(counts), []
    for axis in range(3):
        lines = np.moveaxis(numbers, axis, 0)
        ends = ({0, count - 1} for count in lines.shape[1:])
        for i, j in sorted(itertools.product(*ends)):
            edges.append(np.stack([lines[:-1, i, j], lines[1:, i, j]], axis=1))
    found: Indices = np.concatenate(edges).astype(np.int32)
    return found


def _numbers(counts: Counts) -> Indices:
    """The number of each point, by its place along u, v and w."""
    u, v, w = counts
    numbers: Indices = np.arange(u * v * w, dtype=np.int32).reshape(w, v, u).transpose(2, 1, 0)
    return numbers


def _equal_layers(counts: Counts, axis: int, shape: Array32) -> bool:
    one, other = np.moveaxis(shape[_numbers(counts), :3], axis, 0)
    across = np.arange(3) != axis
    size = float(np.ptp(shape[:, :3], axis=0).max())
    return bool(np.abs(one[..., across] - other[..., across]).max() <= EQUAL * size)
