# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of how well and how fast "hold" poses characters, beside AKVF and libigl's SLIM and ARAP."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from figures_conditions import Conditions
from figures_data import Pose, Shape, spread
from figures_peers import arap_seconds, energy, slim_in_increments, slim_iterations, slim_seconds

import planar_native

PIN_WEIGHT = 1000.0  # of "hold" and SLIM wherever both minimise one energy
MOVES = 20  # of a straight drag
LOOP_MOVES = 48
ROUNDS = 3  # of the timings; the median counts

MARGIN = 1.005  # of the distortion of the prototype and of SLIM
FURTHEST = 1e-3  # of the diagonal: handles from their targets, vertices from where a loop began
FASTER_THAN_SLIM = 5.0
FASTER_THAN_ARAP = 1.0

DISTORTION = f"""\
Distortion: area / angle (2 is none), flips as float32, furthest handle in diagonals. At most {MARGIN} times
the sum of the prototype and of SLIM (ten increments, pin weight {PIN_WEIGHT:g})."""
LOOP_DRIFT = f"""\
Closed loops of one handle, the others fixed, {LOOP_MOVES} moves and a settle: the furthest vertex from
where it was, in diagonals. At most {FURTHEST:g} with hold. No loop goes round another handle: that would wind
the drawing up around it."""
SETTLING = f"""\
One jump of the handles from the rest shape, ms; medians of {ROUNDS} rounds that take turns.
settled: hold's move and settle. To value: hold's moves until the energy (pin weight {PIN_WEIGHT:g}) is that
of settle + 0.1 %, or where SLIM stays above it; SLIM: the same. ARAP (hard handles): until no coordinate
moves by more than 1e-4 of the diagonal in an iteration. Nobody's preparation for these handles is counted."""


def poser_for(shape: Shape, pose: Pose, method: str, pin_weight: float | None = None) -> planar_native.Poser:
    poser = planar_native.Poser(shape.rest, shape.triangles, method=method, pin_weight=pin_weight)
    poser.set_handles(pose.handles)
    return poser


def dragged(shape: Shape, pose: Pose, moves: int) -> np.ndarray:
    """The shape after `moves` equal steps of the handles straight to their targets, and a settle."""
    poser = poser_for(shape, pose, "hold")
    start = shape.rest[pose.handles]
    for step in range(1, moves + 1):
        poser.move(start + (pose.targets - start) * step / moves)
    return poser.settle()


def distortion_table(shapes: list[Shape]) -> bool:
    print(DISTORTION)
    print(
        f"{'pose':13} {'prototype':>13}  {'SLIM':>28}  {f'hold, {MOVES} moves':>28}  {'hold, one jump':>28}"
    )
    conditions = Conditions()

    def measured(shape: Shape, pose: Pose, posed: np.ndarray) -> tuple[float, int, float, str]:
        if not np.isfinite(posed).all():
            return float("inf"), len(shape.triangles), float("inf"), f"{'not finite':>28}"
        found = planar_native.distortion(shape.rest, posed, shape.triangles)
        error = float(np.abs(posed[pose.handles] - pose.targets).max()) / shape.diagonal
        text = f"{found.area:6.3f} /{found.angle:6.3f} {found.flipped:4} {error:8.5f}"
        return found.area + found.angle, found.flipped, error, text

    for shape in shapes:
        for pose in shape.poses:
            slim, slim_flips, _, slim_text = measured(
                shape, pose, slim_in_increments(shape, pose, PIN_WEIGHT)
            )
            limits = {"SLIM": slim} if slim_flips == 0 else {}
            known = f"{'-':>13}"
            if pose.prototype:
                limits["the prototype"] = sum(pose.prototype)
                known = f"{pose.prototype[0]:.3f} / {pose.prototype[1]:.3f}"
            texts = []
            for way, moves in (("moves", MOVES), ("one jump", 1)):
                total, flips, error, text = measured(shape, pose, dragged(shape, pose, moves))
                texts.append(text)
                name = f"{pose.name}, {way}"
                conditions.check(f"{name}: {flips} flips", flips == 0)
                conditions.check(f"{name}: a handle is {error:.5f} off", error <= FURTHEST)
                for peer, limit in limits.items():
                    conditions.check(
                        f"{name}: distortion {total / limit:.4f} times that of {peer}",
                        total <= MARGIN * limit,
                    )
            print(f"{pose.name:13} {known}  {slim_text}  {texts[0]}  {texts[1]}", flush=True)
    return conditions.conclude()


# Closed curves of the parameter 0..1 that begin and end at the origin, about one unit across.
LOOPS: dict[str, Callable[[float], tuple[float, float]]] = {
    "circle": lambda s: ((1 - np.cos(2 * np.pi * s)) / 2, np.sin(2 * np.pi * s) / 2),
    "triangle": lambda s: (
        float(np.interp(s, [0, 1 / 3, 2 / 3, 1], [0, 1, 0.5, 0])),
        float(np.interp(s, [0, 1 / 3, 2 / 3, 1], [0, 0, 0.87, 0])),
    ),
    "figure eight": lambda s: (np.sin(2 * np.pi * s) / 2, np.sin(4 * np.pi * s) / 2),
}
SIZES = (0.15, 0.25, 1 / 3)  # of the diagonal, one a loop


