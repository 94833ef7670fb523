# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed poses in the window: keyed from the panel, dragged on and off their frames, undone, played."""

import contextlib
from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved
from harness import Window, addon
from poses import at, go_to, key_pose, pin_place, pull, shown, stored, three_poses


def test_three_poses_are_shown_at_their_frames_and_blended_between(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    poses = {frame: at(frame) for frame in (1, 25, 49)}
    assert moved(poses[1], poses[25]) > 0.5
    assert moved(poses[25], poses[49]) > 0.5
    assert np.allclose(at(13), (poses[1] + poses[25]) / 2, atol=1e-6)
    yield from window.wait(0.5)
    window.picture("poses")
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_end = 49
    window.area.spaces.active.show_region_ui = False
    yield from window.wait(0.3)
    snapshot, reads = addon("scene.view.snapshot"), []
    read = snapshot._read
    snapshot._read = lambda *of: reads.append(bpy.context.scene.frame_current) or read(*of)
    try:
        with window.context():
            bpy.ops.screen.animation_play()
            yield from window.wait(1.5)
            assert not reads, "no mesh is read for pins while the timeline plays"
            bpy.ops.screen.animation_cancel(restore_frame=False)
        assert bpy.context.scene.frame_current != 1
        yield from window.wait(0.3)
        assert reads, "they come back"
    finally:
        snapshot._read = read
    for frame, pose in poses.items():
        assert np.array_equal(at(frame), pose), frame
    yield


def test_a_drag_on_a_keyed_frame_edits_its_pose_and_is_undone(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    poses = {frame: at(frame) for frame in (1, 49, 25)}
    bpy.ops.ed.undo_push(message="Frame")
    yield
    yield from window.hover(window.pixel(pin_place(1)))
    yield from window.press()
    yield from window.move((window.mouse[0], window.mouse[1] + 80), steps=4)
    yield from window.settled()
    assert moved(shown(), poses[25]) > 0.2
    yield from window.key("ESC")
    assert np.array_equal(shown(), poses[25])
    yield from pull(window, 0.0, 0.7)
    edited = shown()
    assert moved(edited, poses[25]) > 0.3
    assert not addon("scene.sequence.pose_state").unkeyed(active())
    yield from window.undo()
    assert np.array_equal(shown(), poses[25])
    yield from window.redo()
    assert np.array_equal(shown(), edited)
    assert np.array_equal(at(1), poses[1])
    assert np.array_equal(at(25), edited)
    yield


def test_a_drag_elsewhere_is_unkeyed_undone_redone_and_lost_with_the_frame(window: Window) -> Iterator[None]:
    pose_state = addon("scene.sequence.pose_state")
    yield from three_poses(window)
    between = at(13)
    bpy.ops.ed.undo_push(message="Frame")
    yield
    yield from pull(window, 0.0, 0.7)
    unkeyed = shown()
    assert pose_state.unkeyed(active())
    assert moved(unkeyed, between) > 0.3
    yield from window.wait(0.5)
    window.picture("unkeyed")
    yield from pull(window, 0.0, 0.2)
    second = shown()
    yield from window.undo()
    assert np.array_equal(shown(), unkeyed)
    yield from window.undo()
    assert np.array_equal(shown(), between)
    yield from window.redo()
    yield from window.redo()
    assert np.array_equal(shown(), second)
    yield from key_pose(window)
    assert np.array_equal(shown(), second)
    assert not pose_state.unkeyed(active())
    yield from window.undo()
    assert np.array_equal(shown(), second), "undoing the key leaves the pose that was keyed"
    assert pose_state.unkeyed(active())
    bpy.context.scene.frame_set(14)
    assert np.array_equal(at(13), between)
    yield


def test_auto_key_keys_what_was_dragged_in_one_step(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    between = at(13)
    bpy.ops.ed.undo_push(message="Frame")
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    yield
    yield from pull(window, 0.0, 0.7)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = False
    dragged = shown()
    assert np.array_equal(at(13), dragged)
    assert len(active().planar.poses) == 4
    yield
    yield from window.undo()
    assert len(active().planar.poses) == 3
    assert np.array_equal(at(13), between)
    yield


def test_one_undo_after_a_frame_change_brings_an_unkeyed_pose_back(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    yield from go_to(13)
    yield from pull(window, 0.0, 0.7)
    unkeyed = shown()
    for _ in range(3):
        yield from window.key("RIGHT_ARROW")
    yield
    assert bpy.context.scene.frame_current == 16
    assert not np.array_equal(shown(), unkeyed)
    yield from window.undo()
    assert bpy.context.scene.frame_current == 13
    assert np.array_equal(shown(), unkeyed)
    assert addon("scene.sequence.pose_state").unkeyed(active())
    yield from window.wait(0.3)
    window.picture("brought_back")
    assert np.array_equal(shown(), unkeyed), "nor does a redraw take it away"
    yield from window.undo()
    yield from window.redo()
    assert np.array_equal(shown(), unkeyed)
    yield from key_pose(window)
    assert np.array_equal(at(13), unkeyed)
    yield


def type_frame(window: Window, now: int, frame: int) -> Iterator[None]:
    """Type another frame where the list shows this one."""
    region = window.region("UI")
    for y in range(region.y + region.height - 40, region.y + 40, -10):
        yield from window.move((region.x + round(0.67 * region.width), y))
        bpy.context.window_manager.clipboard = ""
        yield from window.key("C", ctrl=True)
        with contextlib.suppress(ValueError):
            if float(bpy.context.window_manager.clipboard or "nan") == now:
                break
    else:
        raise AssertionError(f"the list shows no frame {now}")
    yield from window.release("LEFT_CTRL")
    yield from window.key("RET")
    yield from window.type(str(frame))
    yield from window.key("RET")
    yield from window.wait(0.3)


def test_frames_are_typed_into_the_list(window: Window) -> Iterator[None]:
    def frames() -> list[float]:
        return [pose.frame for pose in active().planar.poses]

    yield from three_poses(window)
    last = at(49)
    bpy.ops.ed.undo_push(message="Frame")
    yield from window.wait(0.3)
    yield from type_frame(window, 49, 13)
    assert frames() == [1, 13, 25]
    assert np.array_equal(at(13), last)
    yield from type_frame(window, 13, 40)
    assert frames() == [1, 25, 40]
    yield from window.undo()
    yield from window.wait(0.3)
    assert frames() == [1, 13, 25]
    before = stored()
    yield from type_frame(window, 13, 25)
    window.picture("refused")
    yield from window.key("ESC")  # the message
    assert stored() == before
    yield
