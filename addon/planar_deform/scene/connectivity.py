# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the faces of a mesh as they are, before any triangulation."""

from __future__ import annotations

import bpy
import numpy as np

from ..model.connectivity import Connectivity
from ..model.frame import Indices


def connectivity_of(mesh: bpy.types.Mesh, vertices: Indices) -> Connectivity:
    """The faces of a mesh on those of its vertices (n) that belong to one."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return Connectivity(len(vertices), sizes, np.searchsorted(vertices, corners).astype(np.int32))
