# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings that are symmetric at rest, and their poses seen in the mirror."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..plane.connectivity import unique_edges
from ..plane.frame import Array, Indices
from .pins import Holder


class NotSymmetricError(ValueError):
    """The message says what has no partner."""


@dataclass(frozen=True)
class Symmetry:
    """The mirror line of a rest shape and the partner of each vertex on its other side."""

    axis: int  # of the plane's two, the one that is turned round: 0 swaps left and right
    line: float  # the coordinate of the mirror line along that axis
    partners: Indices  # n

    def reflected(self, points: Array) -> Array:
        """k x 2 points (or one) on the other side of the mirror line."""
        result = np.array(points, dtype=np.float64)
        result[..., self.axis] = 2.0 * self.line - result[..., self.axis]
        return result

    def mirrored(self, positions: Array) -> Array:
        """The n x 2 pose in the mirror: each vertex goes where its partner's reflection is."""
        return self.reflected(positions[self.partners])


def find_symmetry(rest: Array, edges: Indices, axis: int, tolerance: float) -> Symmetry:
    """The symmetry of n x 2 rest positions about the middle of their extent along an axis.

    Each vertex's partner is the vertex nearest to its reflection, which has to be within `tolerance` (a
    length); partners have to be each other's, and edges (e x 2) have to go to edges. Raises
    NotSymmetricError.
    """
    line = float(rest[:, axis].min() + rest[:, axis].max()) / 2.0
    count = len(rest)
    found = Symmetry(axis, line, np.arange(count, dtype=np.int32))
    partners, distances = nearest(rest, found.reflected(rest))
    lonely = np.count_nonzero(distances > tolerance)
    if lonely:
        raise NotSymmetricError(
            f"{lonely} of {count} vertices have no partner within {tolerance:.3g}; "
            f"the worst is {distances.max():.3g} off"
        )
    shared = np.count_nonzero(partners[partners] != np.arange(count))
    if shared:
        raise NotSymmetricError(f"{shared} of {count} vertices share their partner with another")
    mirrored = unique_edges(partners[edges])
    own = unique_edges(edges)
    both = np.unique(np.concatenate([own, mirrored]), axis=0)
    unmatched = len(both) - len(own)
    if unmatched:
        raise NotSymmetricError(
            f"{unmatched} of {len(own)} edges have no partner, though all vertices have one"
        )
    return Symmetry(axis, line, partners)


def counterparts(shape: tuple[Array, Indices], image: tuple[Array, Indices], tolerance: float) -> Indices:
    """For each of n vertices of a shape the one of an image of it, wherever that lies, that is its own.

    Both are n x 2 rest positions with edges (e x 2). The middles of their extents are laid on each other,
    then partners have to be within `tolerance` (a length), and edges have to go to edges. Raises
    NotSymmetricError.
    """
    (rest, edges), (seen, edges_seen) = shape, image
    if len(rest) != len(seen) or len(edges) != len(edges_seen):
        raise NotSymmetricError(f"{len(rest)} vertices on one side, {len(seen)} on the other")
    middles = [0.5 * (points.min(axis=0) + points.max(axis=0)) for points in (rest, seen)]
    partners, distances = nearest(seen, rest + middles[1] - middles[0])
    lonely = np.count_nonzero(distances > tolerance)
    if lonely or len(np.unique(partners)) < len(rest):
        raise NotSymmetricError(f"{lonely} of {len(rest)} vertices have no partner within {tolerance:.3g}")
    if not np.array_equal(unique_edges(partners[edges]), unique_edges(edges_seen)):
        raise NotSymmetricError("edges have no partner, though all vertices have one")
    return partners


def nearest(points: Array, queries: Array) -> tuple[Indices, Array]:
    """For each of k x 2 queries the index of the nearest of n x 2 points, and its distance.

    Exact: a sweep outwards from the query along the first axis, until the gap alone exceeds the distance.
    """
    order = np.argsort(points[:, 0], kind="stable")
    x, y = points[order].T
    starts = np.searchsorted(x, queries[:, 0])
    best = np.full(len(queries), np.inf)
    index = np.zeros(len(queries), np.int32)
    active = np.arange(len(queries))
    step = 0
    while len(active):
        goes_on = np.zeros(len(active), bool)
        for candidates in (starts[active] + step, starts[active] - 1 - step):
            inside = (candidates >= 0) & (candidates < len(points))
            rows, at = active[inside], candidates[inside]
            gaps = np.abs(x[at] - queries[rows, 0])
            distances = np.hypot(gaps, y[at] - queries[rows, 1])
            better = distances < best[rows]
            best[rows[better]], index[rows[better]] = distances[better], order[at[better]]
            goes_on[inside] |= gaps < best[rows]
        active = active[goes_on]
        step += 1
    return index, best


def partner_pins(
    holders: Sequence[Holder], rest: Array, symmetry: Symmetry, tolerance: float
) -> dict[int, int]:
    """For each pin (by its place in `holders`) the one of its kind on the other side, where there is one."""
    places = [holder.place(rest) for holder in holders]
    partners = {}
    for index, holder in enumerate(holders):
        mirrored = symmetry.reflected(places[index])
        gaps = [
            float(np.linalg.norm(place - mirrored)) if other.pin.kind == holder.pin.kind else np.inf
            for place, other in zip(places, holders, strict=True)
        ]
        closest = int(np.argmin(gaps))
        if gaps[closest] <= tolerance:
            partners[index] = closest
    return partners
