# SPDX-License-Identifier: GPL-3.0-or-later
"""What a long motion costs: 1000 frames of a sheet of 5041 vertices between four poses, and as a recording.

    .venv/bin/python blender_tests/data/motion_cost.py [FRAMES [SIDE]]

"read" and "write" are done in Blender's own thread, "write" in steps, the longest of which is told in ms;
"solve" runs in a thread beside it. "cpu" is processor time, which other processes do not lengthen. Memory is
that of the process, before and after.
"""

import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "addon"))
from support import activate, grid, make_object

import planar_deform
from planar_deform.operators.modal.long_job import Job


def resident() -> float:
    """MB of the process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


def bent(rest: np.ndarray, turn: float) -> np.ndarray:
    """n x 2 points of a sheet about the origin, bent to an arc that turns by so much from end to end."""
    radius = np.ptp(rest[:, 0]) / turn
    angle = rest[:, 0] / radius
    return np.stack(
        [(radius - rest[:, 1]) * np.sin(angle), radius - (radius - rest[:, 1]) * np.cos(angle)], axis=1
    )


class Clock:
    """Seconds, and those of processor time, since the last look."""

    def __init__(self) -> None:
        self._last = self._now()

    def look(self) -> str:
        now, before = self._now(), self._last
        self._last = now
        return f"{now[0] - before[0]:8.2f}{now[1] - before[1]:6.2f}"

    @staticmethod
    def _now() -> tuple[float, float]:
        return time.perf_counter(), time.process_time()


def measure(name, make, summary=lambda job, solved: ""):
    """Run a job as an operator does, and print what it takes."""
    before, clock = resident(), Clock()
    job = make()
    row = clock.look()
    solved = job.solve(lambda share: True)
    row += clock.look()
    running, steps = job.write(solved), []
    while True:
        start = time.perf_counter()
        done = next(running, None) is None
        steps.append(1e3 * (time.perf_counter() - start))
        if done:
            break
    row += clock.look()
    told = summary(job, solved)
    print(f"{name:22}{row}{max(steps):10.1f}{before:9.0f}{resident():9.0f}  {told}", flush=True)


def sheet(side: int) -> bpy.types.Object:
    vertices, faces = grid(side, side, 4.0, 4.0, origin=(-2.0, -2.0))
    return make_object(vertices, faces.tolist(), name="Sheet")


def key(obj, turns: dict[float, float]) -> None:
    from planar_deform.scene.objects.any_object import begin_shape, key_poses

    activate(obj)
    drawing = begin_shape(bpy.context)
    rest = drawing.rest
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"  # as recorded
    key_poses(drawing, {frame: bent(rest, turn) for frame, turn in turns.items()})


def main() -> None:
    last, side = (int(text) for text in (*sys.argv[1:], "1000", "70")[:2])
    planar_deform.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    from planar_deform.scene.inbetweens import planning, writing
    from planar_deform.scene.motion.sequence_edit import SequenceEdit
    from planar_deform.scene.motion.thinning import Thinning
    from planar_deform.scene.motion.transfer import Transfer
    from planar_deform.scene.objects.any_object import begin_shape

    obj = sheet(side)
    key(obj, {1: 0.3, last // 3: 1.6, 2 * last // 3: -1.2, last: 0.8})
    print(f"{last} frames, {len(obj.data.vertices)} vertices; seconds, ms, MB")
    phases = "".join(f"{phase:>8}{'cpu':>6}" for phase in ("read", "solve", "write"))
    print(f"{'':22}{phases}{'longest':>10}{'before':>9}{'after':>9}")

    drawing = begin_shape(bpy.context)
    plan = planning.plan(drawing)
    measure(
        "Generate In-Betweens", lambda: Job(lambda shapes: writing.write(drawing, plan, shapes), plan.solve)
    )
    for compress in (False, True):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "motion.blend"
            bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=compress, copy=True)
            print(f"file{' (compressed)' if compress else ''}: {path.stat().st_size / 1e6:.1f} MB")
    start = time.perf_counter()
    for frame in range(1, 101):
        bpy.context.scene.frame_set(frame)
    print(f"frame change: {1e1 * (time.perf_counter() - start):.2f} ms")

    twin = sheet(side)
    activate(obj)
    twin.select_set(True)
    measure("Transfer Motion", lambda: Transfer(bpy.context))
    activate(obj)
    bpy.context.scene.frame_set(last // 2)
    drawing = begin_shape(bpy.context)
    drawing.write(drawing.positions + 0.1 * np.sin(2.0 * drawing.positions[:, ::-1]))
    measure("Edit Sequence", lambda: SequenceEdit(bpy.context, False))

    recording = sheet(side)
    time_of = np.arange(1, last + 1)
    key(recording, dict(zip(time_of.tolist(), 0.1 + 1.5 * np.sin(time_of / 40.0) ** 2, strict=True)))
    measure("Thin Poses", lambda: Thinning(bpy.context, 0.01), lambda job, solved: job.summary(solved))


if __name__ == "__main__":
    try:
        main()
    finally:
        planar_deform.unregister()
