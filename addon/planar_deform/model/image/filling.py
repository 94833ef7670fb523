# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that are to take another one's place: its pieces, each with the parts of the other that it is of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..plane.carrying import Carrying, carrying
from ..plane.frame import Array, Indices, Mask


@dataclass(frozen=True)
class Piece:
    """What hangs together, or is of one part."""

    places: Array  # k x 2, in the plane of the other mesh at rest
    triangles: Indices  # f x 3, counter-clockwise
    parts: Indices  # of the other mesh: what it takes over from them


@dataclass(frozen=True)
class Filling:
    """All the pieces. Arrays over all of them have their points and triangles one after the other."""

    pieces: list[Piece]
    said: tuple[str, ...] = ()  # to be told, a sentence each

    @cached_property
    def places(self) -> Array:
        """All points, k x 2."""
        return np.concatenate([piece.places for piece in self.pieces])

    @cached_property
    def triangles(self) -> Indices:
        """All triangles, f x 3."""
        starts = np.cumsum([0, *(len(piece.places) for piece in self.pieces)])
        shifted = [piece.triangles + start for piece, start in zip(self.pieces, starts, strict=False)]
        joined: Indices = np.concatenate(shifted).astype(np.int32)
        return joined

    @cached_property
    def piece_of(self) -> Indices:
        """The piece of each point (k,)."""
        counts = [len(piece.places) for piece in self.pieces]
        return np.repeat(np.arange(len(counts), dtype=np.int32), counts)

    def points_of(self, part: int) -> Indices:
        """The points that have taken over from a part of the other mesh."""
        pieces = [number for number, piece in enumerate(self.pieces) if part in piece.parts]
        return np.flatnonzero(np.isin(self.piece_of, pieces)).astype(np.int32)

    def carrying(self, rest: Array, triangles: Indices, part_of: Indices) -> Carrying:
        """How all points hang in the other mesh, n x 2 with triangles m x 3 that are of parts (m,)."""
        return self._carrying(rest, triangles, part_of, [piece.places for piece in self.pieces])

    def middles(self, rest: Array, triangles: Indices, part_of: Indices) -> Indices:
        """The triangles of the other mesh that the middles of the new ones (f) are in, or nearest to."""
        middles = [piece.places[piece.triangles].mean(axis=1) for piece in self.pieces]
        return self._carrying(rest, triangles, part_of, middles).triangles

    def _carrying(self, rest: Array, triangles: Indices, part_of: Indices, places: list[Array]) -> Carrying:
        found = []
        for piece, here in zip(self.pieces, places, strict=True):
            among = np.flatnonzero(np.isin(part_of, piece.parts)).astype(np.int32)
            hung = carrying(rest, triangles[among], here)
            found.append(Carrying(hung.corners, hung.weights, among[hung.triangles]))
        return Carrying(
            np.concatenate([one.corners for one in found]),
            np.concatenate([one.weights for one in found]),
            np.concatenate([one.triangles for one in found]),
        )


def clockwise(areas: Array, numbers: Indices, count: int) -> Mask:
    """Of so many groups, those most of whose triangles (m areas, signed, and groups) go clockwise."""
    return np.bincount(numbers, weights=areas, minlength=count) < 0.0
