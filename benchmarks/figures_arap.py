# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of what the methods make of the same handles, in the manner of [AKVF] Table 1 (whose pins and meshes
are not published), and how fast ARAP's two steps are beside libigl's iterations."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from figures_data import Pose, Shape, arc_targets, bent_bar, half_split, read_shape
from figures_peers import arap_iteration_seconds, arap_seconds

import planar_native

OWN = Path(__file__).resolve().parents[1] / "tests" / "native" / "data"
MOVES = 20
ROUNDS = 5  # of the timings; the median counts
COLUMNS, ROWS = 50, 10  # of the plain bar, five times as long as high
SIZES = ((159, 31), (223, 44), (707, 141))  # cells of bars of 5k, 10k, 100k vertices

DISTORTION = f"""\
Methods: area / angle (2 is none), flips as float32, ms. ARAP: the two steps in one jump, and from there to
convergence; AKVF and hold: {MOVES} moves and a settle. The bar is 5 x 1, both ends clamped."""
SPEED = f"""\
ARAP on a bar bent by 90 degrees, ms, medians of {ROUNDS}. Compile: handles to factors; deform: one move, both
steps. libigl: one local/global iteration, and all of them from the rest until no coordinate moves by more
than 1e-4 of the diagonal; its factorization is not counted."""

SPLIT = """\
How far the pose of the same handles changes, in % of the diagonal, where the left half of the mesh has its
triangles cut into four."""

HandlePath = Callable[[float], np.ndarray]


def _bar_poses() -> list[tuple[Shape, str, np.ndarray, HandlePath]]:
    bar = bent_bar(COLUMNS, ROWS)
    handles = bar.poses[0].handles

    def bent(degrees: float) -> HandlePath:
        return lambda share: arc_targets(bar.rest, handles, COLUMNS, ROWS, share * degrees)

    return [(bar, f"bar {degrees} deg", handles, bent(degrees)) for degrees in (90, 180)]


def _straight_poses(shapes: list[Shape]) -> list[tuple[Shape, str, np.ndarray, HandlePath]]:
    def straight(start: np.ndarray, end: np.ndarray) -> HandlePath:
        return lambda share: start + share * (end - start)

    return [
        (shape, pose.name, pose.handles, straight(shape.rest[pose.handles], pose.targets))
        for shape in shapes
        for pose in shape.poses
    ]


def _posed(shape: Shape, method: str, handles: np.ndarray, path: HandlePath, moves: int, settle: bool) -> str:
    poser = planar_native.Poser(shape.rest, shape.triangles, method=method)
    poser.set_handles(handles)
    start = time.perf_counter()
    for step in range(1, moves + 1):
        posed = poser.move(path(step / moves))
    if settle:
        posed = poser.settle()
    seconds = time.perf_counter() - start
    found = planar_native.distortion(shape.rest, posed, shape.triangles)
    finite = found.area + found.angle < 1e4
    means = f"{found.area:6.3f} /{found.angle:6.3f}" if finite else f"{'collapsed':>14}"
    return f"{means} {found.flipped:4} {1e3 * seconds:7.1f}"


def _settled(shape: Shape, pose: Pose) -> np.ndarray:
    poser = planar_native.Poser(shape.rest, shape.triangles)
    poser.set_handles(pose.handles)
    poser.move(pose.targets)
    return poser.settle()


def _split_table(shapes: list[Shape]) -> None:
    print(f"\n{SPLIT}")
    ways: dict[str, Callable[[Shape, Pose], np.ndarray]] = {
        f"ARAP, two steps, {weights}": lambda shape, pose, weights=weights: planar_native.arap_two_step(
            shape.rest, shape.triangles, pose.handles, pose.targets, weights=weights
        )[1]
        for weights in ("cotangent", "uniform")
    }
    both = [(shape, half_split(shape)) for shape in shapes]
    for name, way in (ways | {"hold": _settled}).items():
        off = [
            100
            * np.linalg.norm(way(shape, pose) - way(split, pose)[: len(shape.rest)], axis=1).max()
            / shape.diagonal
            for shape, split in both
            for pose in shape.poses
        ]
        print(
            f"{name:27} median {statistics.median(off):6.2f}, worst {max(off):6.2f}, of {len(off)}",
            flush=True,
        )


def _median(call: Callable[[int], object]) -> float:
    def seconds(round_: int) -> float:
        start = time.perf_counter()
        call(round_)
        return time.perf_counter() - start

    return statistics.median(seconds(i) for i in range(ROUNDS))


def _speed(columns: int, rows: int) -> None:
    bar = bent_bar(columns, rows)
    pose = bar.poses[0]
    poser = planar_native.Poser(bar.rest, bar.triangles, method="arap")
    poser.set_handles(pose.handles)

    def compile_and_deform(_: int) -> None:
        poser.set_handles(pose.handles)
        poser.move(pose.targets)

    compiled = _median(compile_and_deform)
    deform = _median(lambda i: poser.move(pose.targets + 1e-3 * i))
    iteration = arap_iteration_seconds(bar, pose)
    whole = f"{1e3 * arap_seconds(bar, pose):9.0f}" if len(bar.rest) < 20000 else f"{'-':>9}"
    print(
        f"{len(bar.rest):8} {1e3 * (compiled - deform):9.1f} {1e3 * deform:8.2f} "
        f"{1e3 * iteration:16.2f} {whole}",
        flush=True,
    )


def arap_table(shapes: list[Shape]) -> bool:
    own = [read_shape(path) for path in sorted(OWN.glob("*.obj"))]
    print(DISTORTION)
    print(f"{'pose':13} {'ARAP, two steps':>27}  {'ARAP, converged':>27}  {'AKVF':>27}  {'hold':>27}")
    for shape, name, handles, path in [*_bar_poses(), *_straight_poses([*own, *shapes])]:
        texts = [
            _posed(shape, "arap", handles, path, 1, False),
            _posed(shape, "arap", handles, path, 1, True),
            _posed(shape, "akvf", handles, path, MOVES, True),
            _posed(shape, "hold", handles, path, MOVES, True),
        ]
        print(f"{name:13} " + "  ".join(texts), flush=True)
    _split_table([*own, *shapes])
    print(f"\n{SPEED}")
    print(f"{'vertices':>8} {'compile':>9} {'deform':>8} {'libigl iteration':>16} {'whole':>9}")
    for columns, rows in SIZES:
        _speed(columns, rows)
    print(flush=True)
    return True  # nothing here is a promise
