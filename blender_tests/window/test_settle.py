# SPDX-License-Identifier: GPL-3.0-or-later
"""Settling: when the mouse rests and after the release, until the user does something else."""

import contextlib
import itertools
import time
from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin, pin_data, place, ready, selected, shape, sheet
from harness import Window, addon

LEFT, RIGHT, MIDDLE = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.0)
DIAGONAL = 4.0 * np.sqrt(2.0)  # of large()


def large(window: Window, side: int = 71) -> Iterator[None]:
    """A sheet that takes a while to settle."""
    sheet("Sheet", columns=side - 1, rows=side - 1, cell=4.0 / (side - 1))
    pin(LEFT, RIGHT, MIDDLE)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.use_tool()


def last() -> bpy.types.Operator:
    return bpy.context.window_manager.operators[-1]


def session():
    return addon("operators.modal.running").now()


def converged(drag) -> bool:
    return all(solved.report.converged for solved in drag.shown.each)


def flick(window: Window, index: int, dx: float, dz: float, *, steps: int = 2) -> Iterator[None]:
    """Drag a pin far in few events and let go: much is left to settle."""
    x, _, z = place(index)
    yield from window.hover(window.pixel((x, 0.0, z)))
    yield from window.press()
    yield from window.move(window.pixel((x + dx, 0.0, z + dz)), steps=steps)
    yield from window.release()


def settling(window: Window) -> Iterator[None]:
    """Until the released drag shows where it was let go, and goes on from there."""

    def waiting() -> bool:
        path = [] if session() is None or session().shown is None else session().shown.path
        return session() is not None and (len(path) < 2 or path[-1] != path[-2])

    while waiting():
        yield
    assert window.busy == ["PLANAR_OT_drag_pins"], "still settling"


@contextlib.contextmanager
def slowly(seconds: float = 0.5) -> Iterator[None]:
    """Let refinements take so long, and be at least three, so that there is something to see anywhere."""
    posing = addon("model.posing.posing").Posing
    move, settled = posing.move, posing.settled

    def slow_move(self, *sample):
        if self.path and self.path[-1] == tuple(np.float32(sample).tolist()):
            time.sleep(seconds)
        return move(self, *sample)

    posing.move = slow_move
    posing.settled = property(lambda self: settled.fget(self) and self._refinements >= 3)
    try:
        yield
    finally:
        posing.move, posing.settled = move, settled


@contextlib.contextmanager
def timed() -> Iterator[list[float]]:
    """How long each event takes."""
    interactive = addon("operators.modal.session").Interactive
    times: list[float] = []
    original = interactive.modal

    def modal(self, context, event):
        start = time.perf_counter()
        result = original(self, context, event)
        times.append(time.perf_counter() - start)
        return result

    interactive.modal = modal
    try:
        yield times
    finally:
        interactive.modal = original


@contextlib.contextmanager
def all_slowly(seconds: float) -> Iterator[None]:
    """Let each sample take so long."""
    posing = addon("model.posing.posing").Posing
    move = posing.move
    posing.move = lambda self, *sample: (time.sleep(seconds), move(self, *sample))[1]
    try:
        yield
    finally:
        posing.move = move


def test_the_drawing_settles_after_the_release_without_a_jump(window: Window) -> Iterator[None]:
    yield from large(window)
    with slowly():
        yield from flick(window, 1, -1.4, 1.2, steps=1)
        yield from settling(window)
        seen = {}
        settling_drag = session()
        while session() is not None:
            seen.setdefault(len(settling_drag.shown.path), shape())
            yield
    assert len(seen) >= 4, "it was seen to settle"
    counts = sorted(seen)
    for before, after in itertools.pairwise(counts):
        jump = np.linalg.norm(seen[after] - seen[before], axis=1).max() / (after - before)
        assert jump <= 0.02001 * DIAGONAL, jump / DIAGONAL
    assert converged(settling_drag)
    assert np.linalg.norm(place(1) - (0.1, 0.0, 1.2)) < 0.03
    assert last().bl_idname == "PLANAR_OT_drag_pins"


def test_a_release_does_not_hold_the_window_up(window: Window) -> Iterator[None]:
    yield from large(window, 100)
    with timed() as times:
        yield from flick(window, 1, -1.0, 1.2)
        yield from window.settled()
    assert len(times) > 5
    assert max(times) < 0.1, max(times)


