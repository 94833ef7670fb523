# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of how lattices pose characters: plain least-squares FFD, the paper's form, and "hold"."""

from __future__ import annotations

import dataclasses

import numpy as np
from figures_conditions import Conditions
from figures_data import Pose, Shape

import planar_native

SIZES = (10, 14)
BASIS = "BSPLINE"

LATTICES = f"""\
Lattices, {BASIS}, one free cell on each side, one jump of the handles: area / angle distortion minus 2 as in
the paper's Table 1 (it has 0.116 / 0.147 on its own character at 10 x 10) and flips. FFD: least squares of
handles (100) and points at rest (0.01) alone. paper: as printed; following: with rigid_following and weights
by area. hold, and its steps and furthest handle in diagonals. hold flips nothing."""


@dataclasses.dataclass(frozen=True)
class Lattice:
    """A square lattice round a shape: points N x 2, and weights as the module gives and takes them."""

    points: np.ndarray
    weights: tuple[np.ndarray, np.ndarray, np.ndarray]

    @staticmethod
    def round(shape: Shape, size: int) -> Lattice:
        low, extent = shape.rest.min(axis=0), np.ptp(shape.rest, axis=0)
        spacing = extent / (size - 3) * (1 + 1e-9)
        origin = low + extent / 2 - spacing * (size - 1) / 2
        v, u = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
        points = origin + spacing * np.column_stack([u.ravel(), v.ravel()])
        weights = planar_native.lattice_weights(
            shape.rest, (size, size), (BASIS, BASIS), origin=origin, spacing=spacing
        )
        return Lattice(points, weights)

    def rows(self, vertices: np.ndarray) -> np.ndarray:
        starts, columns, values = self.weights
        result = np.zeros((len(vertices), len(self.points)))
        for row, vertex in enumerate(vertices):
            entries = slice(starts[vertex], starts[vertex + 1])
            result[row, columns[entries]] = values[entries]
        return result


def plain(shape: Shape, pose: Pose, lattice: Lattice) -> np.ndarray:
    """The shape with the points of a lattice solved for the handles alone, kept near rest [HHK92]."""
    rows = lattice.rows(pose.handles)
    matrix = 100.0 * rows.T @ rows + 0.01 * np.eye(len(lattice.points))
    moved = np.linalg.solve(matrix, 100.0 * rows.T @ (pose.targets - shape.rest[pose.handles]))
    return shape.rest + lattice.rows(np.arange(len(shape.rest))) @ moved


def lattice_table(shapes: list[Shape]) -> bool:
    print(LATTICES)
    methods = ("FFD", "paper", "following", "hold")
    conditions = Conditions()
    for size in SIZES:
        print(
            f"{f'{size} x {size}':13} "
            + " ".join(f"{name:>18}" for name in methods)
            + f" {'steps':>6} {'off':>8}"
        )
        totals: dict[str, list[tuple[float, float, bool]]] = {name: [] for name in methods}
        for shape in shapes:
            lattice = Lattice.round(shape, size)
            for pose in shape.poses:
                posed = {"FFD": plain(shape, pose, lattice)}
                for name, options in (
                    ("paper", {"rigid_following": False, "edge_weights": "uniform"}),
                    ("following", {"method": "paper"}),
                    ("hold", {}),
                ):
                    solver = planar_native.LatticeSolver(
                        shape.rest, shape.triangles, lattice.weights, lattice.points, **options
                    )
                    solver.set_handles(pose.handles)
                    solver.solve(pose.targets)
                    first = solver.report.iterations
                    solver.settle()
                    posed[name] = solver.positions
                texts = []
                for name in methods:
                    found = planar_native.distortion(shape.rest, posed[name], shape.triangles)
                    totals[name].append((found.area - 2, found.angle - 2, found.flipped > 0))
                    texts.append(f"{found.area - 2:7.3f}/{found.angle - 2:6.3f}{found.flipped:4}")
                report = solver.report
                off = report.furthest_handle / shape.diagonal
                print(
                    f"{pose.name:13} " + " ".join(texts) + f" {first + report.iterations:6} {off:8.5f}",
                    flush=True,
                )
                name = f"{pose.name} in {size} x {size}"
                conditions.check(f"{name}: {report.flipped} flips with hold", report.flipped == 0)
                conditions.check(f"{name}: hold did not settle", report.converged)
        print(
            f"{'median':13} "
            + " ".join(
                "{:7.3f}/{:6.3f}{:4}".format(
                    *np.median([t[:2] for t in rows], axis=0), sum(t[2] for t in rows)
                )
                for rows in totals.values()
            )
            + "  (flips: poses with any)\n"
        )
        hold, following = (np.sum([t[:2] for t in totals[name]]) for name in ("hold", "following"))
        conditions.check(f"{size} x {size}: hold distorts more than the paper's form", hold < following)
    return conditions.conclude()
