# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the pixels of an image lie in a mesh that shows it, by the mesh's own corners.

However the image is turned, mirrored, sheared or cropped in the mesh's UV map, the map is affine.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..plane.frame import Array, Array32

NEAR = 0.5  # pixels that a corner may lie away from where the map takes it


class Misfit(Exception):  # noqa: N818 - a reason, as a Refusal is
    """A mesh does not show an image as a plane does; the message says how."""


@dataclass(frozen=True)
class Window:
    """The part of an image that is shown, in whole pixels: from `low`, up to and without `high`."""

    left: int
    bottom: int
    right: int
    top: int


@dataclass(frozen=True)
class Placement:
    """Takes pixels of an image, counted from its lower left corner, to where a mesh shows them."""

    size: tuple[int, int]  # of the image: width, height
    window: Window
    linear: Array  # 3 x 3: (u, v, 1) to a place in the mesh's coordinates
    mirrored: bool  # what goes counter-clockwise in the image goes clockwise in the mesh

    def uvs(self, pixels: Array) -> Array:
        """The places in the UV map (k x 2) of k x 2 pixels."""
        found: Array = pixels / np.array(self.size, np.float64)
        return found

    def places(self, pixels: Array) -> Array:
        """The places in the mesh's coordinates (k x 3) of k x 2 pixels."""
        return carried(self.uvs(pixels), self.linear)


def placed(uvs: Array | Array32, corners: Array | Array32, normal: Array, size: tuple[int, int]) -> Placement:
    """How a mesh with these corners (c x 3), at c x 2 places of the UV map, shows an image of a size.

    `normal` (3,) is that of its faces. Raises Misfit.
    """
    uvs, corners = np.asarray(uvs, np.float64), np.asarray(corners, np.float64)
    if not (np.isfinite(uvs).all() and np.isfinite(corners).all()):
        raise Misfit("it has coordinates that are not numbers")
    linear = affine_fit(uvs, corners)
    if linear is None:
        raise Misfit("its UV map has no area")
    across = np.cross(linear[0], linear[1])
    sides = np.linalg.norm(linear[:2], axis=1)
    if not np.linalg.norm(across) > 1e-9 * sides.max() ** 2:
        raise Misfit("it has no area")
    misses = np.linalg.norm(carried(uvs, linear) - corners, axis=1)
    if misses.max() > NEAR * (sides / np.array(size)).max():
        raise Misfit("its faces do not lie in a plane with the image laid on evenly")
    return Placement(size, _window(uvs, size), linear, bool(across @ normal < 0.0))


def affine_fit(start: Array | Array32, end: Array | Array32) -> Array | None:
    """The affine map (3 x d, of rows (u, v, 1)) that takes c x 2 points nearest to c x d ones.

    None where the points do not span the plane.
    """
    rows = np.insert(np.asarray(start, np.float64), 2, 1.0, axis=1)
    linear, _, rank, _ = np.linalg.lstsq(rows, np.asarray(end, np.float64), rcond=1e-9)
    return linear if rank == 3 else None


def carried(points: Array, linear: Array) -> Array:
    """k x 2 points taken by an affine map, see affine_fit()."""
    result: Array = points @ linear[:2] + linear[2]
    return result


def _window(uvs: Array, size: tuple[int, int]) -> Window:
    """The pixels of which the mesh shows more than a sliver."""
    edges = np.array([uvs.min(axis=0), uvs.max(axis=0)]) * np.array(size)
    left, bottom = np.maximum(np.floor(edges[0] + 0.01), 0).astype(int).tolist()
    right, top = np.minimum(np.ceil(edges[1] - 0.01), size).astype(int).tolist()
    if left >= right or bottom >= top:
        raise Misfit("its UV map lies outside of the image")
    return Window(left, bottom, right, top)
