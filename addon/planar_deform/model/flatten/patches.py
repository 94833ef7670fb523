# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface cut along its seams into patches, each of which can be laid flat by itself.

What is cut are corners of faces: two that meet in a vertex stay one where a way through faces leads from one
to the other without crossing a seam. So a seam that ends inside of the surface makes a slit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..plane.cutout import connected_parts
from ..plane.frame import Indices, Mask


@dataclass(frozen=True)
class Corners:
    """The faces of a mesh by their corners, face after face."""

    sizes: Indices  # f, corners of each face
    vertices: Indices  # c, of each corner
    edges: Indices  # c, of each corner: leads to the next one of its face

    @cached_property
    def starts(self) -> Indices:
        """The first corner of each face (f,)."""
        return (np.cumsum(self.sizes) - self.sizes).astype(np.int32)

    @cached_property
    def faces(self) -> Indices:
        """The face of each corner (c,)."""
        return np.repeat(np.arange(len(self.sizes), dtype=np.int32), self.sizes)

    @cached_property
    def following(self) -> Indices:
        """The next corner of the face of each corner (c,)."""
        return following_corners(self.sizes)


def following_corners(sizes: Indices) -> Indices:
    """The next corner in its face of each corner of faces of these sizes, face after face."""
    ends = np.cumsum(sizes)
    following = np.arange(1, int(sizes.sum()) + 1, dtype=np.int32)
    following[ends - 1] = ends - sizes
    return following


@dataclass(frozen=True)
class Patches:
    """Faces of a surface on flat vertices, of which a vertex on a seam has several."""

    faces: Indices  # the surface's faces
    sizes: Indices  # corners of each of them
    corners: Indices  # k, the surface's corners, face after face
    flat: Indices  # k, the flat vertex of each
    numbers: Indices  # k, of the edge that leads on: what it was cut from has the same; 0: no seam's
    vertices: Indices  # n, the surface's vertex of each flat vertex
    patch: Indices  # n, the patch of each, counted from 0
    triangles: Indices  # m x 3, of flat vertices

    @property
    def count(self) -> int:
        """How many patches there are."""
        return int(self.patch.max()) + 1

    def rows(self, patch: int) -> Indices:
        """The flat vertices of a patch, in order."""
        return np.flatnonzero(self.patch == patch).astype(np.int32)

    def triangles_of(self, patch: int) -> Indices:
        """The triangles of a patch, counting its own vertices alone."""
        own = self.triangles[self.patch[self.triangles[:, 0]] == patch]
        counted: Indices = np.searchsorted(self.rows(patch), own).astype(np.int32)
        return counted

    def turned(self) -> Patches:
        """The same, seen from the other side."""
        return replace(self, triangles=self.triangles[:, ::-1])

    def face_in(self, patch: int) -> int:
        """The first face of a patch, by which it can be told from others."""
        first = np.cumsum(self.sizes) - self.sizes
        return int(self.faces[np.argmax(self.patch[self.flat[first]] == patch)])

    @cached_property
    def edges(self) -> Indices:
        """The flat edge (k x 2) from each corner to the next one of its face."""
        return np.stack([self.flat, self.flat[following_corners(self.sizes)]], axis=1)

    def edge_of(self, ends: tuple[int, int], patch: int) -> Indices | None:
        """The two flat vertices in a patch of an edge of the surface; None where it is not in there."""
        found = (np.sort(self.vertices[self.edges], axis=1) == sorted(ends)).all(axis=1)
        found &= self.patch[self.flat] == patch
        return self.edges[np.argmax(found)] if found.any() else None


