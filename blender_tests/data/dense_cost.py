# SPDX-License-Identifier: GPL-3.0-or-later
"""What dense drawings cost Blender's own thread: ms of processor time, which other processes do not lengthen.

    .venv/bin/python blender_tests/data/dense_cost.py [SIDE ...]

Each column is a square sheet of SIDE x SIDE vertices with four pins, the rows what is done to it: "read" is
the first look of the overlays, "first press" the first drag's start, "solve" a move in the solving thread,
"show" what writes it, "evaluate" Blender's own update after it, "colours" the distortion for Quality,
"release" all that follows the end of a drag until its pins are drawn, "press" a later drag's start, "key"
Key Pose, "scrub" a frame's change with the pins drawn, and "generate" an in-between written, of those between
two poses. "solve" is real time, as several threads have a part in it.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "addon"))
from support import activate, add_pins, grid, make_object

import planar_deform

SIDES = (71, 224, 317, 447)  # 5k, 50k, 100k and 200k
MOVES = 9


def costs(side: int) -> dict[str, float]:
    """By what is done."""
    from planar_deform.operators.modal.several_posing import SeveralPosing, begin
    from planar_deform.scene import follow
    from planar_deform.scene.inbetweens import planning, writing
    from planar_deform.scene.objects.any_object import begin_shape
    from planar_deform.scene.view import snapshot

    found: dict[str, list[float]] = {}

    def measured(what: str, act: Callable[[], object]) -> object:
        start = time.thread_time()
        result = act()
        found.setdefault(what, []).append(1e3 * (time.thread_time() - start))
        return result

    def drag(press: str, offset: float) -> None:
        posing = measured(press, begun)
        for step in range(MOVES):
            start = time.perf_counter()
            posing.model.move(offset * (step + 1) / MOVES, 0.0, 0.0)
            solved = posing.model.solved()
            found.setdefault("solve", []).append(1e3 * (time.perf_counter() - start))
            measured("show", lambda solved=solved: posing.show(solved))
            measured("evaluate", update)
            measured("colours", lambda: drawn().distortion)

        def release() -> None:
            posing.finish(solved)
            snapshot.release()
            follow.match(bpy.context.object)
            update()
            drawn()

        measured("release", release)

    def begun() -> SeveralPosing:
        posing = begin(bpy.context, 3)
        assert posing.model is not None
        return posing

    def update() -> None:
        bpy.context.view_layer.update()

    def drawn() -> snapshot.Snapshot:
        return snapshot.of_active(bpy.context)

    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = grid(side - 1, side - 1, 4.0, 4.0)
    obj = make_object(vertices, faces.tolist(), name="Sheet")
    obj.rotation_euler.x = np.pi / 2
    add_pins(obj, [0], [side - 1], [side * (side - 1)], [side * side - 1])
    activate(obj)
    measured("read", drawn)
    drag("first press", 0.3)
    for _ in range(3):
        drag("press", 0.1)
    for frame in (1, 25):
        bpy.context.scene.frame_set(frame)
        drag("press", 0.2)
        measured("key", bpy.ops.planar.key_pose)
    drawn()
    for frame in range(2, 6):

        def scrub(frame: int = frame) -> None:
            bpy.context.scene.frame_set(frame)
            drawn()

        measured("scrub", scrub)
    drawing = begin_shape(bpy.context)
    plan = planning.plan(drawing)
    steps = writing.write(drawing, plan, plan.solve())
    while measured("generate", lambda: next(steps, None)) is not None:
        pass
    return {what: median(times) for what, times in found.items()}


def main() -> None:
    sides = [int(side) for side in sys.argv[1:]] or SIDES
    planar_deform.register()
    columns = [costs(side) for side in sides]
    print(f"{'vertices':14}", *(f"{side * side:9}" for side in sides))
    for what in columns[0]:
        print(f"{what:14}", *(f"{column[what]:9.1f}" for column in columns))


if __name__ == "__main__":
    try:
        main()
    finally:
        planar_deform.unregister()
