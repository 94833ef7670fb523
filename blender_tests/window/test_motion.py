# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens of a long motion in the window: progress, Esc, undo, other files and the view meanwhile."""

import time
from collections.abc import Callable, Iterator

import bpy
import numpy as np
from cutouts import active, sheet
from harness import Window, addon

LAST = 301
OPERATOR = "PLANAR_OT_generate_inbetweens"


def bent(rest: np.ndarray, turn: float) -> np.ndarray:
    """n x 2 points bent to an arc that turns by so much from end to end."""
    width = np.ptp(rest[:, 0])
    radius = width / turn
    angle = rest[:, 0] / radius
    return np.stack(
        [(radius - rest[:, 1]) * np.sin(angle), radius - (radius - rest[:, 1]) * np.cos(angle)], axis=1
    )


def motion(window: Window, *, cells: int = 50, last: int = LAST) -> Iterator[None]:
    """A sheet that bends to one side and to the other, keyed at three frames, in an undo step of its own."""
    sheet(columns=cells, rows=cells, cell=4.0 / cells)
    for frame, turn in ((1, 0.3), ((1 + last) // 2, 1.6), (last, -1.6)):
        scene = addon("scene.access").begin(bpy.context)
        rest = scene.cutout.rest
        addon("scene.sequence").put(scene, {frame: bent(rest - rest.mean(axis=0), turn)})
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_end = last
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()


def start(window: Window) -> Iterator[None]:
    """As the panel's button does."""
    with window.context("UI"):
        assert bpy.ops.planar.generate_inbetweens("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    assert window.busy == [OPERATOR]
    yield


def run():
    """What is under way."""
    return addon("operators.long_operator")._running


def until(window: Window, met: Callable[[], bool], seconds: float = 120.0) -> Iterator[None]:
    for _ in window.wait(seconds):
        if met():
            return
        yield
    raise AssertionError("it does not come to that")


def writing() -> bool:
    return run() is None or run().share > 0.55


def stored() -> list:
    """All that is stored of the shapes and their timing."""
    obj = active()
    keys = obj.data.shape_keys
    if keys is None:
        return []
    shapes = []
    for block in keys.key_blocks:
        co = np.empty(len(block.data) * 3, np.float32)
        block.data.foreach_get("co", co)
        shapes.append((block.name, block.frame, co.tobytes()))
    curve = addon("scene.pose_blocks").shown_curve(keys)
    timing = [(tuple(point.co), point.interpolation) for point in curve.keyframe_points]
    poses = [(pose.name, pose.at, pose.generated, pose.stamp) for pose in obj.planar.poses]
    return [shapes, timing, poses, keys.eval_time, obj.active_shape_key_index]


def test_escape_while_it_is_solved_and_while_it_is_written(window: Window) -> Iterator[None]:
    yield from motion(window)
    before = stored()
    for phase in ("solving", "writing"):
        yield from start(window)
        if phase == "writing":
            yield from until(window, writing)
            assert run() is not None, "it was over before it could be looked at"
            assert stored() != before
            window.picture("generating")
        yield from window.key("ESC")
        assert window.busy == [], phase
        assert stored() == before, phase
    yield from window.wait(0.5)
    window.picture("generating-cancelled")


def test_complete_it_is_one_undo_step(window: Window) -> Iterator[None]:
    yield from motion(window)
    before = stored()
    yield from start(window)
    distance = window.view.view_distance
    yield from window.hover(window.pixel((0, 0, 0)))
    yield from window.event("WHEELUPMOUSE", "PRESS")
    yield from window.key("X")  # deletes nothing: it is swallowed
    yield from until(window, lambda: window.busy == [])
    assert window.view.view_distance < distance, "the view can be moved meanwhile"
    assert len(active().data.shape_keys.key_blocks) > LAST
    after = stored()
    yield from window.undo()
    assert stored() == before
    yield from window.redo()
    assert stored() == after
    yield from window.wait(0.3)
    window.picture("generated")


def test_a_short_job_is_done_at_once(window: Window) -> Iterator[None]:
    yield from motion(window, cells=6, last=13)
    with window.context("UI"):
        assert bpy.ops.planar.generate_inbetweens("INVOKE_DEFAULT", True) == {"FINISHED"}
    assert window.busy == []
    yield


def test_it_never_keeps_the_window_waiting(window: Window) -> Iterator[None]:
    """Most looks take some ms; a tenth of a second is what a user does not call waiting."""
    yield from motion(window)
    long_operator = addon("operators.long_operator")
    advance, waits = long_operator.LongRun.advance, []

    def timed(self, wait, write):
        start = time.perf_counter()
        try:
            return advance(self, wait, write)
        finally:
            waits.append(time.perf_counter() - start)

    long_operator.LongRun.advance = timed
    try:
        yield from start(window)
        yield from until(window, lambda: window.busy == [])
    finally:
        long_operator.LongRun.advance = advance
    assert len(waits) > 10
    print(f"     {len(waits)} looks, the longest {1e3 * max(waits):.0f} ms", flush=True)


def test_undo_and_another_file_meanwhile_end_it(window: Window) -> Iterator[None]:
    for end in ("undo", "file", "script"):
        yield from motion(window)
        yield from start(window)
        yield from until(window, writing)
        before = run()
        assert before is not None
        if end == "undo":
            bpy.ops.ed.undo()
        elif end == "file":
            bpy.ops.wm.read_homefile(app_template="")
        else:
            active().name = "Another"
            bpy.data.objects.remove(active())
        yield from window.wait(0.3)
        assert before.stopped, end
        assert window.busy == [], end
        assert run() is None
        for thing in list(bpy.data.objects):
            bpy.data.objects.remove(thing)
        yield
