# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of posing dense drawings through a cage: how far from the dense solution, and how long it takes."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from figures_cholmod import bare_factorization
from figures_conditions import Conditions
from figures_data import Pose, Shape, read_shape
from figures_posing import dragged

import planar_native

CAGE = 4000
STEPS = 30  # of a drag, as a mouse makes them
REFINEMENTS = 100  # at most, as the add-on makes them
MESH_REFINEMENTS = 20  # of those, on the mesh itself
OWN = Path(__file__).resolve().parents[1] / "tests" / "native" / "data"
FURTHEST = 0.005  # of the diagonal
JUMP = 1e-4  # of the diagonal: what a press may move that moves no pin
# Vertices of the cage and, at least, of the characters, and poses: one of each character and those that are
# known to be hard, and two as dense as one may be solved itself in a minute. All of them: cage_poses.py.
SETS = (
    (1500, 15_000, ("fox 0", "dragon 0", "elephant 0", "giraffe 0", "horse 4", "racoon 0", "racoon 1")),
    (CAGE, 50_000, ("fox 0", "racoon 1")),
)

DIFFERENCE = f"""\
Characters refined, {STEPS} moves and what refinements there are, as a release does. In % of the diagonal,
worst and mean.
shown: what the drag has come to on the cage, from where the mesh's own steps then take it. pin: of the worst
vertex from the nearest pin. end: from the dense solver led along the same way, and settled. way: how far that
one is from itself led there in one jump; where that is much, the pose has several minima beside each other
(at a pin a fold falls this way or that), and neither is the one; nor is the dense one where the drawing ends
less distorted than it (dense, cage: mean area and angle). press: what moves when the settled drawing,
stored as float32, is taken hold of by another object, and no pin moves. s: of the refinements."""
TIMES = """\
ms, medians: a square with three pins. build: the Poser; press: set_handles, reset to a stored pose and the
first move; move: of a drag, in Python, result and all. dense: the same without a cage. bare: a factorization
by CHOLMOD of a matrix with the pattern of the dense mesh's."""


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


def released(poser: planar_native.Poser) -> np.ndarray:
    """What the add-on refines after a drag, on the cage and on the mesh."""
    on_mesh = 0
    for _refinement in range(REFINEMENTS):
        if poser.report.converged or on_mesh == MESH_REFINEMENTS:
            break
        on_mesh += poser.report.coarse_settled
        poser.refine()
    return poser.positions


def distances(a: np.ndarray, b: np.ndarray, shape: Shape) -> np.ndarray:
    """In % of the diagonal."""
    return 100 * np.linalg.norm(a - b, axis=1) / shape.diagonal


def difference(shapes: list[Shape], conditions: Conditions) -> None:
    print(DIFFERENCE)
    head = f"{'pose':12}{'vertices':>9} {'cage':>5}   {'shown':>13} {'pin':>5}   {'end':>13}   {'way':>13}"
    print(f"{head}  {'press':>6}   {'dense':>14} {'cage':>14} flips {'s':>5}")
    for cage, least, names in SETS:
        for coarse in shapes:
            poses = [pose for pose in coarse.poses if pose.name in names]
            shape = coarse
            while poses and len(shape.rest) < least:
                shape = refined(shape)
            for pose in poses:
                compare(shape, pose, cage, conditions)


