# SPDX-License-Identifier: GPL-3.0-or-later
"""Which vertices the faces of a mesh, or the lines of an outline, join, whatever its shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .frame import Indices


@dataclass(frozen=True)
class Connectivity:
    """The faces of a cutout, as they are in the mesh: triangles, quads, n-gons; or lines."""

    count: int  # vertices that belong to a face
    sizes: Indices  # corners of each face
    corners: Indices  # their vertices, face after face
    kind: str = "faces"  # or "lines", which have two corners, or "cells" of a lattice

    def difference(self, other: Connectivity) -> str | None:
        """What sets two apart, as "65 vertices, not 66"; None when they are the same."""
        if self.kind != other.kind:
            return f"{self.kind}, not {other.kind}"
        for here, there, what in (
            (self.count, other.count, "vertices"),
            (len(self.sizes), len(other.sizes), self.kind),
        ):
            if here != there:
                return f"{here} {what}, not {there}"
        if not np.array_equal(self.sizes, other.sizes):
            return f"{np.count_nonzero(self.sizes != other.sizes)} faces with another number of corners"
        owner = np.repeat(np.arange(len(self.sizes)), self.sizes)
        unequal = np.unique(owner[self.corners != other.corners])
        return f"{len(unequal)} of {len(self.sizes)} {self.kind} on other vertices" if len(unequal) else None

    def edges(self) -> Indices:
        """The edges of all faces, e x 2, each once, lower vertex first, sorted."""
        ends = np.cumsum(self.sizes)
        following = np.arange(1, len(self.corners) + 1)
        following[ends - 1] = ends - self.sizes
        pairs = np.stack([self.corners, self.corners[following]], axis=1)
        return unique_edges(pairs)


def unique_edges(pairs: Indices) -> Indices:
    """Pairs of vertices (k x 2) as edges: each once, lower vertex first, sorted."""
    return counted_edges(pairs)[0]


def counted_edges(pairs: Indices) -> tuple[Indices, NDArray[np.intp]]:
    """The same, and how often each is among the pairs."""
    first, second = pairs.T.astype(np.int64)
    keys, counts = np.unique(np.minimum(first, second) << 32 | np.maximum(first, second), return_counts=True)
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1).astype(np.int32), counts
