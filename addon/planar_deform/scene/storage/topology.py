# SPDX-License-Identifier: GPL-3.0-or-later
"""What joins the vertices of a mesh, read from its attributes: a hundred times as fast as from its lists."""

from __future__ import annotations

import bpy
import numpy as np

from ...model.plane.frame import Indices


def corner_vertices(mesh: bpy.types.Mesh) -> Indices:
    """The vertex of each corner of a face (c,), face by face."""
    return _integers(mesh, ".corner_vert", mesh.loops, "vertex_index")


def corner_edges(mesh: bpy.types.Mesh) -> Indices:
    """The edge of each corner of a face (c,) that leads to the next corner."""
    return _integers(mesh, ".corner_edge", mesh.loops, "edge_index")


def edge_vertices(mesh: bpy.types.Mesh) -> Indices:
    """The ends of each edge, e x 2."""
    return _integers(mesh, ".edge_verts", mesh.edges, "vertices", 2).reshape(-1, 2)


def _integers(
    mesh: bpy.types.Mesh, attribute: str, items: bpy.types.bpy_prop_collection, field: str, size: int = 1
) -> Indices:
    result = np.empty(len(items) * size, np.int32)
    found = mesh.attributes.get(attribute)  # there is none in Edit Mode
    if found is None:
        items.foreach_get(field, result)
    else:
        found.data.foreach_get("value", result)
    return result
