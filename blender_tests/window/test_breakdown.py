# SPDX-License-Identifier: GPL-3.0-or-later
"""Breakdown: by mouse with every way out, typed, beyond the poses, on keyed frames, undone and redone."""

import time
from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved
from harness import Window, addon
from poses import at, go_to, shown, stored, three_poses, timing


def start(window: Window) -> Iterator[None]:
    """Begin as the panel's button does, with the mouse in the view."""
    yield from window.hover((400, 300))
    with window.context():
        assert bpy.ops.planar.breakdown("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    assert window.busy == ["PLANAR_OT_breakdown"]
    yield


def last() -> bpy.types.Operator:
    return bpy.context.window_manager.operators[-1]


def slide(window: Window, share: float, **modifiers: bool) -> Iterator[None]:
    """Move the mouse by a share of the slider's width."""
    x, y = window.mouse
    width = addon("model.input.breakdown").WIDTH * bpy.context.preferences.system.ui_scale
    yield from window.move((x + round(share * width), y), steps=4, **modifiers)
    yield


def test_the_button_starts_it_the_mouse_slides_it_and_a_click_keys_it(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    first, second, between = at(1), at(25), at(10)
    yield from go_to(10)
    active().planar.show_onion = True
    yield from window.push("planar.breakdown")
    assert window.busy == ["PLANAR_OT_breakdown"]
    start_shape = shown()
    yield from slide(window, 0.25)
    window.picture("breakdown")
    slid = shown()
    assert moved(slid, start_shape) > 0.2
    assert addon("scene.sequence.pose_state").unkeyed(active())
    yield from slide(window, -0.25)
    assert np.array_equal(shown(), start_shape), "back where it was, the shape is"
    yield from slide(window, 0.25)
    yield from window.press()
    yield from window.release()
    yield
    assert window.busy == []
    assert np.array_equal(shown(), slid)
    assert abs(last().properties.percent - (100 * 9 / 24 + 25)) < 0.5, "it starts at the share of its frame"
    assert [(frame, kind) for frame, _, kind, _ in timing()] == [
        (1, "KEYFRAME"),
        (10, "BREAKDOWN"),
        (25, "KEYFRAME"),
        (49, "KEYFRAME"),
    ]
    yield from window.wait(0.3)
    window.picture("breakdown_keyed")
    assert np.array_equal(at(10), slid)
    assert np.array_equal(at(1), first)
    assert np.array_equal(at(25), second)
    bpy.context.scene.frame_set(10)
    yield from window.undo()
    assert len(active().planar.poses) == 3
    assert np.array_equal(at(10), between)
    yield from window.redo()
    assert np.array_equal(at(10), slid)


def test_while_its_way_is_solved_it_needs_no_mouse_and_is_confirmed(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    between, module = at(10), addon("operators.breakdown")
    solve = module.Ways.solve

    def slowly(*given: object) -> None:
        time.sleep(0.5)
        solve(*given)

    module.Ways.solve = slowly
    try:
        for confirm in (False, True):
            yield from go_to(10)
            yield from start(window)
            assert np.array_equal(shown(), between), "it is not solved yet"
            if confirm:
                yield from window.key("RET")
            yield from window.wait(1.0)
            assert moved(shown(), between) > 0.01
            assert len(active().planar.poses) == (4 if confirm else 3)
            if not confirm:
                yield from window.key("ESC")
    finally:
        module.Ways.solve = solve
    assert window.busy == []


def test_escape_and_right_mouse_restore_every_bit(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    active().location.x = 0.1
    bpy.ops.ed.undo_push(message="Move")
    for frame in (10, 25):
        yield from go_to(frame)
        before = stored()
        for way_out in ("ESC", "RIGHTMOUSE"):
            yield from start(window)
            yield from slide(window, 0.3)
            yield from window.key("E")
            yield from slide(window, 1.0)
            yield from window.key(way_out)
            yield
            assert window.busy == []
            assert stored() == before
    for _ in range(3):  # back through two frame changes and the move
        assert abs(active().location.x - 0.1) < 1e-6
        yield from window.undo()
    assert active().location.x == 0.0, "none of them is an undo step"


def test_press_slide_and_release_keys_what_generating_gives_there(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    bpy.ops.planar.generate_inbetweens()
    generated = at(7)
    bpy.ops.planar.remove_inbetweens()
    yield from go_to(19)
    yield from start(window)
    yield from window.press()
    yield from slide(window, -0.5)
    assert window.busy == ["PLANAR_OT_breakdown"]
    yield from window.release()
    yield
    assert window.busy == []
    assert abs(last().properties.percent - 25.0) < 0.2, last().properties.percent
    assert np.abs(shown() - generated).max() < 0.02


def test_typed_snapped_precise_and_beyond(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    first, second = at(1), at(25)
    yield from go_to(13)
    yield from start(window)
    yield from window.press("LEFT_CTRL", ctrl=True)
    yield from slide(window, 0.23, ctrl=True)
    assert abs(last_percent(window) - 70.0) < 1e-4
    yield from window.release("LEFT_CTRL")
    yield from slide(window, 0.0)
    assert abs(last_percent(window) - 73.0) < 0.5
    yield from window.press("LEFT_SHIFT", shift=True)
    yield from slide(window, 0.16, shift=True)
    assert abs(last_percent(window) - 75.0) < 0.5
    yield from window.release("LEFT_SHIFT")
    yield from slide(window, 1.0)
    assert last_percent(window) == 100.0
    assert np.array_equal(shown(), second)
    yield from window.key("E")
    assert last_percent(window) > 170.0
    assert moved(shown(), second) > 0.5
    window.picture("breakdown_overshoot")
    yield from window.type("0")
    assert np.array_equal(shown(), first)
    yield from window.key("BACK_SPACE")
    yield from window.type("120")
    window.picture("breakdown_typed")
    yield from window.key("RET")
    yield
    assert window.busy == []
    assert (last().properties.percent, last().properties.overshoot) == (120.0, True)
    keyed = shown()
    assert np.array_equal(at(13), keyed)
    for percent in (60.0, 120.0):  # what the redo panel does
        last().properties.percent = percent
        with window.context():
            bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
        yield
        assert len(active().planar.poses) == 4
        assert np.array_equal(shown(), keyed) == (percent == 120.0), (percent, moved(shown(), keyed))


def last_percent(window: Window) -> float:
    """Of the breakdown that is on."""
    return window.window.modal_operators[0].properties.percent


def test_on_a_keyed_frame_the_pose_is_made_again(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    pose, before, behind = at(25), at(1), at(49)
    yield from go_to(25)
    yield from start(window)
    yield from window.type("100")
    assert np.array_equal(shown(), behind)
    for _ in range(3):
        yield from window.key("BACK_SPACE")
    yield from window.type("30")
    again = shown()
    assert moved(again, pose) > 0.2
    yield from window.key("RET")
    yield
    assert len(active().planar.poses) == 3
    assert np.array_equal(at(25), again)
    assert np.array_equal(at(1), before)
    yield from go_to(25)
    yield from start(window)
    assert abs(last_percent(window) - 30.0) < 1e-3, "it starts where the pose is"
    yield from window.key("ESC")


def test_a_frame_change_or_undo_on_the_way_ends_it(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    between = at(13)
    yield from start(window)
    yield from slide(window, 0.3)
    bpy.context.scene.frame_set(14)
    yield from slide(window, 0.1)
    assert window.busy == []
    assert np.array_equal(at(13), between)
    yield from go_to(13)
    yield from start(window)
    yield from slide(window, 0.3)
    with window.context():
        bpy.ops.ed.undo()
    yield from slide(window, 0.1)
    assert window.busy == []
    assert not addon("scene.sequence.pose_state").unkeyed(active())


def test_outside_of_the_poses_it_says_what_to_do(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    yield from go_to(60)
    with window.context():
        assert not bpy.ops.planar.breakdown.poll()
    yield
