# SPDX-License-Identifier: GPL-3.0-or-later
"""The ray of sight through a place in a view, from the matrices that show it."""

from __future__ import annotations

import numpy as np

from ..plane.frame import Array


def ray(window: Array, view: Array, place: tuple[float, float]) -> tuple[Array, Array]:
    """Origin and unit direction (3,) in the world of what is seen at a place, -1 to 1 across and up.

    `window` (4 x 4) projects, and `view` (4 x 4) goes from the world to what looks: an eye at the origin,
    along -z. Without perspective the ray begins in front of all that is seen, where the clip range begins or
    in the plane of the camera. That is computed from each matrix alone, as their product, which is float32,
    has no depth left to tell where the clip range is long.
    """
    to_world = np.linalg.inv(view)
    x, y = place
    if window[3, 3] == 0.0:  # perspective
        start = np.zeros(3)
        along = np.array([(x + window[0, 2]) / window[0, 0], (y + window[1, 2]) / window[1, 1], -1.0])
    else:
        near = (-1.0 - window[2, 3]) / window[2, 2]
        start = np.array(
            [(x - window[0, 3]) / window[0, 0], (y - window[1, 3]) / window[1, 1], max(near, 0.0)]
        )
        along = np.array([0.0, 0.0, -1.0])
    direction = to_world[:3, :3] @ along
    return to_world[:3, :3] @ start + to_world[:3, 3], direction / np.linalg.norm(direction)
