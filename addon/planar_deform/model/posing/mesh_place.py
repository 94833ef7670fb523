# SPDX-License-Identifier: GPL-3.0-or-later
"""A place of a mesh that others are to go with: which vertices tell where it is, and how these have moved.

What goes with it keeps its shape, so it gets the rigid motion of all vertices about the place:
a triangle alone would turn by any shear of the mesh.
"""

from __future__ import annotations

import numpy as np

from ..plane.cutout import Cutout
from ..plane.frame import Array, Indices, Mask, mapped
from ..plane.locate import MeshPoint, at
from .rebinding import Binding

REACH = 0.025  # of the diagonal, from the place, at rest
FEWEST = 6  # vertices; a coarse mesh has fewer within reach
EDGE = 0.2  # of the weight in the middle, at the farthest vertex
THIN = 1e-3  # of the largest variance: what is thinner tells nothing of how that direction has turned
STIFF = 1e-9  # of the map: keeps what nothing tells of, as a turn about a line on which all vertices lie


def place_binding(cutout: Cutout, point: MeshPoint) -> Binding:
    """The vertices about a point of a cutout, and how much each counts (0 to 1).

    They are joined to it by edges, so that another finger beside it is none of them.
    """
    corners = cutout.triangles[point.triangle]
    place = at(cutout.rest, cutout.triangles, point)
    distances = np.linalg.norm(cutout.rest - place, axis=1)
    held = np.zeros(len(cutout.rest), bool)
    held[corners] = True
    held = _grown(held, cutout.triangles, distances <= REACH * cutout.diagonal)
    while np.count_nonzero(held) < FEWEST:
        more = _around(held, cutout.triangles)
        if more.sum() == held.sum():
            break  # that is all of the part
        held = more
    rows = np.flatnonzero(held).astype(np.int32)
    far = distances[rows] / max(float(distances[rows].max()), np.finfo(float).tiny)
    return rows, 1.0 - (1.0 - EDGE) * far**2


def spanning(places: Array) -> tuple[int, int, int]:
    """Three of k x 2 places (k >= 3) that span much: the ends of about the longest line, and one beside."""
    first = int(np.argmax(((places - places.mean(axis=0)) ** 2).sum(axis=1)))
    arms = places - places[first]
    second = int(np.argmax((arms**2).sum(axis=1)))
    beside = np.abs(arms[:, 0] * arms[second, 1] - arms[:, 1] * arms[second, 0])
    return first, second, int(np.argmax(beside))


def rigid_motion(before: Array, after: Array, weights: Array) -> Array:
    """The motion (4 x 4) of space that takes k x 3 points to where they are, as far as a rigid one can.

    It takes their middle along, and turns by the rotation in the affine map that fits them best in weighted
    squares, its polar factor: what is only stretched does not turn, wherever the points lie. Points of a
    line, or a single one, are turned as little as can be.
    """
    shares = weights / weights.sum()
    centre, centre_after = shares @ before, shares @ after
    arms, arms_after = before - centre, after - centre_after
    spread = np.einsum("k,ki,kj->ij", shares, arms, arms)
    across = np.einsum("k,ki,kj->ij", shares, arms_after, arms)
    fit = across @ np.linalg.pinv(spread, rcond=THIN, hermitian=True)
    left, _, right = np.linalg.svd(fit + STIFF * np.linalg.norm(fit) * np.eye(3))
    sign = np.sign(np.linalg.det(left) * np.linalg.det(right))
    motion = np.eye(4)
    motion[:3, :3] = left @ np.diag([1.0, 1.0, sign]) @ right
    motion[:3, 3] = centre_after - mapped(centre[None, :], motion[:3, :3])[0]
    return motion


def _grown(held: Mask, triangles: Indices, near: Mask) -> Mask:
    """What is joined to what is held by edges of triangles of near vertices."""
    while True:
        more = held | (_around(held, triangles) & near)
        if more.sum() == held.sum():
            return held
        held = more


def _around(held: Mask, triangles: Indices) -> Mask:
    """The vertices of all triangles that have one that is held."""
    found = held.copy()
    found[triangles[held[triangles].any(axis=1)]] = True
    return found