def test_a_resting_mouse_lets_it_settle_too(window: Window) -> Iterator[None]:
    yield from large(window)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel((1.1, 0.0, 1.2)), steps=2)
    yield from window.settled()
    assert converged(session())
    rested = shape()
    yield from window.release()
    yield from window.settled()
    assert window.busy == []
    assert np.array_equal(shape(), rested), "nothing was left to do"


def test_a_second_drag_right_after_the_release(window: Window) -> Iterator[None]:
    yield from large(window)
    with slowly():
        before, shapes = shape(), []
        for index, (dx, dz) in ((1, (-1.0, 1.2)), (1, (0.9, -0.8)), (0, (0.8, -1.0)), (2, (0.0, 0.4))):
            yield from flick(window, index, dx, dz)
            if index == 2:
                yield from window.settled()
            else:
                yield from settling(window)
            shapes.append(shape())
        assert selected() == [2]
        assert window.busy == []
        drags = [o for o in bpy.context.window_manager.operators if o.bl_idname == "PLANAR_OT_drag_pins"]
        assert len(drags) == 4
        after = shape()
        for _ in range(4):
            yield from window.undo()
            assert not np.array_equal(shape(), after), "one undo step for each drag"
            after = shape()
        assert np.array_equal(shape(), before)


def test_the_recorded_path_gives_the_same_bits_again(window: Window) -> Iterator[None]:
    yield from large(window)
    yield from flick(window, 1, -0.4, 1.2, steps=5)
    yield from window.settled()
    settled, pins = shape(), pin_data()
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
    yield
    assert np.array_equal(shape(), settled)
    assert pin_data() == pins
    yield from window.undo()
    with slowly():
        yield from flick(window, 1, -1.0, 1.2)
        yield from settling(window)
        yield from window.key("ESC")  # nothing is taken back any more, and it ends with what is shown
    assert window.busy == []
    early, pins = shape(), pin_data()
    yield from window.wait(0.2)
    assert np.array_equal(shape(), early)
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
    yield
    assert np.array_equal(shape(), early)
    assert pin_data() == pins


def test_undo_redo_and_other_keys_during_settling(window: Window) -> Iterator[None]:
    yield from large(window)
    with slowly(1.0):
        before = shape()
        yield from flick(window, 1, -1.0, 1.2)
        yield from settling(window)
        yield from window.undo()
        assert window.busy == []
        assert np.array_equal(shape(), before)
        yield from window.redo()
        assert moved(before, shape()) > 0.3
        yield from flick(window, 1, 0.8, -0.7)
        yield from settling(window)
        yield from window.key("G")
        assert window.busy == ["PLANAR_OT_drag_pins"]
        assert not session().released, "the key began the next move"
        yield from window.key("ESC")
        assert window.busy == []
        yield from flick(window, 1, 0.7, -0.9)
        yield from settling(window)
        yield from window.event("WHEELUPMOUSE", "PRESS")
        yield from window.move((window.mouse[0] + 40, window.mouse[1]), steps=3)
        assert window.busy == ["PLANAR_OT_drag_pins"], "looking around lets it settle"
        yield from window.settled()
        assert window.busy == []


def test_typed_values_are_reached_even_when_the_next_key_comes_at_once(window: Window) -> Iterator[None]:
    yield from large(window)
    yield from window.click(window.pixel(RIGHT))
    yield from window.key("G")
    yield from window.type("0.5")
    yield from window.key("TAB")
    yield from window.type("-0.75")
    yield from window.key("RET")
    yield from window.key("G")  # comes too early, or begins the next move
    yield from window.settled()
    if window.busy:
        yield from window.key("ESC")
    assert window.busy == []
    assert tuple(last().properties.offset) == (0.5, -0.75)
    assert np.allclose(place(1), (2.0, 0.0, -0.75), atol=0.02), place(1)


def test_no_press_waits_for_a_typed_value(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(RIGHT))
    with all_slowly(0.3), timed() as times:
        yield from window.key("G")
        yield from window.type("0.5")
        yield from window.wait(0.4)
        assert session().progress.startswith("Solving: "), session().progress
        yield from window.key("RET")
        yield from window.key("A")
        yield from window.press()
        yield from window.release()
        assert session().progress.endswith("Cancel")
        window.picture("typed")
        yield from window.settled()
    assert window.busy == []
    assert last().bl_idname == "PLANAR_OT_drag_pins"
    assert tuple(last().properties.offset) == (0.5, 0.0)
    assert np.allclose(place(1), (2.0, 0.0, 0.0), atol=0.02), place(1)
    assert max(times) < 0.095, max(times)


