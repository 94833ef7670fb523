# SPDX-License-Identifier: GPL-3.0-or-later
"""Finer faces for a flat mesh that is too coarse to bend; its rim, UVs and weights stay what they are."""

from __future__ import annotations

import bmesh
import numpy as np

from ...model.plane.coarseness import is_coarse

LONG = 0.6  # of the longest edge: what is longer is halved
MOST = 20_000  # vertices at which it is left as it is


def refined(mesh: bmesh.types.BMesh) -> None:
    """Divide the faces, the longest edges first, until the mesh can bend."""
    while _is_coarse(mesh) and len(mesh.verts) < MOST:
        _cut_ngons(mesh)
        lengths = {edge: edge.calc_length() for edge in mesh.edges if edge.link_faces}
        longest = max(lengths.values())
        long = [edge for edge, length in lengths.items() if length > LONG * longest]
        bmesh.ops.subdivide_edges(mesh, edges=long, cuts=1, use_grid_fill=True)
        _cut_ngons(mesh)
        _make_even(mesh)


def _is_coarse(mesh: bmesh.types.BMesh) -> bool:
    mesh.verts.index_update()
    triangles = [[loop.vert.index for loop in corners] for corners in mesh.calc_loop_triangles()]
    places = np.array([vertex.co for vertex in mesh.verts])
    flat = places[:, np.sort(np.argsort(np.ptp(places, axis=0))[1:])]
    return is_coarse(flat, np.array(triangles, np.int32))


def _cut_ngons(mesh: bmesh.types.BMesh) -> None:
    bmesh.ops.triangulate(mesh, faces=[face for face in mesh.faces if len(face.verts) > 4])


def _make_even(mesh: bmesh.types.BMesh) -> None:
    """Turn edges between triangles so that these become less long and thin."""
    turned = [edge for edge in mesh.edges if _can_be_turned(mesh, edge)]
    faces = {face for edge in turned for face in edge.link_faces}
    if faces:
        bmesh.ops.beautify_fill(mesh, faces=list(faces), edges=turned, use_restrict_tag=False, method="ANGLE")


def _can_be_turned(mesh: bmesh.types.BMesh, edge: bmesh.types.BMEdge) -> bool:
    """Whether all looks the same when an edge goes the other way: texture and material go on across it."""
    if len(edge.link_faces) != 2 or edge.seam or not edge.smooth:
        return False
    first, second = edge.link_faces
    if len(first.verts) != 3 or len(second.verts) != 3 or first.material_index != second.material_index:
        return False
    for vertex in edge.verts:
        one, other = (next(loop for loop in face.loops if loop.vert == vertex) for face in (first, second))
        if any(one[layer].uv != other[layer].uv for layer in mesh.loops.layers.uv.values()):
            return False
    return True
