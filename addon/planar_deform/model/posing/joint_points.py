# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of joints as vertices of what in-betweens are made of, which carry parts from vertex to vertex."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.frame import Array, Indices
from .held_pins import GuidedMotion
from .joints import Joint

THICK = 0.02  # barycentric weight opposite to a side: what is nearer to it has no triangle with it


@dataclass(frozen=True, eq=False)
class JointPoints:
    """Points by two, one on each of the parts that a joint holds; behind the vertices of the drawing."""

    parts: list[tuple[int, int]]  # of each joint
    corners: Indices  # 2k x 3, the triangles in which they are
    weights: Array  # 2k x 3

    def extended(self, points: Array) -> Array:
        """The points (n x 2) with those of the joints behind them."""
        return np.concatenate([points, np.einsum("kc,kcd->kd", self.weights, points[self.corners])])

    def triangles(self, count: int) -> Indices:
        """Those that join the points, the first of number `count`, to the triangles in which they are."""
        found = []
        for number, (corners, weights) in enumerate(zip(self.corners, self.weights, strict=True), count):
            for corner in range(3):
                if weights[corner] > THICK:
                    triangle = corners.copy()
                    triangle[corner] = number
                    found.append(triangle)
        return np.array(found, np.int32).reshape(-1, 3)

    def given(self, count: int) -> list[tuple[tuple[int, int], tuple[int, int]]]:
        """The parts of each joint, and the numbers of its points."""
        firsts = range(count, count + 2 * len(self.parts), 2)
        return [(parts, (first, first + 1)) for parts, first in zip(self.parts, firsts, strict=True)]


@dataclass(frozen=True, eq=False)
class Cut:
    """A motion of the first points alone."""

    motion: native.Inbetweens | GuidedMotion
    count: int

    def at(self, times: Array | list[float], *, overshoot: bool = False) -> Array:
        """Positions f x count x 2."""
        return np.ascontiguousarray(self.motion.at(times, overshoot=overshoot)[:, : self.count])


def points_of(joints: Iterable[Joint], rest: Array, triangles: Indices) -> JointPoints | None:
    """The points of all joints that are on, of a weld those in its middle; None if there are none."""
    parts, corners, weights = [], [], []
    for joint in joints:
        if not joint.enabled:
            continue
        on, shares = joint.first
        places = np.einsum("kc,kcd->kd", shares, rest[triangles[on]])
        firm = joint.shares == joint.shares.max()
        gaps = ((places - joint.place(rest, triangles)) ** 2).sum(axis=1)
        pair = int(np.where(firm, gaps, np.inf).argmin())
        parts.append(joint.parts)
        for of, share in (joint.first, joint.second):
            corners.append(triangles[of[pair]])
            weights.append(share[pair])
    return JointPoints(parts, np.array(corners, np.int32), np.array(weights)) if parts else None
