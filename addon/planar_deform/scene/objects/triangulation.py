# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of a mesh of any faces, for the solve only."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from ...model.latest import make_room
from ...model.plane import quads
from ...model.plane.cutout import connected_parts
from ...model.plane.frame import Array32, Indices
from ..storage.topology import corner_vertices

ROOM = 800_000  # vertices together; what is kept of 100k takes some 5 MB


@dataclass(frozen=True)
class Faces:
    """The faces of a mesh as triangles of those vertices that belong to one."""

    vertices: Indices  # n, vertices of faces in the mesh's order
    triangles: Indices  # m x 3, indices into vertices
    parts: Indices  # n, the connected part of each, counted from 0


@dataclass(frozen=True)
class _Kept:
    """What faces are made of."""

    count: int  # of the mesh's vertices
    corners: Indices  # the vertex of each corner
    starts: Indices | None  # the first corner of each face, and
    rest: Array32 | None  # where they lie; None where all are triangles
    faces: Faces


_kept: OrderedDict[int, _Kept] = OrderedDict()  # by the mesh's session_uid


def faces_of(mesh: bpy.types.Mesh, rest: Array32) -> Faces:
    """The mesh's faces, quads and n-gons cut into triangles as they lie in `rest` (count x 3).

    A pose must not change how faces are cut, so the mesh's own triangulation, which follows the current
    coordinates, is not used. The same object as long as all that is the same.
    """
    count, corners, starts, lying = len(mesh.vertices), corner_vertices(mesh), None, None
    if len(corners) != 3 * len(mesh.polygons):
        starts, lying = _starts(mesh), rest
    kept = _kept.pop(mesh.session_uid, None)
    if (
        kept is None
        or kept.count != count
        or not np.array_equal(kept.corners, corners)
        or not _equal(kept.starts, starts)
        or not _equal(kept.rest, lying)
    ):
        triangles = corners[corner_triangles(mesh, rest)]
        kept = _Kept(count, corners, starts, lying, _faces(triangles, count))
    _kept[mesh.session_uid] = kept
    make_room(_kept, ROOM, lambda kept: kept.count)
    return kept.faces


def corner_triangles(mesh: bpy.types.Mesh, rest: Array32) -> Indices:
    """The same triangles in the same order, m x 3, as corners of the mesh's faces."""
    if len(mesh.loops) == 3 * len(mesh.polygons):
        return np.arange(len(mesh.loops), dtype=np.int32).reshape(-1, 3)
    return _cut(mesh, _starts(mesh), rest)


def forget() -> None:
    """Keep none."""
    _kept.clear()


def _starts(mesh: bpy.types.Mesh) -> Indices:
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return starts


def _equal(one: Indices | Array32 | None, other: Indices | Array32 | None) -> bool:
    return one is other or (one is not None and other is not None and np.array_equal(one, other))


def _faces(triangles: Indices, count: int) -> Faces:
    used = np.zeros(count, bool)
    used[triangles] = True
    rows = np.cumsum(used, dtype=np.int32) - 1
    vertices = np.flatnonzero(used).astype(np.int32)
    compact = rows[triangles]
    return Faces(vertices, compact, connected_parts(len(vertices), compact))


def _cut(mesh: bpy.types.Mesh, starts: Indices, rest: Array32) -> Indices:
    """Triangles of faces that begin at these corners, face by face, as corners."""
    sizes = np.diff(starts, append=len(mesh.loops))
    if sizes.max() > 4:
        return _cut_ngons(mesh, rest)
    behind = np.cumsum(sizes - 2)
    whole = sizes == 3
    triangles = np.empty((behind[-1], 3), np.int32)
    triangles[behind[whole] - 1] = starts[whole, None] + np.arange(3, dtype=np.int32)
    halves = quads.cut(starts[~whole, None] + np.arange(4, dtype=np.int32), rest[corner_vertices(mesh)])
    triangles[behind[~whole] - 2], triangles[behind[~whole] - 1] = halves[:, 0], halves[:, 1]
    return triangles


def _cut_ngons(mesh: bpy.types.Mesh, rest: Array32) -> Indices:
    copy = bmesh.new()
    try:
        copy.from_mesh(mesh, face_normals=False, vertex_normals=False)
        for vertex, place in zip(copy.verts, rest.tolist(), strict=True):
            vertex.co = place
        copy.normal_update()
        cut = [[corner.index for corner in corners] for corners in copy.calc_loop_triangles()]
    finally:
        copy.free()
    return np.array(cut, np.int32)
