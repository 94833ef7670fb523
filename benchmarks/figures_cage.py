# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of posing dense drawings through a cage: how far from the dense solution, and how long it takes."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from figures_conditions import Conditions
from figures_data import Pose, Shape, read_shape
from figures_posing import MOVES, dragged

import planar_native

CAGE = 4000
ROUNDS = 5  # of the timings; the median counts
OWN = Path(__file__).resolve().parents[1] / "tests" / "native" / "data"
DENSE = 100_000  # vertices, about
FURTHEST = 0.005  # of the diagonal

DIFFERENCE = f"""\
Cage of {CAGE} vertices, characters refined to {DENSE // 2} vertices at least, {MOVES} moves and a settle.
worst, mean: from the dense solution, in % of the diagonal. from here: from the minimum that the dense solver
finds when it starts where the cage ends: poses have several minima beside each other (at a pin a fold falls
this way or that), and each way may end in another. Distortion: area / angle; flips as float32."""
TIMES = f"""\
ms, medians of {ROUNDS}: a square with three pins. build: the Poser; press: set_handles, reset to a stored
pose and the first move; move: of a drag, in Python, result and all. dense: the same without a cage."""


def refined(shape: Shape) -> Shape:
    """Each triangle cut into four; the first vertices are the shape's own."""
    sides = np.sort(shape.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, row = np.unique(sides, axis=0, return_inverse=True)
    ab, bc, ca = (len(shape.rest) + row.reshape(-1, 3)).T
    a, b, c = shape.triangles.T
    triangles = np.column_stack([a, ab, ca, ab, b, bc, bc, c, ca, ab, bc, ca]).reshape(-1, 3)
    return Shape(
        shape.name, np.concatenate([shape.rest, shape.rest[edges].mean(axis=1)]), triangles, shape.poses
    )


def square(side: int) -> Shape:
    x, y = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    corner = (np.arange(side - 1) + side * np.arange(side - 1)[:, None]).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + side]),
            np.column_stack([corner + 1, corner + side + 1, corner + side]),
        ]
    )
    rest = np.column_stack([x.ravel(), y.ravel()])
    pins = np.array(
        [side * (side // 4) + side // 4, side * (side // 4) + 3 * side // 4, side * side - side // 3]
    )
    targets = rest[pins] + [[0, 0], [0.05, 0.1], [-0.1, 0.05]]
    return Shape(f"{side}x{side}", rest, triangles, [Pose("square", pins, targets)])


def posed_through_cage(shape: Shape, pose: Pose) -> tuple[np.ndarray, planar_native.Poser]:
    poser = planar_native.Poser(shape.rest, shape.triangles, cage=CAGE)
    poser.set_handles(pose.handles)
    start = shape.rest[pose.handles]
    for step in range(1, MOVES + 1):
        poser.move(start + (pose.targets - start) * step / MOVES)
    return poser.settle(), poser


def off(a: np.ndarray, b: np.ndarray, shape: Shape) -> str:
    """Worst and mean distance, in % of the diagonal."""
    distance = 100 * np.linalg.norm(a - b, axis=1) / shape.diagonal
    return f"{distance.max():6.2f} {distance.mean():6.3f}"


def difference(shapes: list[Shape], conditions: Conditions) -> None:
    print(DIFFERENCE)
    head = f"{'pose':12}{'vertices':>9} {'worst':>6} {'mean':>6}   {'from here':>13}"
    print(f"{head}   {'dense':>14} {'cage':>14} flips")
    for coarse in shapes:
        shape = coarse
        while len(shape.rest) < DENSE / 2:
            shape = refined(shape)
        for pose in shape.poses:
            solved = dragged(shape, pose, MOVES)
            posed, poser = posed_through_cage(shape, pose)
            near = planar_native.Poser(shape.rest, shape.triangles)
            near.set_handles(pose.handles)
            near.reset(posed)
            near.move(pose.targets)
            here = near.settle()
            known = planar_native.distortion(shape.rest, solved, shape.triangles)
            found = planar_native.distortion(shape.rest, posed, shape.triangles)
            text = (
                f"{pose.name:12}{len(shape.rest):9} {off(posed, solved, shape)}   {off(posed, here, shape)}"
            )
            text += f"   {known.area:6.3f} /{known.angle:6.3f} {found.area:6.3f} /{found.angle:6.3f}"
            print(f"{text} {found.flipped:5}", flush=True)
            worst = np.linalg.norm(posed - here, axis=1).max() / shape.diagonal
            conditions.check(f"{pose.name}: {100 * worst:.2f} % from the dense minimum", worst <= FURTHEST)
            conditions.check(f"{pose.name}: {found.flipped} flips", found.flipped == 0)
            conditions.check(f"{pose.name}: not converged", poser.report.converged)


def median_ms(action: Callable[[], object]) -> float:
    seconds = []
    for _round in range(ROUNDS):
        start = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - start)
    return 1000 * statistics.median(seconds)


def timed(shape: Shape, cage: int | None) -> tuple[float, float, float]:
    """ms of building, of a press and of a move."""
    pose = shape.poses[0]

    def built() -> planar_native.Poser:
        return planar_native.Poser(shape.rest, shape.triangles, cage=cage)

    building = median_ms(built)
    poser = built()
    poser.set_handles(pose.handles)
    start = shape.rest[pose.handles]
    stored = poser.move(start + 0.1 * (pose.targets - start)).astype(np.float32)
    others = [built() for _round in range(ROUNDS)]

    def press() -> None:
        other = others.pop()
        other.set_handles(pose.handles)
        other.reset(stored)
        other.move(start + 0.1 * (pose.targets - start))

    pressing = median_ms(press)
    moves = []
    for step in range(1, MOVES + 1):
        began = time.perf_counter()
        poser.move(start + (pose.targets - start) * step / MOVES)
        moves.append(time.perf_counter() - began)
    return building, pressing, 1000 * statistics.median(moves)


def cage_table(shapes: list[Shape]) -> bool:
    conditions = Conditions()
    own = [read_shape(OWN / f"{name}.obj") for name in ("fox", "dragon")]
    difference([*(shape for shape in shapes if shape.poses), *own], conditions)
    print()
    print(TIMES)
    print(f"{'vertices':>9} {'build':>8} {'press':>8} {'move':>8}   {'dense':>26}")
    moves = {}
    for side in (316, 1000):
        shape = square(side)
        build, press, moves[side] = timed(shape, CAGE)
        dense = " ".join(f"{ms:8.1f}" for ms in timed(shape, None)) if side < 1000 else ""
        print(f"{side * side:9} {build:8.1f} {press:8.1f} {moves[side]:8.1f}   {dense}", flush=True)
    growth = np.log(moves[1000] / moves[316]) / np.log(1000**2 / 316**2)
    print(f"growth of a move: n^{growth:.2f}")
    conditions.check(f"a move at 100k takes {moves[316]:.1f} ms", moves[316] <= 12)
    conditions.check(f"a move at 1M takes {moves[1000]:.1f} ms", moves[1000] <= 60)
    conditions.check(f"a move grows by n^{growth:.2f}", growth <= 1.1)
    return conditions.conclude()
