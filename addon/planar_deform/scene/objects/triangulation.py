# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of a mesh of any faces, for the solve only."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from ...model.plane.cutout import connected_parts
from ...model.plane.frame import Array32, Indices
from ..storage.topology import corner_vertices

CAPACITY = 8  # meshes


@dataclass(frozen=True)
class Faces:
    """The faces of a mesh as triangles of those vertices that belong to one."""

    vertices: Indices  # n, vertices of faces in the mesh's order
    triangles: Indices  # m x 3, indices into vertices
    parts: Indices  # n, the connected part of each, counted from 0


_kept: OrderedDict[bytes, Faces] = OrderedDict()


def faces_of(mesh: bpy.types.Mesh, rest: Array32) -> Faces:
    """The mesh's faces, quads and n-gons cut into triangles as they lie in `rest` (count x 3).

    A pose must not change how faces are cut, so the mesh's own triangulation, which follows the current
    coordinates, is used only where there is nothing to cut.
    """
    mesh.calc_loop_triangles()
    whole = len(mesh.loop_triangles) == len(mesh.polygons)
    key = hashlib.blake2b(corner_vertices(mesh).tobytes())
    if not whole:
        starts = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_start", starts)
        key.update(starts.tobytes())
        key.update(rest.tobytes())
    digest = key.digest()
    if digest not in _kept:
        _kept[digest] = _faces(corner_vertices(mesh)[_own_triangles(mesh) if whole else _cut(mesh, rest)])
    _kept.move_to_end(digest)
    while len(_kept) > CAPACITY:
        _kept.popitem(last=False)
    return _kept[digest]


def corner_triangles(mesh: bpy.types.Mesh, rest: Array32) -> Indices:
    """The same triangles in the same order, m x 3, as corners of the mesh's faces."""
    mesh.calc_loop_triangles()
    whole = len(mesh.loop_triangles) == len(mesh.polygons)
    return _own_triangles(mesh) if whole else _cut(mesh, rest)


def forget() -> None:
    """Keep none."""
    _kept.clear()


def _faces(triangles: Indices) -> Faces:
    vertices, compact = np.unique(triangles, return_inverse=True)
    compact = compact.reshape(-1, 3).astype(np.int32)
    return Faces(vertices, compact, connected_parts(len(vertices), compact))


def _own_triangles(mesh: bpy.types.Mesh) -> Indices:
    corners = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    return corners.reshape(-1, 3)


def _cut(mesh: bpy.types.Mesh, rest: Array32) -> Indices:
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
