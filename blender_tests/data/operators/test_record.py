# SPDX-License-Identifier: GPL-3.0-or-later
"""Recorded motion from scripts, as the redo panel repeats it."""

import base64

import bpy
import numpy as np
import pytest
from support import add_end_pins, bar, coordinates, evaluated, measured


def packed(samples):
    return base64.b64encode(np.asarray(samples, "<f4").tobytes()).decode("ascii")


def wave(frames=20):
    """A sample for each frame: up and down again."""
    time = np.arange(frames + 1) / frames
    return np.stack([0.2 * time, 0.6 * np.sin(np.pi * time), 0 * time], axis=1)


def record(path, **options):
    return bpy.ops.planar.record_pins(path=packed(path), **options)


def keyed_frames(obj):
    from planar_deform.scene.sequence import pose_state

    return sorted(frame for pose in range(len(obj.planar.poses)) for frame in pose_state.frames_of(obj, pose))


def right_end(obj):
    """Where the right pin is: in the middle of its column."""
    return evaluated(obj)[38]


def test_each_frame_gets_the_pose_of_its_sample():
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    bpy.context.scene.frame_set(10)
    path = wave()
    assert record(path, smoothing=0.0) == {"FINISHED"}
    assert keyed_frames(obj) == list(range(10, 31))
    assert bpy.context.scene.frame_current == 30
    start = before[38]
    for frame in (10, 13, 20, 27, 30):
        bpy.context.scene.frame_set(frame)
        assert right_end(obj)[:2] - start[:2] == pytest.approx(path[frame - 10, :2], abs=5e-3)
        assert right_end(obj)[2] == start[2]
        assert measured(obj).flipped == 0
    bpy.context.scene.frame_set(10)
    assert evaluated(obj) == pytest.approx(before, abs=1e-5)


def test_a_frame_step_keys_fewer_poses_and_the_last():
    obj = bar()
    add_end_pins(obj)
    assert record(wave(10), frame_step=4) == {"FINISHED"}
    assert keyed_frames(obj) == [1, 5, 9, 11]


def test_smoothing_takes_a_spike_out():
    heights = {}
    for smoothing in (0.0, 2.0):
        obj = bar(name=f"Smooth{smoothing}")
        add_end_pins(obj)
        bpy.context.scene.frame_set(1)
        path = np.zeros((21, 3))
        path[10, 1] = 0.5
        assert record(path, smoothing=smoothing) == {"FINISHED"}
        bpy.context.scene.frame_set(11)
        heights[smoothing] = right_end(obj)[1] - 0.5
    assert heights[0.0] == pytest.approx(0.5, abs=5e-3)
    assert 0.0 < heights[2.0] < 0.15


def test_the_same_path_gives_the_same_bits():
    shapes = []
    for name in ("A", "B"):
        obj = bar(name=name)
        add_end_pins(obj)
        bpy.context.scene.frame_set(1)
        record(wave(8))
        shapes.append([coordinates(block.data) for block in obj.data.shape_keys.key_blocks])
    assert all(np.array_equal(a, b) for a, b in zip(*shapes, strict=True))


def test_pins_hold_the_last_pose_afterwards():
    obj = bar()
    add_end_pins(obj)
    record(wave(10))
    last = evaluated(obj)
    assert all(pin.has_target for pin in obj.planar.pins)
    assert np.array(obj.planar.pins[1].reached)[:2] == pytest.approx([2.2, 0.5], abs=5e-3)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.0)) == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(last, abs=5e-3)


def test_a_second_recording_starts_from_what_its_first_frame_shows():
    obj = bar()
    add_end_pins(obj)
    record(wave(10))
    bpy.context.scene.frame_set(6)
    there = evaluated(obj)
    assert record(-wave(10), smoothing=0.0) == {"FINISHED"}
    assert keyed_frames(obj) == list(range(1, 17))
    bpy.context.scene.frame_set(6)
    assert evaluated(obj) == pytest.approx(there, abs=2e-3)
    bpy.context.scene.frame_set(11)
    assert right_end(obj)[1] == pytest.approx(there[38, 1] - 0.6, abs=5e-3)


@pytest.mark.parametrize("text", ["", "nonsense"])
def test_without_a_path_nothing_changes(text):
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    with pytest.raises(RuntimeError, match="path"):
        bpy.ops.planar.record_pins(path=text)
    assert obj.data.shape_keys is None
    assert np.array_equal(coordinates(obj.data.vertices), before)


