# SPDX-License-Identifier: GPL-3.0-or-later
"""What solving a lattice costs beside what Blender takes to show it.

    .venv/bin/python blender_tests/data/lattice_cost.py

Median ms of processor time, of all threads, in one run: Blender's own evaluation of the modifier after
its points have moved; a move of the mouse in the solver; and how many evaluations a move is worth.
"""

import statistics
import time
from collections.abc import Callable

import bpy
import numpy as np
from support import grid, make_object

import planar_native

MOVES = 20


def ball(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """A sphere of rows x 2 rows vertices, without its poles."""
    columns = 2 * rows
    a, b = np.meshgrid(2 * np.pi * np.arange(columns) / columns, np.pi * (np.arange(rows) + 0.5) / rows)
    vertices = np.stack([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), np.cos(b)], axis=-1).reshape(-1, 3)
    first = np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    right = np.roll(first, -1, axis=1)
    return vertices, np.stack([first, right, right + columns, first + columns], axis=-1).reshape(-1, 4)


def surrounding(obj: bpy.types.Object, counts: tuple[int, int, int]) -> bpy.types.Object:
    """A B-spline lattice about the object with a free cell on each side, as Fit Lattice makes it."""
    data = bpy.data.lattices.new("Lattice")
    data.points_u, data.points_v, data.points_w = counts
    data.interpolation_type_u = data.interpolation_type_v = data.interpolation_type_w = "KEY_BSPLINE"
    cage = bpy.data.objects.new("Lattice", data)
    low, high = (np.array(corner(obj.bound_box, axis=0)) for corner in (np.min, np.max))
    cage.location = (low + high) / 2
    cage.scale = [
        (h - lo) * (n - 1) / (n - 3) if n > 1 else 1.0 for lo, h, n in zip(low, high, counts, strict=True)
    ]
    bpy.context.scene.collection.objects.link(cage)
    obj.modifiers.new("Lattice", "LATTICE").object = cage
    bpy.context.view_layer.update()
    return cage


def milliseconds(call: Callable[[], object]) -> float:
    start = time.process_time()
    call()
    return 1e3 * (time.process_time() - start)


def measure(name: str, vertices: np.ndarray, quads: np.ndarray, counts: tuple[int, int, int]) -> None:
    obj = make_object(vertices, quads.tolist(), name=name)
    cage = surrounding(obj, counts)
    dimensions = 2 if counts[2] == 1 else 3
    inverse = np.array(cage.matrix_world.inverted())
    inside = (vertices @ inverse[:3, :3].T + inverse[:3, 3])[:, :dimensions]
    lattice = np.array([point.co for point in cage.data.points], float)[:, :dimensions]
    axes = counts[:dimensions]
    spacing = np.ptp(lattice, axis=0) / (np.array(axes) - 1)
    weights = planar_native.lattice_weights(
        inside, axes, ("BSPLINE",) * dimensions, origin=lattice.min(axis=0), spacing=spacing
    )
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    solver = planar_native.LatticeSolver(inside, triangles, weights, lattice)
    pins = np.array([0, len(inside) // 2, len(inside) - 1])
    solver.set_handles(pins)
    moves, shown = [], []
    for step in range(1, MOVES + 1):
        targets = inside[pins].copy()
        targets[-1, :2] += np.array([0.1, 0.05]) * step / MOVES
        moves.append(milliseconds(lambda targets=targets: solver.solve(targets)))
        points = np.zeros((len(lattice), 3), np.float32)
        points[:, :dimensions] = solver.points
        cage.data.points.foreach_set("co_deform", points.ravel())
        cage.data.update_tag()
        shown.append(milliseconds(bpy.context.view_layer.update))
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    found = np.empty(3 * len(seen), np.float32)
    seen.foreach_get("co", found)
    local = (found.reshape(-1, 3) @ inverse[:3, :3].T + inverse[:3, 3])[:, :dimensions]
    off = np.abs(local - solver.positions).max()
    assert off < 1e-4, f"Blender shows something else than was solved, by {off}"
    move, blender = statistics.median(moves), statistics.median(shown)
    print(f"{name:24}{len(vertices):9}{blender:10.2f}{move:10.2f}{move / blender:8.1f}", flush=True)
    bpy.data.objects.remove(obj)
    bpy.data.objects.remove(cage)


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    print(f"{'':24}{'vertices':>9}{'Blender':>10}{'move':>10}{'ratio':>8}")
    for side in (142, 317):
        vertices, quads = grid(side - 1, side - 1)
        measure("sheet, 14 x 14", vertices, np.array(quads), (14, 14, 1))
    measure("ball, 8 x 8 x 8", *ball(132), (8, 8, 8))
    measure("ball, 8 x 8 x 8", *ball(708), (8, 8, 8))


if __name__ == "__main__":
    main()
