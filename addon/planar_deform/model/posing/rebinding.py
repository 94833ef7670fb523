# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices by which a pin holds its place, after the mesh about it has got others."""

from __future__ import annotations

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices, Mask
from ..plane.locate import MeshPoint, at, nearest_point
from ..plane.space import nearest_in_space
from .pins import Holder, Pin

STILL_THERE = 0.02  # of the diagonal: farther from the mesh, a place has gone with what was there
NEGLIGIBLE = 1e-6  # weights below it are rounding
FULL = 1.0 - 1e-3  # of the largest weight

Binding = tuple[Indices, Array]  # vertices of the cutout and their weights


def rebound(
    cutout: Cutout,
    pin: Pin,
    place: Array,
    within: float,
    *,
    whole: bool,
    known: Mask | None = None,
    farthest: float = np.inf,
) -> Binding | None:
    """What holds the place at rest (2 or 3,) of a pin; None where its group does, or nothing can.

    `within`: of the diagonal, as near is there; `farthest`: and what is farther has been moved away. `whole`:
    the group is a patch's own, of even weights. `known`: vertices (n,) that are no new ones.
    """
    rows = pin.vertices
    if pin.kind == "PATCH" and len(rows):
        # Blender gives new vertices a mean of the weights about them: less than all beyond the patch's edge.
        inside = pin.weights >= pin.weights.max() * FULL
        if known is not None:
            inside &= known[rows]
        if inside.all() or not inside.any() or not whole:
            return None
        return rows[inside], pin.weights[inside]
    found = point_binding(cutout, place, rows)
    if found is None:
        return None
    point, binding = found
    if point.distance > farthest * cutout.diagonal:
        return None
    if pin.kind == "PATCH":  # all of it is gone: what is there now
        return binding[0], np.ones(len(binding[0]))
    if len(rows):
        here = Holder(pin, cutout).place(cutout.rest)
        there = at(cutout.rest, cutout.triangles, point)
        if np.linalg.norm(here - there) <= within * cutout.diagonal:
            return None
    return binding


def point_binding(cutout: Cutout, place: Array, near: Indices) -> tuple[MeshPoint, Binding] | None:
    """The mesh point at a place (2 or 3,) at rest, or nearest to it, and the group of weights that holds it.

    `near` are vertices of the connected parts it may be in; of none, any part that has the place.
    """
    part_of = cutout.parts[cutout.triangles[:, 0]]
    parts = np.unique(cutout.parts[near]) if len(near) else np.unique(part_of)
    among = np.flatnonzero(np.isin(part_of, parts)).astype(np.int32)
    nearest = nearest_point if cutout.rest.shape[1] == 2 else nearest_in_space
    found = nearest(cutout.rest, cutout.triangles, place, among)
    if found is None or (not len(near) and found.distance > STILL_THERE * cutout.diagonal):
        return None
    held = found.weights > NEGLIGIBLE
    return found, (cutout.triangles[found.triangle][held], found.weights[held])
