# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of a mesh of any faces, for the solve only."""

from __future__ import annotations

import hashlib
from collections import OrderedDict

import bmesh
import bpy
import numpy as np

from ..model.frame import Indices

CAPACITY = 8  # meshes

_kept: OrderedDict[bytes, Indices] = OrderedDict()


def triangles_of(mesh: bpy.types.Mesh, rest: np.ndarray) -> Indices:
    """Triangles m x 3 (vertex indices) of the mesh's faces, quads and n-gons cut as in `rest` (n x 3).

    A pose must not change how faces are cut, so the mesh's own triangulation, which follows the current
    coordinates, is used only where there is nothing to cut.
    """
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == len(mesh.polygons):
        triangles = np.empty(count * 3, np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        return triangles.reshape(-1, 3)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    digest = hashlib.blake2b(corners.tobytes() + b"|" + starts.tobytes() + b"|" + rest.tobytes()).digest()
    if digest not in _kept:
        _kept[digest] = _cut(mesh, rest)
    _kept.move_to_end(digest)
    while len(_kept) > CAPACITY:
        _kept.popitem(last=False)
    return _kept[digest]


def _cut(mesh: bpy.types.Mesh, rest: np.ndarray) -> Indices:
    copy = bmesh.new()
    try:
        copy.from_mesh(mesh, face_normals=False, vertex_normals=False)
        for vertex, place in zip(copy.verts, rest.tolist(), strict=True):
            vertex.co = place
        copy.normal_update()
        cut = [[corner.vert.index for corner in corners] for corners in copy.calc_loop_triangles()]
    finally:
        copy.free()
    return np.array(cut, np.int32)
