# SPDX-License-Identifier: GPL-3.0-or-later
"""How far dense drawings posed through a cage end from the dense solver, for all published poses.

    build/figures/bin/python benchmarks/cage_poses.py [POSE ...]

after `tools/figures.sh --table cage` has made that environment. Each pose of a character refined to 50000
vertices or more takes minutes, most of them for the dense solver, which is led along 30 steps and once more
in one jump. What each comes to is stored in build/cage_poses, so that another call goes on; delete that after
changes of the solver. The columns are those of the table `cage`: see there.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from figures_cage import CAGE, OWN, STEPS, distances, refined, released
from figures_data import Pose, Shape, read_shape
from figures_posing import dragged

import planar_native

ROOT = Path(__file__).resolve().parents[1]
STORED = ROOT / "build" / "cage_poses"
LEAST = 50_000  # vertices


def characters() -> list[Shape]:
    files = [*sorted((ROOT.parent / "shared" / "data").glob("*.obj")), OWN / "fox.obj", OWN / "dragon.obj"]
    return [shape for shape in map(read_shape, files) if shape.poses]


def caged(shape: Shape, pose: Pose) -> np.ndarray:
    """What a drag through the cage comes to, and what the mesh's own steps make of that."""
    poser = planar_native.Poser(shape.rest, shape.triangles, cage=CAGE)
    poser.set_handles(pose.handles)
    start = shape.rest[pose.handles]
    for step in range(1, STEPS + 1):
        poser.move(start + (pose.targets - start) * step / STEPS)
    while not (poser.report.converged or poser.report.coarse_settled):
        poser.refine()
    return np.stack([poser.positions, released(poser)])


def stored(name: str, make: Callable[[], np.ndarray]) -> np.ndarray:
    file = STORED / f"{name.replace(' ', '-')}.npy"
    if not file.exists():
        began = time.process_time()
        found = make()
        np.save(file, found)
        print(
            f"    {name}: {time.process_time() - began:.1f} s of processor time", file=sys.stderr, flush=True
        )
    return np.load(file)


def main() -> None:
    chosen = sys.argv[1:]
    STORED.mkdir(parents=True, exist_ok=True)
    print(
        f"{'pose':12}{'vertices':>9}   {'shown':>6} {'end':>6} {'way':>6}   {'dense':>14} {'cage':>14} flips"
    )
    for shape in characters():
        fine = shape
        while len(fine.rest) < LEAST:
            fine = refined(fine)
        for pose in fine.poses:
            if chosen and pose.name not in chosen:
                continue
            shown, end = stored(f"{pose.name} cage", lambda pose=pose, fine=fine: caged(fine, pose))
            dense, jump = (
                stored(f"{pose.name} {steps}", lambda p=pose, f=fine, steps=steps: dragged(f, p, steps))
                for steps in (STEPS, 1)
            )
            ways = [distances(*pair, fine).max() for pair in ((shown, end), (end, dense), (jump, dense))]
            known, found = (planar_native.distortion(fine.rest, x, fine.triangles) for x in (dense, end))
            text = f"{pose.name:12}{len(fine.rest):9}   {ways[0]:6.2f} {ways[1]:6.2f} {ways[2]:6.2f}"
            text += f"   {known.area:6.3f} /{known.angle:6.3f} {found.area:6.3f} /{found.angle:6.3f}"
            print(f"{text} {found.flipped:5}", flush=True)


if __name__ == "__main__":
    main()
