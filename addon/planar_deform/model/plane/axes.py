# SPDX-License-Identifier: GPL-3.0-or-later
"""The axes along which things are moved in a plane: the world's, or the object's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .frame import PlaneFrame, frame_across

Orientation = Literal["GLOBAL", "LOCAL"]  # Blender's names of these transform orientations
Pair = tuple[float, float]

# Digits of a direction: beyond is the rounding of a transform in float32, which would turn a typed number
# into one beside it.
DIGITS = 7


@dataclass(frozen=True)
class PlaneAxes:
    """Two perpendicular axes that span a plane, named by the world's or the object's that they follow."""

    letters: tuple[str, str]
    first: Pair = (1.0, 0.0)  # in the plane's coordinates, with length 1
    second: Pair = (0.0, 1.0)

    def values(self, offset: Pair) -> Pair:
        """How far an offset in the plane's coordinates goes along each axis."""
        (a, b), (c, d) = self.first, self.second
        return a * offset[0] + b * offset[1], c * offset[0] + d * offset[1]

    def along(self, letter: str) -> Pair | None:
        """Where the axis of this name points in the plane's coordinates; None where it leaves the plane."""
        named = dict(zip(self.letters, (self.first, self.second), strict=True))
        return named.get(letter)

    def offset(self, values: Pair) -> Pair:
        """The offset in the plane's coordinates that goes this far along each axis."""
        (a, b), (c, d) = self.first, self.second
        return a * values[0] + c * values[1], b * values[0] + d * values[1]


def plane_axes(frame: PlaneFrame, orientation: Orientation) -> PlaneAxes:
    """The axes of a plane: of the world those two that it is nearest to, or those that its u and v follow."""
    if orientation == "LOCAL":
        return PlaneAxes(frame.letters)
    world = frame_across(frame.n, np.eye(3))
    first, second = np.round(frame.flatten(np.stack([world.u, world.v])), DIGITS).tolist()
    return PlaneAxes(world.letters, (first[0], first[1]), (second[0], second[1]))
