# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane a cutout lies in, and its 2D coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]  # as Blender keeps coordinates
Indices = NDArray[np.int32]
Mask = NDArray[np.bool_]

AXES = "XYZ"
FEW = 64  # triangles that are asked first for an area
ROUNDING = 1e-12  # of a unit normal: a drawing across an axis lies there exactly, and stays there to the bit
# The two object axes that span the plane, by the axis its normal is nearest to: X right and Z up for a
# drawing that faces the front view, as in Blender's own views.
SPANNING = {0: (1, 2), 1: (0, 2), 2: (0, 1)}


def mapped(points: Array, matrix: Array) -> Array:
    """matrix (r x d) times each of k x d points: k x r.

    Without BLAS, whose threads take milliseconds to wake for what is done in microseconds here.
    """
    result: Array = np.einsum("kd,rd->kr", points, matrix)
    return result


def inverse(linear: Array) -> Array:
    """That of a 3 x 3 matrix, which has one.

    Without LAPACK, whose threads take milliseconds of the processor for it.
    """
    (a, b, c), (d, e, f), (g, h, i) = linear.tolist()
    cofactors = np.array(
        [
            [e * i - f * h, c * h - b * i, b * f - c * e],
            [f * g - d * i, a * i - c * g, c * d - a * f],
            [d * h - e * g, b * g - a * h, a * e - b * d],
        ]
    )
    result: Array = cofactors / (a * cofactors[0, 0] + b * cofactors[1, 0] + c * cofactors[2, 0])
    return result


def is_of(parts: Indices, chosen: Iterable[int]) -> Mask:
    """Which of n points, whose parts (n,) these are, are of one of the chosen parts."""
    flags = np.zeros(int(parts.max(initial=-1)) + 1, bool)
    flags[list(chosen)] = True
    result: Mask = flags[parts]
    return result


@dataclass(frozen=True)
class PlaneFrame:
    """Orthonormal axes (3,) in world-linear space: u and v span the plane, n = u x v is its normal."""

    u: Array
    v: Array
    n: Array
    letters: tuple[str, str]  # the object axes that u and v follow, for axis locks: ("X", "Z")

    def flatten(self, points: Array) -> Array:
        """k x 3 points in world-linear space to k x 2 plane coordinates, in world lengths."""
        return mapped(points, np.stack([self.u, self.v]))

    def lift(self, offsets: Array) -> Array:
        """k x 2 offsets within the plane to k x 3 offsets in world-linear space."""
        return mapped(offsets, np.stack([self.u, self.v], axis=1))

    def depth(self, points: Array) -> Array:
        """Distance (k,) of each point from the origin along the normal."""
        return mapped(points, self.n[None, :])[:, 0]

    def mirrored(self) -> PlaneFrame:
        """The same plane seen from behind."""
        return PlaneFrame(self.u, -self.v, -self.n, self.letters)


def plane_frame(points: Array, parts: Indices, triangles: Indices, linear: Array) -> PlaneFrame | None:
    """The frame of a mesh of k x 3 object-local points seen through a 3 x 3 linear transform.

    Its parts (k,), which may lie in parallel planes, tell the normal: across it they reach least. None when
    every triangle has zero area, or the points are not numbers. The axes do not depend on the winding.
    """
    if not np.isfinite(points).all() or not (_covers(points, triangles[:FEW]) or _covers(points, triangles)):
        return None
    normal = spread(about_part_means(points, parts))[2]
    return frame_across(np.where(np.abs(normal) < ROUNDING, 0.0, normal), linear)


def _covers(points: Array, triangles: Indices) -> bool:
    """Whether any triangle has an area."""
    first, second, third = (points[corner] for corner in triangles.T)
    return bool(np.cross(second - first, third - first).any())


def about_part_means(points: Array, parts: Indices) -> Array:
    """k x 3 points about the means of their parts (k,)."""
    result: Array = points - part_means(points, parts)[parts]
    return result


def part_means(values: Array, parts: Indices) -> Array:
    """The mean of n values, or n x d, in each part; 0 where a part has none."""
    counts = np.maximum(np.bincount(parts), 1)
    means = [np.bincount(parts, weights=column) / counts for column in np.atleast_2d(values.T)]
    result: Array = np.stack(means, axis=-1)
    return result if values.ndim == 2 else result[:, 0]


def spread(points: Array) -> tuple[Array, Array, Array]:
    """How far k x 3 points reach from the origin (3,), along the axis of most and the axis of least reach."""
    squares, axes = np.linalg.eigh(np.einsum("ki,kj->ij", points, points))
    return np.sqrt(np.maximum(squares[::-1], 0.0)), axes[:, 2], axes[:, 0]


def frame_across(normal: Array, linear: Array) -> PlaneFrame:
    """The frame of the planes across an object-local unit normal (3,), seen through a 3 x 3 linear transform.

    u follows the first of the two object axes the plane is nearest to and v is turned towards the second, so
    that neither depends on the side of the normal.
    """
    sizes = np.abs(normal)
    # Halfway between two axes rounding must not decide: shapes of one object have to get the same axes.
    first, second = SPANNING[int(np.argmax(sizes > sizes.max() - 1e-6))]
    # In-plane parts of the object axes, mapped to world-linear space: never zero, never parallel.
    along, across = (linear @ (np.eye(3)[axis] - normal * normal[axis]) for axis in (first, second))
    u = along / np.linalg.norm(along)
    v = across - u * (across @ u)
    v /= np.linalg.norm(v)
    return PlaneFrame(u, v, np.cross(u, v), (AXES[first], AXES[second]))