def cut(corners: Corners, chosen: Mask, seams: Mask, triangles: Indices) -> Patches:
    """The chosen faces (f,) cut along edges (e,). `triangles`: all faces in triangles of corners, t x 3.

    Raises ValueError, with what to do, where more than two of these faces meet in an edge.
    """
    inside = chosen[corners.faces]
    used = np.flatnonzero(inside).astype(np.int32)
    first, second = _meeting(corners, used)
    _check_manifold(corners, first)
    joined = ~seams[corners.edges[first]]
    classes = connected_parts(len(inside), _joined(corners, first[joined], second[joined]))
    following = corners.following
    patches = connected_parts(int(classes.max()) + 1, np.stack([classes, classes[following]], axis=1)[used])

    # Flat vertices in order of their patches, and in these of the surface's vertices.
    kept, sample = np.unique(classes[used], return_index=True)
    vertices = corners.vertices[used][sample]
    order = np.lexsort((vertices, patches[kept]))
    flat_of = np.full(len(inside), -1, np.int32)
    flat_of[kept[order]] = np.arange(len(kept), dtype=np.int32)
    flat = np.where(inside, flat_of[classes], -1).astype(np.int32)
    patch = np.unique(patches[kept][order], return_inverse=True)[1].astype(np.int32)
    return Patches(
        faces=np.flatnonzero(chosen).astype(np.int32),
        sizes=corners.sizes[chosen],
        corners=used,
        flat=flat[used],
        numbers=_numbered(flat, following, first, second)[used],
        vertices=vertices[order],
        patch=patch,
        triangles=flat[triangles[inside[triangles[:, 0]]]],
    )


def _meeting(corners: Corners, used: Indices) -> tuple[Indices, Indices]:
    """Pairs of corners, of those used, whose edges are the same one."""
    order = used[np.argsort(corners.edges[used], kind="stable")]
    same = corners.edges[order[1:]] == corners.edges[order[:-1]]
    return order[:-1][same], order[1:][same]


def _check_manifold(corners: Corners, first: Indices) -> None:
    edges, counts = np.unique(corners.edges[first], return_counts=True)
    if (counts > 1).any():
        edge = edges[np.argmax(counts > 1)]
        raise ValueError(
            f"More than two faces meet in edge {edge}: select the faces of one side of it in Edit Mode, or "
            "split it with Edge > Edge Split"
        )


def _joined(corners: Corners, first: Indices, second: Indices) -> Indices:
    """Pairs of corners that are one, where two faces meet: at both ends of the edge."""
    after, before = corners.following[first], corners.following[second]
    against = corners.vertices[first] == corners.vertices[before]  # wound alike, they run against each other
    return np.concatenate(
        [
            np.stack([first, np.where(against, before, second)], axis=1),
            np.stack([after, np.where(against, second, before)], axis=1),
        ]
    )


def _numbered(flat: Indices, following: Indices, first: Indices, second: Indices) -> Indices:
    """The number of each corner's edge: from 1 for each pair that was one edge before the cut; else 0."""
    ends = np.sort(np.stack([flat, flat[following]], axis=1), axis=1)
    apart = (ends[first] != ends[second]).any(axis=1)
    numbers = np.zeros(len(flat), np.int32)
    numbers[first[apart]] = numbers[second[apart]] = np.arange(1, np.count_nonzero(apart) + 1)
    return numbers


def matched(flat: Corners, vertices: Indices, surface: Corners) -> Indices | None:
    """The surface's corner of each corner of flat faces, whose vertices are these of the surface (n).

    Faces stand for those on the same vertices; None where one of them is on none.
    """
    starts = {
        tuple(sorted(face)): start
        for face, start in zip(_split(surface.vertices, surface.sizes), surface.starts.tolist(), strict=True)
    }
    found = []
    for face in _split(vertices[flat.vertices], flat.sizes):
        start = starts.get(tuple(sorted(face)))
        if start is None:
            return None
        there = surface.vertices[start : start + len(face)].tolist()
        found += [start + there.index(vertex) for vertex in face]
    return np.array(found, np.int32)


def _split(values: Indices, sizes: Indices) -> list[list[int]]:
    return [part.tolist() for part in np.split(values, np.cumsum(sizes)[:-1])]