def test_until_it_is_reached_a_typed_value_can_be_taken_back(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(RIGHT))
    before, pins = shape(), pin_data()
    with all_slowly(0.3):
        yield from window.key("G")
        yield from window.type("0.5")
        yield from window.key("RET")
        yield from window.wait(0.3)
        yield from window.key("ESC")
        assert window.busy == []
        yield from window.wait(0.3)
    assert np.array_equal(shape(), before)
    assert pin_data() == pins


def test_a_press_before_anything_is_solved_takes_nothing_back(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    with all_slowly(0.6), timed() as times:
        yield from flick(window, 1, 0.3, 0.3)
        yield from window.key("A")
        assert window.busy == ["PLANAR_OT_drag_pins"]
        while session() is not None and session().shown is None:
            yield
        yield from window.key("A")
        assert window.busy == []
    assert moved(np.array(place(1)), np.array(RIGHT)) > 0.1
    assert max(times) < 0.095, max(times)


def test_undo_before_anything_is_solved_takes_the_drag_back_and_nothing_else(
    window: Window,
) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.4)))
    before, pins = shape(), pin_data()
    with all_slowly(0.6):
        yield from flick(window, 1, 0.3, 0.3)
        yield from window.undo()
        assert window.busy == []
        yield from window.wait(0.8)
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
    yield from window.undo()
    assert not np.array_equal(shape(), before), "the drag before it"


def test_a_script_s_action_during_settling_ends_it(window: Window) -> Iterator[None]:
    yield from large(window)
    with slowly():
        rest = shape()
        yield from flick(window, 1, -1.0, 1.2)
        yield from settling(window)
        bpy.ops.planar.reset_to_rest("EXEC_DEFAULT", True)
        yield from window.wait(0.2)
        assert window.busy == []
        assert np.array_equal(shape(), rest)
        yield from flick(window, 1, -1.0, 1.2)
        yield from settling(window)
        bpy.ops.planar.drag_pins("EXEC_DEFAULT", True, offset=(0.0, -0.5))
        after = shape()
        yield from window.wait(0.2)
        assert window.busy == []
        assert np.array_equal(shape(), after)


def test_settle_pose_solves_what_has_changed_since(window: Window) -> Iterator[None]:
    yield from large(window)
    yield from flick(window, 1, -1.0, 1.2)
    yield from window.settled()
    posed = shape()
    active().planar.pins[2].enabled = False
    bpy.ops.ed.undo_push(message="Pin Off")
    with window.context("UI"):
        bpy.ops.planar.settle_pose("INVOKE_DEFAULT")
    assert window.busy == ["PLANAR_OT_settle_pose"]
    yield from window.settled()
    assert window.busy == []
    assert moved(posed, shape()) > 0.02, "the middle is free now"
    assert np.linalg.norm(place(1) - (0.5, 0.0, 1.2)) < 0.03
    settled = shape()
    yield from window.undo()
    assert np.array_equal(shape(), posed), "one undo step"
    yield from window.redo()
    assert np.array_equal(shape(), settled)


def test_method_and_pins_switched_between_drags(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, (0.0, 0.0, 0.5))
    for method in ("AKVF", "HOLD", "AKVF", "HOLD"):
        active().planar.method = method
        active().planar.pins[2].enabled = method == "HOLD"
        start = place(2)
        x, _, z = place(1)
        yield from window.drag(window.pixel((x, 0, z)), window.pixel((x - 0.2, 0, z + 0.3)))
        assert np.linalg.norm(place(1) - (x - 0.2, 0, z + 0.3)) < 0.05
        assert np.linalg.norm(place(0) - LEFT) < 0.05
        assert (np.linalg.norm(place(2) - start) < 0.02) == (method == "HOLD"), "a pin that is off follows"
    yield from window.drag(window.pixel(place(1)), window.pixel(RIGHT))
    active().planar.pins[2].enabled = False
    bpy.ops.planar.settle_pose("EXEC_DEFAULT", True)
    rest = addon("scene.objects.cutout_object").read_cutout(active())
    assert np.abs(rest.positions - rest.cutout.rest).max() < 0.05, "back home, so is the drawing"
