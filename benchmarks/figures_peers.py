# SPDX-License-Identifier: GPL-3.0-or-later
"""libigl's SLIM and ARAP on planar meshes, for comparison, and the energy that SLIM and "hold" share."""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Iterator

import igl
import numpy as np
from figures_data import Pose, Shape


def energy(shape: Shape, posed: np.ndarray, pose: Pose, pin_weight: float) -> float:
    """sum_t A (|J|^2 + |1/J|^2) + pin_weight * sum |x_p - target|^2; infinite where a triangle is flipped."""
    rest, now = (points[shape.triangles] for points in (shape.rest, posed))
    edges = np.stack([rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]], axis=2)
    jacobian = np.stack([now[:, 1] - now[:, 0], now[:, 2] - now[:, 0]], axis=2) @ np.linalg.inv(edges)
    area = np.abs(np.linalg.det(edges)) / 2
    det = np.linalg.det(jacobian)
    if not (det > 0).all():
        return float("inf")
    squares = (jacobian**2).sum(axis=(1, 2))
    pins = ((posed[pose.handles] - pose.targets) ** 2).sum()
    return float((area * (squares + squares / det**2)).sum() + pin_weight * pins)


class Slim:
    """SLIM (Rabinovich et al. 2017) with soft handles, which minimises `energy`."""

    def __init__(self, shape: Shape, start: np.ndarray, pose: Pose, pin_weight: float) -> None:
        self._data = igl.slim_precompute(
            np.asfortranarray(np.column_stack([shape.rest, np.zeros(len(shape.rest))])),
            np.asfortranarray(shape.triangles, dtype=np.int32),
            np.asfortranarray(start),
            igl.MappingEnergyType.SYMMETRIC_DIRICHLET,
            pose.handles.astype(np.int32),
            np.asfortranarray(pose.targets),
            pin_weight,
        )

    def iterate(self, count: int) -> np.ndarray:
        return np.ascontiguousarray(igl.slim_solve(self._data, count)[:, :2])


def slim_in_increments(shape: Shape, pose: Pose, pin_weight: float) -> np.ndarray:
    """The way SLIM is led to a far pose: ten straight increments of the handles, ten iterations each."""
    posed = shape.rest
    for step in range(1, 11):
        way = (pose.targets - shape.rest[pose.handles]) * step / 10
        here = Pose(pose.name, pose.handles, shape.rest[pose.handles] + way)
        posed = Slim(shape, posed, here, pin_weight).iterate(10)
    return posed


def slim_iterations(shape: Shape, pose: Pose, pin_weight: float, value: float) -> tuple[int, float]:
    """How many iterations from the rest shape bring the energy to `value`, and what it then is; fewer if it
    stays above and gains less than 1e-5 in five iterations."""
    slim = Slim(shape, shape.rest, pose, pin_weight)
    reached: list[float] = []
    while len(reached) < 200:
        reached.append(energy(shape, slim.iterate(1), pose, pin_weight))
        if reached[-1] <= value or (len(reached) > 5 and reached[-6] - reached[-1] < 1e-5 * reached[-1]):
            break
    return len(reached), reached[-1]


def slim_seconds(shape: Shape, pose: Pose, pin_weight: float, iterations: int) -> float:
    """Wall time of that many iterations; what SLIM prepares once per set of handles is not counted."""
    slim = Slim(shape, shape.rest, pose, pin_weight)
    start = time.perf_counter()
    slim.iterate(iterations)
    return time.perf_counter() - start


def _arap_iterations(shape: Shape, pose: Pose) -> Iterator[tuple[float, np.ndarray]]:
    """Wall time and result of each iteration of local/global ARAP in the plane with hard handles, from the
    rest shape; its factorization is not counted."""
    data = igl.ARAPData()
    igl.arap_precomputation(shape.rest, shape.triangles, 2, pose.handles.astype(np.int32), data)
    data.max_iter = 1
    posed = shape.rest
    while True:
        start = time.perf_counter()
        posed = igl.arap_solve(pose.targets, data, posed)
        yield time.perf_counter() - start, posed


def arap_seconds(shape: Shape, pose: Pose) -> float:
    """Wall time of ARAP's iterations until one moves no coordinate by more than 1e-4 of the diagonal."""
    before, total = shape.rest, 0.0
    for seconds, posed in itertools.islice(_arap_iterations(shape, pose), 1000):
        total += seconds
        if np.abs(posed - before).max() <= 1e-4 * shape.diagonal:
            break
        before = posed
    return total


def arap_iteration_seconds(shape: Shape, pose: Pose) -> float:
    """Median wall time of ARAP's first five iterations."""
    return statistics.median(seconds for seconds, _ in itertools.islice(_arap_iterations(shape, pose), 5))
