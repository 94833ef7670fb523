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
    assert window.busy == ["PLANAR_OT_click"], "which says that there is no pin until the next press"
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


def range_of(first: int, last: int) -> None:
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = first, last


def test_it_ends_at_the_end_of_the_range(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    range_of(1, 15)
    bpy.context.scene.frame_set(5)
    yield from start(window)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel((1.5, 0.0, 0.6)), steps=4)
    yield from done(window)
    assert keyed_frames() == list(range(5, 16))
    assert bpy.context.scene.frame_current == 15
    yield from window.release()
    assert window.busy == []
    yield from window.undo()
    assert active().data.shape_keys is None, "one undo step"


def test_beyond_the_range_it_goes_on(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    range_of(1, 4)
    bpy.context.scene.frame_set(4)
    yield from start(window)
    yield from up_and_on(window, 6)
    yield from window.release()
    yield from done(window)
    assert keyed_frames()[:7] == list(range(4, 11))


def test_in_a_loop_the_last_time_counts(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    range_of(1, 10)
    active().planar.record_loop = True
    bpy.context.scene.render.fps = 4
    yield from start(window)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    scene, seen = bpy.context.scene, []
    while len(seen) < 2 or not (seen[-1] > 4 and any(np.diff(seen) < 0)):
        seen.append(scene.frame_current)
        yield from window.move(window.pixel((1.5, 0.0, 0.6 if any(np.diff(seen) < 0) else 0.05)))
    yield from window.release()
    yield from done(window)
    assert keyed_frames() == list(range(1, 11))
    heights = []
    for frame in (3, 9):
        scene.frame_set(frame)
        heights.append(shown()[np.argmin(np.abs(shape() - np.array(RIGHT)).sum(axis=1)), 2])
    assert heights[0] > 0.3 > heights[1], heights


def acted(window: Window, place: tuple[float, float, float], dz: float) -> Iterator[None]:
    """Record from the first frame to the end of the range, with a pin on its way up or down."""
    scene, (x, y, z) = bpy.context.scene, place
    scene.frame_set(1)
    yield from start(window)
    yield from window.hover(window.pixel(place))
    yield from window.press()
    for _ in range(100):
        if scene.frame_current >= scene.frame_end - 1 or window.busy == []:
            break
        yield from window.move(window.pixel((x, y, z + dz * scene.frame_current)))
    window.picture("layer")
    yield from done(window)
    yield from window.release()


def test_a_second_recording_plays_the_first(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    range_of(1, 10)
    bpy.context.scene.render.fps = 4
    right, left = (np.argmin(np.abs(shape() - np.array(place)).sum(axis=1)) for place in (RIGHT, LEFT))

    def heights(vertex: int) -> list[float]:
        found = []
        for frame in range(1, 11):
            bpy.context.scene.frame_set(frame)
            found.append(float(shown()[vertex, 2]))
        return found

    yield from acted(window, RIGHT, 0.06)
    first = heights(right)
    assert first[-1] > 0.3, first
    yield from acted(window, LEFT, -0.06)
    assert keyed_frames() == list(range(1, 11))
    assert np.abs(np.array(heights(right)) - first).max() < 0.02
    assert heights(left)[-1] < -0.3
    yield
