# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane that points joined by edges alone lie in."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .frame import Array, Indices, about_part_means, spread

STRAIGHT = 1e-4  # of their length: points this near to a line have no plane of their own
FLAT = 1e-3  # the same of a plane that several shapes have to share


def plane_normal(shown: Array, others: Iterable[Array], parts: Indices) -> Array:
    """The unit normal (3,) across which a shape n x 3 is flat.

    Its parts (n,), which may lie in parallel planes, tell it by themselves. Where they are straight, the
    plane is the one that other shapes, read only then, share with them; or else the one in which they lie
    beside one another; or else the one they share with two of the object's axes, XY before XZ before YZ.
    """
    arms = about_part_means(shown, parts)
    sizes, longest, normal = spread(arms)
    if sizes[1] > STRAIGHT * sizes[0]:
        return normal
    together = np.concatenate([arms, *(about_part_means(shape, parts) for shape in others)])
    for points in (together, shown - shown.mean(axis=0)):
        sizes, longest, normal = spread(points)
        if sizes[1] > STRAIGHT * sizes[0] and sizes[2] <= FLAT * sizes[0]:
            return normal
    direction = longest if sizes[0] > 0.0 else np.zeros(3)
    across = next(axis for axis in (2, 1, 0) if abs(direction[axis]) <= np.sqrt(0.5))
    result: Array = np.eye(3)[across] - direction * direction[across]
    return result / np.linalg.norm(result)