def compare(shape: Shape, pose: Pose, cage: int, conditions: Conditions) -> None:
    solved, jumped = (dragged(shape, pose, steps) for steps in (STEPS, 1))
    poser = planar_native.Poser(shape.rest, shape.triangles, cage=cage)
    poser.set_handles(pose.handles)
    start = shape.rest[pose.handles]
    for step in range(1, STEPS + 1):
        poser.move(start + (pose.targets - start) * step / STEPS)
    while not (poser.report.converged or poser.report.coarse_settled):
        poser.refine()
    shown = poser.positions
    began = time.perf_counter()
    posed = released(poser)
    seconds = time.perf_counter() - began
    other = planar_native.Poser(shape.rest, shape.triangles, cage=cage)
    other.set_handles(pose.handles)
    stored = posed.astype(np.float32)
    other.reset(stored)
    press = distances(other.move(pose.targets), stored, shape).max()

    known = planar_native.distortion(shape.rest, solved, shape.triangles)
    found = planar_native.distortion(shape.rest, posed, shape.triangles)
    on_way, end, way = (
        distances(*pair, shape) for pair in ((shown, posed), (posed, solved), (jumped, solved))
    )
    worst = shape.rest[np.argmax(on_way)]
    pin = 100 * np.linalg.norm(shape.rest[pose.handles] - worst, axis=1).min() / shape.diagonal
    text = f"{pose.name:12}{len(shape.rest):9} {cage:5}   {on_way.max():6.2f} {on_way.mean():6.3f} {pin:5.1f}"
    text += f"   {end.max():6.2f} {end.mean():6.3f}   {way.max():6.2f} {way.mean():6.3f}  {press:6.3f}"
    text += f"   {known.area:6.3f} /{known.angle:6.3f} {found.area:6.3f} /{found.angle:6.3f}"
    print(f"{text} {found.flipped:5} {seconds:5.1f}", flush=True)
    if way.max() <= 100 * FURTHEST and found.area + found.angle >= known.area + known.angle:
        conditions.check(f"{pose.name}: {end.max():.2f} % from dense", end.max() <= 100 * FURTHEST)
    conditions.check(f"{pose.name}: a press moves {press:.3f} %", press <= 100 * JUMP)
    conditions.check(f"{pose.name}: {found.flipped} flips", found.flipped == 0)
    conditions.check(f"{pose.name}: not converged", poser.report.converged)


def median_ms(action: Callable[[], object], rounds: int) -> float:
    seconds = []
    for _round in range(rounds):
        start = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - start)
    return 1000 * statistics.median(seconds)


def timed(shape: Shape, cage: int | None, rounds: int) -> tuple[float, float, float]:
    """ms of building, of a press and of a move."""
    pose = shape.poses[0]

    def built() -> planar_native.Poser:
        return planar_native.Poser(shape.rest, shape.triangles, cage=cage)

    building = median_ms(built, rounds)
    poser = built()
    poser.set_handles(pose.handles)
    start = shape.rest[pose.handles]
    stored = poser.move(start + 0.1 * (pose.targets - start)).astype(np.float32)
    others = [built() for _round in range(rounds)]

    def press() -> None:
        other = others.pop()
        other.set_handles(pose.handles)
        other.reset(stored)
        other.move(start + 0.1 * (pose.targets - start))

    pressing = median_ms(press, rounds)
    moves = []
    for step in range(1, STEPS + 1):
        began = time.perf_counter()
        poser.move(start + (pose.targets - start) * step / STEPS)
        moves.append(time.perf_counter() - began)
    return building, pressing, 1000 * statistics.median(moves)


def cage_table(shapes: list[Shape]) -> bool:
    conditions = Conditions()
    own = [read_shape(OWN / f"{name}.obj") for name in ("fox", "dragon")]
    difference([*(shape for shape in shapes if shape.poses), *own], conditions)
    print()
    print(TIMES)
    print(f"{'vertices':>9} {'build':>8} {'press':>8} {'move':>8}   {'dense':>26}   {'bare':>8}")
    moves = {}
    for side, rounds in ((316, 5), (1000, 3)):
        shape = square(side)
        build, press, moves[side] = timed(shape, CAGE, rounds)
        text = f"{side * side:9} {build:8.1f} {press:8.1f} {moves[side]:8.1f}"
        if side < 1000:
            dense = " ".join(f"{ms:8.1f}" for ms in timed(shape, None, 1))
            text += f"   {dense}   {1000 * bare_factorization(len(shape.rest), shape.triangles):8.1f}"
        print(text, flush=True)
    growth = np.log(moves[1000] / moves[316]) / np.log(1000**2 / 316**2)
    print(f"growth of a move: n^{growth:.2f}")
    conditions.check(f"a move at 100k takes {moves[316]:.1f} ms", moves[316] <= 12)
    conditions.check(f"a move at 1M takes {moves[1000]:.1f} ms", moves[1000] <= 60)
    conditions.check(f"a move grows by n^{growth:.2f}", growth <= 1.1)
    return conditions.conclude()
