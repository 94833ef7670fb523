# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a mesh in space: the one that a ray meets first, and the nearest one to a place."""

from __future__ import annotations

import numpy as np

from .frame import Array, Indices
from .locate import INSIDE, MeshPoint


def first_met(positions: Array, triangles: Indices, origin: Array, direction: Array) -> MeshPoint | None:
    """The point of n x 3 positions that a ray meets first; None where it misses."""
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    slope = across @ direction
    met = slope != 0.0
    slope = np.where(met, slope, 1.0)
    distance = np.einsum("ij,ij->i", across, a - origin) / slope
    weights = _weights(a, b, c, across, origin + distance[:, None] * direction)
    met &= (distance >= 0.0) & (weights.min(axis=1) >= INSIDE)
    if not met.any():
        return None
    first = int(np.argmin(np.where(met, distance, np.inf)))
    inside = np.clip(weights[first], 0.0, 1.0)
    return MeshPoint(first, inside / inside.sum())


def nearest_in_space(positions: Array, triangles: Indices, place: Array, among: Indices) -> MeshPoint | None:
    """The point of n x 3 positions nearest to a place (3,), in the triangles listed in `among`."""
    if not len(among):
        return None
    corners = positions[triangles[among]]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    across = np.cross(b - a, c - a)
    sizes = np.linalg.norm(across, axis=1)
    heights = np.einsum("ij,ij->i", across, place - a) / np.where(sizes > 0.0, sizes, 1.0)
    inside = _weights(a, b, c, across, place)
    over = (sizes > 0.0) & (inside.min(axis=1) >= INSIDE)
    sides = corners[:, [1, 2, 0]] - corners
    lengths = np.einsum("ijk,ijk->ij", sides, sides)
    reach = np.einsum("ijk,ijk->ij", place - corners, sides)
    share = np.clip(np.divide(reach, lengths, out=np.zeros_like(reach), where=lengths > 0.0), 0.0, 1.0)
    gaps = np.linalg.norm(corners + share[:, :, None] * sides - place, axis=2)
    distances = np.where(over, np.abs(heights), gaps.min(axis=1))
    row = int(np.argmin(distances))
    if over[row]:
        weights = np.clip(inside[row], 0.0, 1.0)
    else:
        side = int(np.argmin(gaps[row]))
        weights = np.zeros(3)
        weights[side], weights[(side + 1) % 3] = 1.0 - share[row, side], share[row, side]
    return MeshPoint(int(among[row]), weights / weights.sum(), float(distances[row]))


def _weights(a: Array, b: Array, c: Array, across: Array, places: Array) -> Array:
    """Barycentric weights (k x 3) of places, one or k, seen along the triangles' normals."""
    sizes = np.einsum("ij,ij->i", across, across)
    sizes = np.where(sizes > 0.0, sizes, np.inf)
    second = np.einsum("ij,ij->i", np.cross(places - a, c - a), across) / sizes
    third = np.einsum("ij,ij->i", np.cross(b - a, places - a), across) / sizes
    weights: Array = np.stack([1.0 - second - third, second, third], axis=1)
    return weights
