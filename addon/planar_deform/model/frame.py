# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane a cutout lies in, and its 2D coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int32]

AXES = "XYZ"
# The two object axes that span the plane, by the axis its normal is nearest to: X right and Z up for a
# drawing that faces the front view, as in Blender's own views.
SPANNING = {0: (1, 2), 1: (0, 2), 2: (0, 1)}


@dataclass(frozen=True)
class PlaneFrame:
    """Orthonormal axes (3,) in world-linear space: u and v span the plane, n = u x v is its normal."""

    u: Array
    v: Array
    n: Array
    letters: tuple[str, str]  # the object axes that u and v follow, for axis locks: ("X", "Z")

    def flatten(self, points: Array) -> Array:
        """k x 3 points in world-linear space to k x 2 plane coordinates, in world lengths."""
        return np.stack([points @ self.u, points @ self.v], axis=1)

    def lift(self, offsets: Array) -> Array:
        """k x 2 offsets within the plane to k x 3 offsets in world-linear space."""
        return np.outer(offsets[:, 0], self.u) + np.outer(offsets[:, 1], self.v)

    def depth(self, points: Array) -> Array:
        """Distance (k,) of each point from the origin along the normal."""
        return points @ self.n

    def mirrored(self) -> PlaneFrame:
        """The same plane seen from behind."""
        return PlaneFrame(self.u, -self.v, -self.n, self.letters)


def plane_frame(points: Array, triangles: Indices, linear: Array) -> PlaneFrame | None:
    """The frame of a mesh of k x 3 object-local points seen through a 3 x 3 linear transform.

    The normal is the area-weighted mean of the triangles', all turned to the side of the largest one, so that
    a mixed winding does not cancel; None when every triangle has zero area. u follows the first of the two
    object axes the plane is nearest to and v is turned towards the second, so that neither depends on the
    winding.
    """
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = np.cross(b - a, c - a)
    sizes = np.einsum("ij,ij->i", areas, areas)
    if not len(areas) or not sizes.max() > 0.0:
        return None
    largest = areas[int(np.argmax(sizes))]
    normal = (np.where(areas @ largest < 0.0, -1.0, 1.0)[:, None] * areas).sum(axis=0)
    normal /= np.linalg.norm(normal)
    first, second = SPANNING[int(np.argmax(np.abs(normal)))]
    # In-plane parts of the object axes, mapped to world-linear space: never zero, never parallel.
    along, across = (linear @ (np.eye(3)[axis] - normal * normal[axis]) for axis in (first, second))
    u = along / np.linalg.norm(along)
    v = across - u * (across @ u)
    v /= np.linalg.norm(v)
    return PlaneFrame(u, v, np.cross(u, v), (AXES[first], AXES[second]))
