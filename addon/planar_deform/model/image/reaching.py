# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on the rim of a mesh that the next one has as well: pins sit on the very tips of drawings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..plane.cutout import diagonal_of, signed_areas
from ..plane.frame import Array, Indices
from ..plane.locate import nearest_point
from .filling import Filling, Piece

FARTHEST = 0.02  # of the diagonal: what is farther outside is no part of the drawing any more
ENDS = 0.7  # of an edge: a place that is nearer to one of its ends than so takes that end along
LEAST = 0.05  # of its area before: a triangle of less is nearly turned over


def reaching(filling: Filling, places: Array, parts: Indices) -> Filling:
    """The filling so that p x 2 places, of these parts of the other mesh (p,), lie in it.

    A place just outside of it becomes a vertex of its rim.
    """
    pieces, within = list(filling.pieces), FARTHEST * diagonal_of(filling.places)
    kept: set[tuple[int, int]] = set()  # vertices that are at places
    for place, part in zip(places, parts.tolist(), strict=True):
        nearest = None
        for number, piece in enumerate(pieces):
            if part not in piece.parts:
                continue
            found = nearest_point(piece.places, piece.triangles, place, np.arange(len(piece.triangles)))
            if found is not None and (nearest is None or found.distance < nearest[1].distance):
                nearest = number, found
        if nearest is None or nearest[1].distance == 0.0 or nearest[1].distance > within:
            continue
        number, point = nearest
        piece = pieces[number]
        vertex = int(piece.triangles[point.triangle][int(point.weights.argmax())])
        moved = None
        if point.weights.max() >= ENDS and (number, vertex) not in kept:
            moved = _moved(piece, vertex, place)
        if moved is None and np.count_nonzero(point.weights > 1e-9) == 2:
            moved, vertex = _divided(piece, point.triangle, point.weights, place), len(piece.places)
        if moved is not None:
            pieces[number] = moved
            kept.add((number, vertex))
    return replace(filling, pieces=pieces)


def _moved(piece: Piece, vertex: int, place: Array) -> Piece | None:
    """With a vertex at a place; None where that would turn a triangle over."""
    places = piece.places.copy()
    places[vertex] = place
    about = piece.triangles[(piece.triangles == vertex).any(axis=1)]
    if (signed_areas(places, about) < LEAST * signed_areas(piece.places, about)).any():
        return None
    return replace(piece, places=places)


def _divided(piece: Piece, triangle: int, weights: Array, place: Array) -> Piece | None:
    """With a new vertex before the edge of a triangle on which a point with these weights is."""
    corners = piece.triangles[triangle]
    away = int(weights.argmin())  # the corner across
    a, b, c = corners[(away + 1) % 3], corners[(away + 2) % 3], corners[away]
    new = len(piece.places)
    places = np.concatenate([piece.places, place[None, :]])
    halves = np.array([[a, new, c], [new, b, c]], np.int32)
    if (signed_areas(places, halves) <= 0.0).any():
        return None
    others = np.delete(piece.triangles, triangle, axis=0)
    return replace(piece, places=places, triangles=np.concatenate([others, halves]))
