# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object's mesh is too coarse to bend, as the panel asks in every redraw."""

from __future__ import annotations

from collections import OrderedDict

import bpy
import numpy as np

from ...model.plane.coarseness import is_coarse
from ..objects import triangulation
from ..storage.points import read

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
        kept = counts, _is_coarse(obj)
    _kept[mesh.session_uid] = kept
    if len(_kept) > CAPACITY:
        _kept.popitem(last=False)
    return kept[1]


def forget() -> None:
    """Keep none."""
    _kept.clear()


def _is_coarse(obj: bpy.types.Object) -> bool:
    points = read(obj)
    faces = triangulation.faces_of(obj.data, points)
    shape = points[faces.vertices].astype(np.float64)
    flat = shape[:, np.sort(np.argsort(np.ptp(shape, axis=0))[1:])]  # shares of area are the same in any view
    return is_coarse(flat, faces.triangles)
