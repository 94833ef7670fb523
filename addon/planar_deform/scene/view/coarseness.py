# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object's mesh is too coarse to bend, as the panel asks in every redraw."""

from __future__ import annotations

from collections import OrderedDict

import bpy
import numpy as np

from ...model.plane.coarseness import is_coarse

CAPACITY = 8  # meshes

# By the mesh's identity: how many of everything it has, and whether it is coarse, however it is posed.
_kept: OrderedDict[int, tuple[tuple[int, ...], bool]] = OrderedDict()


def of(obj: bpy.types.Object) -> bool:
    """Whether the mesh of an object with faces bends badly for want of vertices."""
    mesh = obj.data
    if not mesh.polygons:
        return False
    counts = (len(mesh.vertices), len(mesh.edges), len(mesh.polygons))
    kept = _kept.pop(mesh.session_uid, None)
    if kept is None or kept[0] != counts:
        kept = counts, _is_coarse(mesh)
    _kept[mesh.session_uid] = kept
    if len(_kept) > CAPACITY:
        _kept.popitem(last=False)
    return kept[1]


def forget() -> None:
    """Keep none."""
    _kept.clear()


def _is_coarse(mesh: bpy.types.Mesh) -> bool:
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    used, triangles = np.unique(triangles, return_inverse=True)
    coordinates = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    rest = coordinates.reshape(-1, 3)[used].astype(np.float64)
    flat = rest[:, np.sort(np.argsort(np.ptp(rest, axis=0))[1:])]  # shares of area are the same in any view
    return is_coarse(flat, triangles.reshape(-1, 3).astype(np.int32))