def test_a_refusal_leaves_frame_and_mesh(monkeypatch):
    from planar_deform.errors import Refusal
    from planar_deform.operators import record as operator

    def refuse(*_, **__):
        raise Refusal("that cannot be keyed")

    obj = bar()
    add_end_pins(obj)
    bpy.ops.planar.select_pins(action="NONE")
    bpy.context.scene.frame_set(7)
    with pytest.raises(RuntimeError, match="selected"):
        record(wave())
    assert bpy.context.scene.frame_current == 7
    assert obj.data.shape_keys is None
    obj.planar.pins[1].select = True
    monkeypatch.setattr(operator, "keying", refuse)
    with pytest.raises(RuntimeError, match="cannot be keyed"):
        record(wave())
    assert bpy.context.scene.frame_current == 7
    assert obj.data.shape_keys is None
    assert not obj.planar.pins[1].has_target


def left_end(obj):
    return evaluated(obj)[26]


def layered(**options):
    """The right end recorded, then the left one over it from frame 5 on; where both are in each frame."""
    obj = bar()
    add_end_pins(obj)
    bpy.context.scene.frame_set(1)
    assert record(wave(), smoothing=0.0) == {"FINISHED"}
    first = {}
    for frame in range(1, 22):
        bpy.context.scene.frame_set(frame)
        first[frame] = right_end(obj)
    bpy.context.scene.frame_set(5)
    for index, pin in enumerate(obj.planar.pins):
        pin.select = index == 0
    assert record(-wave(10), smoothing=0.0, **options) == {"FINISHED"}
    return obj, first


@pytest.mark.parametrize("step", [1, 3])
def test_recordings_add_up(step):
    obj, first = layered(frame_step=step)
    path = -wave(10)
    for frame in (*range(5, 15, step), 15):
        bpy.context.scene.frame_set(frame)
        assert right_end(obj) == pytest.approx(first[frame], abs=5e-3)
        assert left_end(obj)[:2] == pytest.approx(np.array([0.0, 0.5]) + path[frame - 5, :2], abs=5e-3)
    bpy.context.scene.frame_set(18)
    assert right_end(obj) == pytest.approx(first[18], abs=5e-3)


def test_one_that_overwrites_leaves_the_other_pins_where_they_are():
    obj, first = layered(overwrite=True)
    for frame in (5, 10, 15):
        bpy.context.scene.frame_set(frame)
        assert right_end(obj) == pytest.approx(first[5], abs=5e-3)


def test_layers_from_a_frame_that_is_shown_unkeyed_begin_there():
    obj, _ = layered()
    bpy.context.scene.frame_set(3)
    obj.planar.pins[0].select, obj.planar.pins[1].select = False, True
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.2)) == {"FINISHED"}
    assert record(np.zeros((6, 3)), smoothing=0.0) == {"FINISHED"}
    assert keyed_frames(obj) == list(range(1, 22))


def test_the_preview_range_is_the_range():
    from planar_deform.operators.record import _frames_left

    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 20
    scene.frame_set(5)
    assert _frames_left(scene) == 16
    scene.use_preview_range, scene.frame_preview_start, scene.frame_preview_end = True, 3, 9
    assert _frames_left(scene) == 5
    scene.frame_set(9)
    assert _frames_left(scene) is None


@pytest.mark.parametrize("again", [False, True])
def test_with_symmetry_the_other_side_is_recorded_too(again):
    """Also where there are poses: the partner goes on from where these have it."""
    obj = bar()
    add_end_pins(obj)
    before = evaluated(obj)
    if again:
        assert record(np.zeros((21, 3)), smoothing=0.0) == {"FINISHED"}
        bpy.context.scene.frame_set(1)
    obj.planar.use_mirror_x = True
    path = wave() * (-0.5, 1.0, 1.0)
    assert record(path, smoothing=0.0) == {"FINISHED"}
    for frame in (1, 6, 11, 21):
        bpy.context.scene.frame_set(frame)
        ways = (evaluated(obj) - before)[[26, 38], :2]
        assert ways[1] == pytest.approx(path[frame - 1, :2], abs=6e-3)
        assert ways[0] == pytest.approx(ways[1] * (-1.0, 1.0), abs=6e-3)