def clear_loop(
    shape: Shape, handles: np.ndarray, first: int, curve: Callable[[float], tuple[float, float]], size: float
) -> tuple[int, np.ndarray]:
    """A handle, `first` if possible, and its path along the curve (LOOP_MOVES x 2), turned such that it goes
    round no other handle."""
    way = (
        np.array([curve(step / LOOP_MOVES) for step in range(LOOP_MOVES + 1)])
        @ [1, 1j]
        * size
        * shape.diagonal
    )
    places = shape.rest[handles] @ [1, 1j]
    for moving in np.roll(np.arange(len(handles)), -first):
        for turn in np.exp(2j * np.pi * np.arange(8) / 8):
            path = places[moving] + turn * way
            seen = path[:, None] - np.delete(places, moving)
            windings = np.angle(seen[1:] / seen[:-1]).sum(axis=0)
            lobes = np.angle(seen[1 : LOOP_MOVES // 2 + 1] / seen[: LOOP_MOVES // 2]).sum(axis=0)
            if (np.abs(windings) < 1).all() and (np.abs(lobes) < np.pi).all():
                return int(moving), np.column_stack([path.real, path.imag])[1:]
    raise ValueError(f"{shape.name}: every {size:.2f} diagonals wide loop goes round a handle")


def drift(shape: Shape, handles: np.ndarray, path: list[np.ndarray], method: str) -> float:
    """The furthest vertex from where it was before the handles went along the path, after a settle."""
    poser = poser_for(shape, Pose(shape.name, handles, path[-1]), method)
    for targets in path:
        poser.move(targets)
    posed = poser.settle()
    return float(np.linalg.norm(posed - shape.rest, axis=1).max()) / shape.diagonal


def loop_table(shapes: list[Shape]) -> bool:
    print(LOOP_DRIFT)
    print(f"{'character':14} {'loop':13} {'handle':>6} {'size':>6} {'hold':>10} {'AKVF':>10}")
    conditions = Conditions()
    for shape in shapes:
        handles = shape.poses[0].handles if shape.poses else spread(shape, 5)
        for number, ((name, curve), size) in enumerate(zip(LOOPS.items(), SIZES, strict=True)):
            moving, places = clear_loop(shape, handles, number % len(handles), curve, size)
            path = [shape.rest[handles] for _ in places]
            for targets, place in zip(path, places, strict=True):
                targets[moving] = place
            path[-1] = shape.rest[handles]
            held, killing = (drift(shape, handles, path, method) for method in ("hold", "akvf"))
            conditions.check(f"{shape.name}, {name}: {held:.5f} off", held <= FURTHEST)
            print(
                f"{shape.name:14} {name:13} {moving:6} {size:6.2f} {held:10.2e} {killing:10.2e}", flush=True
            )
    return conditions.conclude()


def settle_table(shapes: list[Shape]) -> bool:
    print(SETTLING)
    print(
        f"{'pose':14} {'vertices':>8} {'settled':>9} {'to value':>9} {'SLIM':>9} {'ARAP':>9} "
        f"{'SLIM/settled':>13} {'SLIM/value':>11} {'ARAP/settled':>13}"
    )
    conditions = Conditions()
    for shape in shapes:
        for pose in shape.poses:
            poser = poser_for(shape, pose, "hold", PIN_WEIGHT)
            poser.move(pose.targets)
            settled = energy(shape, poser.settle(), pose, PIN_WEIGHT)
            iterations, reached = slim_iterations(shape, pose, PIN_WEIGHT, 1.001 * settled)
            value = max(1.001 * settled, reached)
            poser.reset()
            moves = 1
            while energy(shape, poser.move(pose.targets), pose, PIN_WEIGHT) > value and moves < 200:
                moves += 1

            def seconds(finish: Callable[[], object], poser=poser, pose=pose) -> float:
                poser.reset()
                start = time.perf_counter()
                poser.move(pose.targets)
                finish()
                return time.perf_counter() - start

            def to_value(poser=poser, pose=pose, moves=moves) -> None:
                for _ in range(moves - 1):
                    poser.move(pose.targets)

            rounds = [
                (
                    seconds(poser.settle),
                    seconds(to_value),
                    slim_seconds(shape, pose, PIN_WEIGHT, iterations),
                    arap_seconds(shape, pose),
                )
                for _ in range(ROUNDS)
            ]
            whole, part, slim, arap = (1000 * statistics.median(times) for times in zip(*rounds, strict=True))
            conditions.check(
                f"{pose.name}: {slim / part:.1f} times as fast as SLIM", slim >= FASTER_THAN_SLIM * part
            )
            conditions.check(
                f"{pose.name}: {arap / whole:.2f} times as fast as ARAP", arap > FASTER_THAN_ARAP * whole
            )
            print(
                f"{pose.name:14} {len(shape.rest):8} {whole:9.1f} {part:9.1f} {slim:9.1f} {arap:9.1f} "
                f"{slim / whole:13.1f} {slim / part:11.1f} {arap / whole:13.2f}",
                flush=True,
            )
    return conditions.conclude()
