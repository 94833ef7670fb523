# SPDX-License-Identifier: GPL-3.0-or-later
"""Record: the timeline plays while a pin is dragged, and the motion becomes keyed poses."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin_data, place, ready, selected, shape
from harness import Window, addon
from poses import LEFT, RIGHT, shown


def keyed_frames() -> list[float]:
    pose_state = addon("scene.sequence.pose_state")
    return sorted(
        frame for pose in range(len(active().planar.poses)) for frame in pose_state.frames_of(active(), pose)
    )


def start(window: Window) -> Iterator[None]:
    """Begin Record as the button in the sidebar does."""
    with window.context():
        bpy.ops.planar.record_pins("INVOKE_DEFAULT")
    assert window.busy == ["PLANAR_OT_record_pins"]
    yield


def up_and_on(window: Window, frames: int) -> Iterator[None]:
    """Drag the right pin up, by 0.05 a frame, until the timeline has come so far."""
    scene = bpy.context.scene
    first = scene.frame_current
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    while scene.frame_current < first + frames:
        yield from window.move(window.pixel((1.5, 0.0, min(0.05 * (scene.frame_current - first), 1.0))))
    yield from window.move(window.pixel((1.5, 0.0, 1.0)))
    last = scene.frame_current
    while scene.frame_current < last + 5:
        yield


def done(window: Window) -> Iterator[None]:
    for _ in range(2000):
        if window.busy == []:
            return
        yield
    raise AssertionError("the recording does not end")


def test_twenty_frames_are_recorded_and_played_back(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    scene = bpy.context.scene
    scene.frame_set(5)
    before, pins = shape(), pin_data()
    yield from start(window)
    yield from up_and_on(window, 20)
    window.picture("record")
    yield from window.release()
    yield from done(window)
    frames = keyed_frames()
    assert frames[0] == 5
    assert len(frames) >= 21
    assert np.array_equal(np.diff(frames), np.ones(len(frames) - 1)), "a pose for each frame, none left out"
    assert scene.frame_current == frames[-1]
    assert selected() == [1]
    heights = []
    for frame in frames:
        scene.frame_set(int(frame))
        posed = shown()
        assert np.isfinite(posed).all()
        heights.append(posed[np.argmin(np.abs(before - np.array(RIGHT)).sum(axis=1)), 2])
    assert abs(heights[0]) < 1e-3
    assert heights[-1] > 0.5, heights
    assert np.diff(heights).min() > -0.02, "the motion was upwards"
    yield from window.undo()
    assert active().data.shape_keys is None, "one undo step"
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
    yield from window.redo()
    assert keyed_frames() == frames


def test_escape_discards_everything(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    scene = bpy.context.scene
    scene.frame_set(3)
    before, pins = shape(), pin_data()
    for phase in ("waiting", "recording", "solving"):
        yield from start(window)
        if phase != "waiting":
            yield from up_and_on(window, 5)
            yield from window.settled()
            assert moved(before, shape()) > 0.02
        if phase == "solving":
            yield from window.event("LEFTMOUSE", "RELEASE")
        yield from window.key("ESC")
        if phase == "recording":
            yield from window.release()
        yield from done(window)
        if phase != "solving":  # there it may have been too late
            assert active().data.shape_keys is None, phase
            assert np.array_equal(shape(), before), phase
            assert pin_data() == pins, phase
            assert scene.frame_current == 3, phase


def test_recording_on_poses_and_options_in_the_redo_panel(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    scene = bpy.context.scene
    bpy.ops.planar.key_pose("EXEC_DEFAULT", True)
    yield from window.click(window.pixel(RIGHT))
    yield from start(window)
    first = scene.frame_current
    yield from window.hover(window.pixel((0.0, 0.0, -1.8)))  # off the pins: the selected one moves
    yield from window.press()
    x, start_y = window.mouse
    while scene.frame_current < first + 8:
        y = start_y + 8 * (scene.frame_current - first)
        yield from window.move((x, y))
    yield from window.confirm()
    yield from done(window)
    yield from window.release()
    frames = keyed_frames()
    assert frames[0] == first
    assert frames[-1] >= first + 8
    last = bpy.context.window_manager.operators[-1]
    assert last.bl_idname == "PLANAR_OT_record_pins"
    last.properties.frame_step = 4
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
    yield
    fewer = keyed_frames()
    assert fewer[:3] == [first, first + 4, first + 8]
    assert fewer[-1] == frames[-1]
    assert len(fewer) < len(frames)
    bpy.context.scene.frame_set(int(frames[-1]))
    assert place(1)[2] < 1.0  # the mesh itself stays at rest; the poses are shape keys
    assert moved(shape(), shown()) > 0.1


def test_a_click_and_a_press_beside_the_view_record_nothing(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from start(window)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.release()
    yield from done(window)
    assert active().data.shape_keys is None
    assert np.array_equal(shape(), before)
    yield from start(window)
    yield from window.click((5, 5))  # another editor
    assert window.busy == ["PLANAR_OT_record_pins"]
    yield from window.hover(window.pixel((0.0, 0.0, 0.5)))
    yield from window.press("RIGHTMOUSE")
    yield from window.release("RIGHTMOUSE")
    assert window.busy == []


def test_the_button_pressed_twice_starts_nothing_unseen(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.sidebar()
    yield from window.push("planar.record_pins")
    assert window.busy == ["PLANAR_OT_record_pins"]
    yield from window.push("planar.record_pins")
    yield from window.move((window.mouse[0] - 1, window.mouse[1]))
    assert window.busy == []
    assert addon("operators.modal.running").now() is None
    yield from window.drag(window.pixel((0.0, 0.0, -1.8)), window.pixel((0.5, 0.0, -1.8)))
    yield from window.wait(0.2)
    assert window.busy == []
    assert active().data.shape_keys is None, "a drag off the pins records nothing"
    assert np.array_equal(shape(), before)


def test_started_again_while_it_records_it_keeps_the_motion(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from start(window)
    yield from up_and_on(window, 5)
    with window.context():
        assert bpy.ops.planar.record_pins("INVOKE_DEFAULT") == {"CANCELLED"}
    yield from done(window)
    yield from window.release()
    assert len(keyed_frames()) >= 6
    assert window.busy == []
    assert addon("operators.modal.running").now() is None
