# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane that points joined by edges alone lie in."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .frame import Array, Indices

STRAIGHT = 1e-4  # of their length: points this near to a line have no plane of their own
FLAT = 1e-3  # the same of a plane that several shapes have to share


def plane_normal(shown: Array, others: Iterable[Array], parts: Indices) -> Array:
    """The unit normal (3,) across which a shape n x 3 is flat.

    Its parts (n,), which may lie in parallel planes, tell it by themselves. Where they are straight, the
    plane is the one that other shapes, read only then, share with them; or else the one in which they lie
    beside one another; or else the one they share with two of the object's axes, XY before XZ before YZ.
    """
    arms = _about_part_means(shown, parts)
    sizes, axes = _spread(arms)
    normal: Array = axes[2]
    if sizes[1] > STRAIGHT * sizes[0]:
        return normal
    together = np.concatenate([arms, *(_about_part_means(shape, parts) for shape in others)])
    for points in (together, shown - shown.mean(axis=0)):
        sizes, axes = _spread(points)
        if sizes[1] > STRAIGHT * sizes[0] and sizes[2] <= FLAT * sizes[0]:
            normal = axes[2]
            return normal
    direction = axes[0] if sizes[0] > 0.0 else np.zeros(3)
    across = next(axis for axis in (2, 1, 0) if abs(direction[axis]) <= np.sqrt(0.5))
    normal = np.eye(3)[across] - direction * direction[across]
    normal /= np.linalg.norm(normal)
    return normal


def _about_part_means(points: Array, parts: Indices) -> Array:
    counts = np.bincount(parts)
    means = np.stack([np.bincount(parts, weights=column) / counts for column in points.T], axis=1)
    result: Array = points - means[parts]
    return result


def _spread(points: Array) -> tuple[Array, Array]:
    """How far k x 3 points reach from the origin along the axes (rows) in which they reach farthest."""
    squares, axes = np.linalg.eigh(np.einsum("ki,kj->ij", points, points))
    return np.sqrt(np.maximum(squares[::-1], 0.0)), axes.T[::-1]
