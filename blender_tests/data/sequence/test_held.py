# SPDX-License-Identifier: GPL-3.0-or-later
"""On twos a pose may be keyed at a frame that only holds the one before: it is told which."""

import bpy
import numpy as np
import pytest
from sequences import go_to, key, pull, shown_at
from support import add_end_pins, bar, evaluated, pose


def told(obj):
    from planar_deform.scene.sequence.held import held

    return [(one.pose, one.frame, one.before, one.after) for one in held(obj)]


def sequence(*frames):
    obj = bar()
    add_end_pins(obj)
    for number, frame in enumerate(frames):
        pull(obj, frame, (0.0, 0.02 * (number + 1)))
    return obj


def test_a_pose_at_a_held_frame_is_not_shown_until_it_is_moved():
    obj = sequence(1, 12, 25)
    assert told(obj) == []
    bpy.ops.planar.step_poses(step=2)
    assert told(obj) == [(1, 12, 11, 13)]
    bpy.ops.planar.retime_pose(pose=1, frame=13)
    assert told(obj) == []


def test_what_is_told_is_what_is_seen():
    obj = sequence(*range(1, 30, 4), 31, 32)
    poses = [shown_at(obj, pose.frame) for pose in obj.planar.poses]
    for step in (2, 3, 4, 5):
        bpy.ops.planar.step_poses(step=step)
        seen = [shown_at(obj, frame) for frame in range(1, 45)]
        unseen = [
            index
            for index, pose in enumerate(poses)
            if not any(np.abs(shape - pose).max() < 1e-5 for shape in seen)
        ]
        assert [pose for pose, *_ in told(obj)] == unseen, step


def test_a_pose_that_is_held_long_enough_is_shown_late():
    obj = sequence(1, 12, 25)
    curve = _curve(obj)
    curve.keyframe_points[1].interpolation = "CONSTANT"
    bpy.ops.planar.step_poses(step=2)
    assert told(obj) == []


def test_a_pose_that_is_keyed_twice_is_shown_if_one_of_its_frames_is():
    obj = sequence(1, 12, 25)
    curve = _curve(obj)
    curve.keyframe_points.insert(19, curve.keyframe_points[1].co[1])
    bpy.ops.planar.step_poses(step=2)
    assert told(obj) == []


@pytest.mark.parametrize("how", ["mute", "remove"])
def test_without_steps_every_pose_is_shown(how):
    obj = sequence(1, 12, 25)
    bpy.ops.planar.step_poses(step=2)
    assert told(obj)
    modifier = _curve(obj).modifiers[0]
    if how == "mute":
        modifier.mute = True
    else:
        _curve(obj).modifiers.remove(modifier)
    assert told(obj) == []


def test_drawings_without_poses_hold_none():
    obj = bar()
    assert told(obj) == []
    key(obj, 1)
    assert told(obj) == []


def _curve(obj):
    from planar_deform.scene.sequence.pose_blocks import shown_curve

    return shown_curve(obj.data.shape_keys)


@pytest.mark.parametrize(("frame", "shown"), [(12, 11), (13, 13), (-2, -1), (30, 29)])
def test_a_pose_keyed_at_a_held_frame_is_keyed_where_it_is_shown(frame, shown):
    obj = sequence(1, 25)
    bpy.ops.planar.step_poses(step=2)
    go_to(frame)
    pose(obj, offset=(-0.2, 0.3))
    expected = evaluated(obj)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(expected, abs=1e-6), "it does not vanish under the hand"
    assert sorted(pose.frame for pose in obj.planar.poses) == sorted([1, 25, shown])
    assert told(obj) == []
    for at in (frame, shown):
        assert shown_at(obj, at) == pytest.approx(expected, abs=1e-6)


def test_a_pose_keyed_at_a_held_frame_replaces_the_one_that_is_held():
    obj = sequence(1, 11, 25)
    bpy.ops.planar.step_poses(step=2)
    go_to(12)
    pose(obj, offset=(-0.2, 0.3))
    expected = evaluated(obj)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert [pose.frame for pose in obj.planar.poses] == [1, 11, 25]
    assert shown_at(obj, 11) == pytest.approx(expected, abs=1e-6)


def test_auto_key_keys_where_it_is_shown_too(capfd):
    obj = sequence(1, 25)
    bpy.ops.planar.step_poses(step=3)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    go_to(12)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.2)) == {"FINISHED"}
    assert [pose.frame for pose in obj.planar.poses] == [1, 10, 25]
    assert "Keyed at frame 10" in capfd.readouterr().out
