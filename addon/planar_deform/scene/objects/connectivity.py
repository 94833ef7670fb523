# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what joins the points of an object: faces as they are, before any triangulation, lines, or cells."""

from __future__ import annotations

import bpy
import numpy as np

from ...model.plane.connectivity import Connectivity
from ...model.plane.frame import Indices
from ..storage.topology import corner_vertices
from .any_object import AnyObject
from .cutout_object import CutoutObject
from .lattice_object import LatticeObject


def connectivity_of(mesh: bpy.types.Mesh, vertices: Indices) -> Connectivity:
    """The faces of a mesh on those of its vertices (n) that belong to one."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    corners = np.searchsorted(vertices, corner_vertices(mesh)).astype(np.int32)
    return Connectivity(len(vertices), sizes, corners)


def shape_connectivity(drawing: AnyObject) -> Connectivity:
    """The faces, the lines or the cells of any shape. Raises ObjectGone."""
    if isinstance(drawing, CutoutObject):
        return connectivity_of(drawing.resolve().data, drawing.vertex_indices)
    kind = "cells" if isinstance(drawing, LatticeObject) else "lines"
    joined = drawing.cells if isinstance(drawing, LatticeObject) else drawing.elements["edges"]
    sizes = np.full(len(joined), joined.shape[1], np.int32)
    return Connectivity(len(drawing.vertex_indices), sizes, joined.ravel(), kind)
