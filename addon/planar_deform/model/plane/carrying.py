# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever the vertices of a flat mesh have, carried to other points of its plane.

A point takes the barycentric mean of the triangle it lies in; outside of the mesh, what the nearest triangle
has there as an affine map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cutout import signed_areas
from .frame import Array, Indices, Mask
from .locate import INSIDE, barycentric

CHUNK = 1 << 20  # pairs of a point and an edge that are looked at together
LEAST_AREA = 1e-12  # of the squared size of the mesh: a triangle of less is a line


@dataclass(frozen=True)
class Carrying:
    """How k points hang in a mesh: triangles, and weights that sum to 1."""

    corners: Indices  # k x 3, vertices of the mesh
    weights: Array  # k x 3; outside of the triangle some are below 0
    triangles: Indices  # k

    def of(self, values: Array) -> Array:
        """What n x d values of the vertices are at the points (k x d): outside of the mesh as they go on."""
        result: Array = np.einsum("kc,kcd->kd", self.weights, values[self.corners])
        return result

    @property
    def within(self) -> Array:
        """Weights (k x 3) of points of the triangles: the same, or beside these."""
        clipped = np.clip(self.weights, 0.0, None)
        result: Array = clipped / clipped.sum(axis=1, keepdims=True)
        return result


def carrying(rest: Array, triangles: Indices, places: Array) -> Carrying:
    """How k x 2 places hang in a mesh at rest, n x 2 with triangles m x 3, some of which have an area.

    Of several triangles that hold a place, the one it lies deepest in (by barycentric weight) is taken.
    """
    size = float(np.ptp(rest, axis=0).max())
    areas = np.abs(signed_areas(rest, triangles))
    numbers = np.flatnonzero(areas > LEAST_AREA * size * size)
    if not len(numbers):
        numbers = np.array([int(np.argmax(areas))])
    solid = triangles[numbers]
    found, weights = _holding(rest, solid, places)
    outside = np.flatnonzero(weights.min(axis=1) < INSIDE)
    if len(outside):
        edges, owners = boundary(solid)
        nearest = owners[_nearest_edges(rest, edges, places[outside])]
        found[outside] = nearest
        weights[outside] = barycentric(rest[solid[nearest]], places[outside])
    return Carrying(solid[found], weights, numbers[found].astype(np.int32))


def boundary(triangles: Indices) -> tuple[Indices, Indices]:
    """The edges (k x 2) that one triangle alone has, as it goes round them, and their triangles (k,)."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    low, high = edges.min(axis=1).astype(np.int64), edges.max(axis=1).astype(np.int64)
    _, inverse, counts = np.unique(
        low * (int(high.max()) + 1) + high, return_inverse=True, return_counts=True
    )
    alone = np.flatnonzero(counts[inverse.ravel()] == 1)
    return edges[alone], (alone % len(triangles)).astype(np.int32)


def _holding(rest: Array, triangles: Indices, places: Array) -> tuple[Indices, Array]:
    """The triangle that each place lies deepest in, and its weights: not above INSIDE where none holds it."""
    found = np.zeros(len(places), np.int32)
    weights = np.full((len(places), 3), -np.inf)
    points, candidates = _candidates(rest, triangles, places)
    if len(points):
        tried = barycentric(rest[triangles[candidates]], places[points])
        order = np.lexsort((-tried.min(axis=1), points))
        best = order[np.unique(points[order], return_index=True)[1]]
        found[points[best]], weights[points[best]] = candidates[best], tried[best]
    return found, weights


def _candidates(rest: Array, triangles: Indices, places: Array) -> tuple[Indices, Indices]:
    """Pairs of a place and a triangle near it, by the cells of a grid with about a triangle in each."""
    low, high = rest.min(axis=0), rest.max(axis=0)
    cell = max(float(np.sqrt(np.prod(np.maximum(high - low, 1e-300)) / len(triangles))), 1e-300)
    cell = max(cell, float((high - low).max()) / 4096.0)
    count = np.floor((high - low) / cell).astype(np.int64) + 1
    corners = rest[triangles]
    first = np.floor((corners.min(axis=1) - low) / cell).astype(np.int64)
    last = np.floor((corners.max(axis=1) - low) / cell).astype(np.int64)
    first, last = np.clip(first, 0, count - 1), np.clip(last, 0, count - 1)
    spans = last - first + 1
    owner, step = _expanded(spans.prod(axis=1))
    cells = (first[owner, 1] + step // spans[owner, 0]) * count[0] + first[owner, 0] + step % spans[owner, 0]
    order = np.argsort(cells, kind="stable")
    cells, owner = cells[order], owner[order]
    where = np.floor((places - low) / cell)
    inside = np.flatnonzero(((where >= 0) & (where < count)).all(axis=1))
    wanted = (where[inside, 1] * count[0] + where[inside, 0]).astype(np.int64)
    begin, end = np.searchsorted(cells, wanted, "left"), np.searchsorted(cells, wanted, "right")
    point, step = _expanded(end - begin)
    return inside[point].astype(np.int32), owner[begin[point] + step].astype(np.int32)


def _expanded(counts: Indices) -> tuple[Indices, Indices]:
    """For each of sum(counts) items: which list it is in, and the how manieth of that it is."""
    lists = np.repeat(np.arange(len(counts)), counts)
    return lists, np.arange(len(lists)) - (np.cumsum(counts) - counts)[lists]


def _nearest_edges(rest: Array, edges: Indices, places: Array) -> Indices:
    """The edge nearest to each place; of two that share the nearest end, the one that it lies before."""
    starts, sides = rest[edges[:, 0]], rest[edges[:, 1]] - rest[edges[:, 0]]
    lengths = np.maximum((sides * sides).sum(axis=1), 1e-300)
    nearest = np.empty(len(places), np.int32)
    step = max(1, CHUNK // len(edges))
    for begin in range(0, len(places), step):
        arms = places[begin : begin + step, None, :] - starts
        along = (arms * sides).sum(axis=2) / lengths
        share = np.clip(along, 0.0, 1.0)
        gaps = ((arms - share[..., None] * sides) ** 2).sum(axis=2)
        beyond = np.abs(along - share) * np.sqrt(lengths)  # past the end, as far as that is the nearest point
        least = gaps.min(axis=1, keepdims=True)
        tied = gaps <= least * (1.0 + 1e-9)
        nearest[begin : begin + step] = np.where(tied, beyond, np.inf).argmin(axis=1)
    return nearest


def share_of(carried: Carrying, chosen: Mask) -> Array:
    """How much (k,) of each point's weight is on the chosen ones of the vertices (n)."""
    result: Array = (carried.within * chosen[carried.corners]).sum(axis=1)
    return result
