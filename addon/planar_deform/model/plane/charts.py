# SPDX-License-Identifier: GPL-3.0-or-later
"""What the corners and the faces of a flat mesh have, carried to the faces of another one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .carrying import Carrying, carrying
from .cutout import connected_parts
from .frame import Array, Indices

SAME = 1e-6  # values of corners that are one


def charts_of(triangles: Indices, kinds: Indices, values: list[Array]) -> Indices:
    """The chart of each of m triangles, from 0: what hangs together by edges across which values go on.

    `triangles` m x 3 are vertices; those on both sides of an edge have one kind (m,) and at its ends the same
    values, each m x 3 x d.
    """
    numbers = np.arange(len(triangles))
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides = np.concatenate(
        [
            np.tile((0, 1), (len(triangles), 1)),
            np.tile((1, 2), (len(triangles), 1)),
            np.tile((2, 0), (len(triangles), 1)),
        ]
    )
    owners = np.tile(numbers, 3)
    turned = ends[:, 0] > ends[:, 1]
    ends[turned], sides[turned] = ends[turned][:, ::-1], sides[turned][:, ::-1]
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    first, second = order[:-1], order[1:]
    joined = (ends[first] == ends[second]).all(axis=1) & (kinds[owners[first]] == kinds[owners[second]])
    first, second = first[joined], second[joined]
    goes_on = np.ones(len(first), bool)
    for value in values:
        for end in (0, 1):
            one = value[owners[first], sides[first, end]]
            other = value[owners[second], sides[second, end]]
            goes_on &= np.abs(one - other).max(axis=1) <= SAME
    pairs = np.stack([owners[first], owners[second]], axis=1)[goes_on]
    return connected_parts(len(triangles), pairs.astype(np.int32))


def corner_carrying(
    rest: Array,
    triangles: Indices,
    corners: Indices,
    charts: Indices,
    places: Array,
    faces: Indices,
    middles: Indices,
) -> Carrying:
    """How the corners of new faces, f x 3 of k x 2 places, hang in the corners (m x 3) of old triangles.

    All corners of a face hang in one chart, that of the old triangle which its middle is in (`middles`, f).
    """
    held = np.empty((len(faces) * 3, 3), np.int32)
    weights = np.empty((len(faces) * 3, 3))
    found = np.empty(len(faces) * 3, np.int32)
    for chart, chosen in _groups(charts[middles]):
        own = np.flatnonzero(charts == chart)
        used, inverse = np.unique(faces[chosen], return_inverse=True)
        here = carrying(rest, triangles[own], places[used])
        rows = (chosen[:, None] * 3 + np.arange(3)).ravel()
        inverse = inverse.ravel()
        found[rows] = own[here.triangles[inverse]]
        held[rows], weights[rows] = corners[found[rows]], here.weights[inverse]
    return Carrying(held, weights, found)


def _groups(numbers: Indices) -> Iterator[tuple[int, Indices]]:
    """Each number that there is, and where."""
    order = np.argsort(numbers, kind="stable")
    found, first = np.unique(numbers[order], return_index=True)
    yield from zip(found.tolist(), np.split(order, first[1:]), strict=True)
