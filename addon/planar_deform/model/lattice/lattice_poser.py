# SPDX-License-Identifier: GPL-3.0-or-later
"""A lattice's solver as one that poses: its points are vertices behind those of the meshes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.cutout import Cutout, diagonal_of
from ..plane.frame import Array, Indices, mapped
from ..work import Progress


@dataclass(frozen=True, eq=False)
class LatticeShape:
    """What a lattice deforms, and its own points, at rest. All in one space, in world lengths."""

    rest: Array  # n x 3, of the vertices
    triangles: Indices  # m x 3
    weights: native.LatticeWeights  # n x N by rows, with the modifiers' factors
    points: Array  # N x 3, of the lattice

    @property
    def recipe(self) -> tuple[object, ...]:
        """What a solver is made of."""
        return (self.rest, self.triangles, *self.weights, self.points)


class LatticePoser:
    """Has what a posing asks of native.Poser. Positions are (n + N) x 3, points of the lattice last.

    Triangle m + i is the point i of the lattice, by which handles are told. `axes` are the three columns of
    positions as directions of the shape's space. `flat`: the third one is left as it is.
    """

    def __init__(self, solver: native.LatticeSolver, shape: LatticeShape, axes: Array, *, flat: bool):
        self._solver, self._flat, self._axes = solver, flat, axes
        self._first, self._count = len(shape.triangles), len(shape.rest)
        self._start = np.empty((0, 3))
        self._on_mesh = self._on_lattice = np.empty(0, np.intp)  # which handles are which

    @staticmethod
    def solver(shape: LatticeShape, axes: Array, *, flat: bool) -> native.LatticeSolver:
        """What a LatticePoser needs: of a flat shape in its plane, else in its own space."""
        rest, points = shape.rest, shape.points
        if flat:
            rest, points = (mapped(places, axes[:2]) for places in (rest, points))
        return native.LatticeSolver(rest, shape.triangles, shape.weights, points)

    @property
    def report(self) -> native.LatticeReport:
        """Of the last step."""
        return self._solver.report

    def reset(self, positions: Array) -> None:
        """Go on from here, as far as the lattice's points tell."""
        self._start = positions
        self._solver.reset(self._into(positions[self._count :]))

    def set_handles(self, handles: tuple[Indices, Array], *, weights: Array, groups: Indices) -> None:
        """Handles as of native.Poser. Of several on one point of the lattice the first one counts.

        Each handle of a patch weighs as much as a pin, so that patches are rigid: bending is dearer here.
        """
        triangles, corners = handles
        self._on_mesh = np.flatnonzero(triangles < self._first)
        points, first = np.unique(triangles, return_index=True)
        self._on_lattice = np.sort(first[points >= self._first])
        on_mesh = (triangles[self._on_mesh], corners[self._on_mesh])
        self._solver.set_handles(
            on_mesh if len(self._on_mesh) else None,
            triangles[self._on_lattice] - self._first if len(self._on_lattice) else None,
            weights=weights[self._on_mesh] if len(self._on_mesh) else None,
        )

    def move(self, targets: Array) -> Array:
        """Some steps towards k x 3 targets; positions."""
        on_mesh, on_lattice = (self._into(targets[rows]) for rows in (self._on_mesh, self._on_lattice))
        self._solver.solve(on_mesh if len(on_mesh) else None, on_lattice if len(on_lattice) else None)
        return self.positions

    def refine(self, *, progress: Progress | None = None) -> Array:
        """Closer to the last targets; positions. It is too quick to be asked about."""
        self._solver.refine()
        return self.positions

    def settle(self, *, progress: Progress | None = None) -> Array:
        """To the pose that belongs to the last targets; positions."""
        self._solver.settle()
        return self.positions

    @property
    def positions(self) -> Array:
        """Where everything is."""
        solved = np.concatenate([self._solver.positions, self._solver.points])
        if self._flat:
            return np.column_stack([solved, self._start[:, 2]])
        return mapped(solved, self._axes)

    def _into(self, places: Array) -> Array:
        """k x 3 columns of positions as the solver has them."""
        return places[:, :2] if self._flat else mapped(places, np.ascontiguousarray(self._axes.T))


def posed_cutout(rest: Array, triangles: Indices, parts: Indices, count: int, *, flat: bool) -> Cutout:
    """What pins hold: (n + N) x 3 rest positions, of which the last `count` are the lattice's points.

    Each of those is a triangle of no size as well, behind the others, and a part, so that pins hold it as
    they hold vertices. `parts` (n,) are those of the vertices.
    """
    own = np.arange(len(rest) - count, len(rest), dtype=np.int32)
    of_points = np.arange(count, dtype=np.int32) + int(parts.max(initial=-1)) + 1
    corners = np.concatenate([triangles, np.repeat(own[:, None], 3, axis=1)])
    every_part = np.concatenate([parts, of_points]).astype(np.int32)
    return Cutout(rest, corners, every_part, diagonal_of(rest[: len(rest) - count]), flat=flat)
