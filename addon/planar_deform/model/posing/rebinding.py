# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices by which a pin holds its place, after the mesh about it has got others."""

from __future__ import annotations

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices
from ..plane.locate import MeshPoint, nearest_point

STILL_THERE = 0.02  # of the diagonal: farther from the mesh, a place has gone with what was there
NEGLIGIBLE = 1e-6  # weights below it are rounding

Binding = tuple[Indices, Array]  # vertices of the cutout and their weights


def point_binding(cutout: Cutout, place: Array, near: Indices) -> tuple[MeshPoint, Binding] | None:
    """The mesh point at a place (2,) at rest, or nearest to it, and the group of weights that holds it.

    `near` are vertices of the connected parts it may be in; of none, any part that has the place.
    """
    part_of = cutout.parts[cutout.triangles[:, 0]]
    parts = np.unique(cutout.parts[near]) if len(near) else np.unique(part_of)
    among = np.flatnonzero(np.isin(part_of, parts)).astype(np.int32)
    found = nearest_point(cutout.rest, cutout.triangles, place, among)
    if found is None or (not len(near) and found.distance > STILL_THERE * cutout.diagonal):
        return None
    held = found.weights > NEGLIGIBLE
    return found, (cutout.triangles[found.triangle][held], found.weights[held])
