# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens of a long motion in the window: progress, Esc, undo, other files and the view meanwhile."""

import itertools
import time
from collections.abc import Callable, Iterator
from functools import partial

import bpy
import numpy as np
from cutouts import active, moved, ready, sheet
from harness import Window, addon
from poses import LEFT, RIGHT, at, pull, shown, stored

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
        drawing = addon("scene.objects.cutout_object").begin(bpy.context)
        rest = drawing.cutout.rest
        addon("scene.objects.any_object").key_poses(drawing, {frame: bent(rest - rest.mean(axis=0), turn)})
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
    return addon("operators.modal.running").now()


def until(window: Window, met: Callable[[], bool], seconds: float = 120.0) -> Iterator[None]:
    for _ in window.wait(seconds):
        if met():
            return
        yield
    raise AssertionError("it does not come to that")


def writing() -> bool:
    return run() is None or run().share > 0.55


def test_escape_and_undo_while_it_is_solved_and_while_it_is_written(window: Window) -> Iterator[None]:
    yield from motion(window)
    before = stored()
    for phase, way_out in itertools.product(
        ("solving", "writing"), (window.undo, partial(window.key, "ESC"))
    ):
        yield from start(window)
        if phase == "writing":
            yield from until(window, writing)
            assert run() is not None, "it was over before it could be looked at"
            assert stored() != before
            window.picture("generating")
        yield from way_out()
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


def test_a_long_job_is_done_in_many_looks(window: Window) -> Iterator[None]:
    """How long one keeps the window waiting is printed: the first may take a tenth of a second."""
    yield from motion(window)
    long_job = addon("operators.modal.long_job")
    advance, waits = long_job.LongRun.advance, []

    def timed(self, wait, write):
        start = time.perf_counter()
        try:
            return advance(self, wait, write)
        finally:
            waits.append(time.perf_counter() - start)

    long_job.LongRun.advance = timed
    try:
        yield from start(window)
        yield from until(window, lambda: window.busy == [])
    finally:
        long_job.LongRun.advance = advance
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


def test_a_pose_between_the_keyed_ones_is_spread_and_carried_over(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    for frame, height in ((1, 0.5), (25, -1.0)):
        bpy.context.scene.frame_set(frame)
        yield
        yield from pull(window, 0.0, height)
        with window.context("UI"):
            bpy.ops.planar.key_pose("INVOKE_DEFAULT", True)
        yield
    invoke(window, bpy.ops.planar.generate_inbetweens)
    yield from until(window, lambda: window.busy == [])
    before = {frame: at(frame) for frame in (1, 13, 25)}
    bpy.context.scene.frame_set(13)
    yield
    yield from pull(window, 0.3, 0.4)
    wanted = shown()
    assert moved(wanted, before[13]) > 0.2
    invoke(window, bpy.ops.planar.edit_sequence)
    yield from until(window, lambda: window.busy == [])
    assert np.allclose(at(13), wanted, atol=1e-6)
    assert moved(at(1), before[1]) > 0.1
    last = bpy.context.window_manager.operators[-1]
    assert last.bl_idname == "PLANAR_OT_edit_sequence"
    last.properties.keep_poses = True
    bpy.context.scene.frame_set(13)
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
    yield
    assert np.array_equal(at(1), before[1])
    assert np.array_equal(at(25), before[25])
    assert np.allclose(at(13), wanted, atol=1e-6)

    source = active()
    name = source.name
    twin = sheet("Twin", at=(0.0, 0.5, 0.0))
    twin.select_set(True)
    bpy.context.view_layer.objects.active = source
    source.select_set(True)
    bpy.ops.ed.undo_push(message="Twin")
    invoke(window, bpy.ops.planar.transfer_motion)
    yield from until(window, lambda: window.busy == [])
    for frame in (1, 7, 13, 25):
        here = at(frame)
        bpy.context.view_layer.objects.active = bpy.data.objects["Twin"]
        there = shown()
        bpy.context.view_layer.objects.active = bpy.data.objects[name]
        assert np.allclose(there, here, atol=1e-5), frame
    yield from window.undo()
    assert bpy.data.objects["Twin"].data.shape_keys is None, "one undo step"
    yield


def invoke(window: Window, operator: Callable) -> None:
    """Run an operator as its button does."""
    with window.context("UI"):
        assert operator("INVOKE_DEFAULT", True) <= {"FINISHED", "RUNNING_MODAL"}
