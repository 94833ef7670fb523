# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses that are deleted or cleared, and keys, shape keys and actions that the user takes away."""

import bpy
import numpy as np
import pytest
from keyed_bars import frames, keyed_bar, names
from sequences import curve_of, go_to, key, same, shown_at, stored, timing, write
from support import add_end_pins, bar, evaluated, pose


def test_the_last_pose_gone_everything_is_as_before():
    obj = bar()
    add_end_pins(obj)
    pose(obj, offset=(0.1, 0.3))
    before = stored(obj)
    key(obj, 1, 0)
    key(obj, 25, 1)
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    after = stored(obj)
    # The pose of frame 1 was made in the mesh, before there was a sequence.
    assert after[1:] == before[1:]
    assert obj.data.shape_keys is None


@pytest.mark.parametrize("kind", ["mesh", "posed mesh", "unpinned", "Basis", "Pose", "half a Pose"])
def test_clearing_restores_what_was_there_to_the_bit(kind):
    obj = bar()
    if kind != "unpinned":
        add_end_pins(obj)
    if kind in {"Basis", "Pose", "half a Pose"}:
        obj.shape_key_add(name="Basis")
    if kind in {"posed mesh", "Pose", "half a Pose"}:
        pose(obj, offset=(0.1, 0.3))
    if kind == "half a Pose":
        obj.active_shape_key.value = 0.5
    before, shown, actions = stored(obj), evaluated(obj), len(bpy.data.actions)
    key(obj, 1)
    assert np.abs(evaluated(obj) - shown).max() < (1e-6 if "Pose" in kind else 1e-12)
    key(obj, 25, 3)
    key(obj, 13, 4)
    go_to(20)
    write(obj, 5)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(obj) == before
    assert same(evaluated(obj), shown)
    assert len(bpy.data.actions) == actions
    keys = obj.data.shape_keys
    assert keys is None or keys.animation_data is None
    key(obj, 3)  # and it can be begun again


def test_jumping_renaming_and_deleting():
    obj, shapes = keyed_bar((1, 25, 49.5))
    assert bpy.ops.planar.jump_to_pose(pose=2) == {"FINISHED"}
    assert bpy.context.scene.frame_current_final == 49.5
    assert obj.planar.active_pose == 2
    obj.planar.poses[1].name = "Reach"
    assert obj.data.shape_keys.key_blocks[3].name == "Reach"
    obj.data.shape_keys.key_blocks[2].name = "Stand"  # in Blender's own list
    assert bpy.ops.planar.delete_pose(pose=1) == {"FINISHED"}
    assert frames(obj) == [[1], [49.5]]
    assert [frame for frame, *_ in timing(obj)] == [1, 49.5]
    assert same(shown_at(obj, 1), shapes[1])
    assert same(shown_at(obj, 49.5), shapes[49.5])
    between = key(obj, 20, 6)
    assert same(shown_at(obj, 20), between)
    assert same(shown_at(obj, 49.5), shapes[49.5])
    with pytest.raises(RuntimeError, match="There is no pose 9"):
        bpy.ops.planar.jump_to_pose(pose=9)


def test_deleting_the_last_in_time_shows_the_one_before_it():
    obj, shapes = keyed_bar()
    go_to(60)
    write(obj, 5)
    assert bpy.ops.planar.delete_pose(pose=2) == {"FINISHED"}
    assert same(evaluated(obj), shapes[25])
    write(obj, 5)  # the hold is a copy of the new last pose
    curve_of(obj).keyframe_points[1].co[1] += 50.0
    assert np.abs(shown_at(obj, 60) - shapes[25]).max() < 1e-6


def test_a_pose_whose_key_or_block_is_gone():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points.remove(curve.keyframe_points[1])
    assert frames(obj) == [[1], [], [49]]
    with pytest.raises(RuntimeError, match="no key"):
        bpy.ops.planar.jump_to_pose(pose=1)
    obj.shape_key_remove(obj.data.shape_keys.key_blocks[names(obj)[2]])
    shape = key(obj, 30, 3)
    assert same(shown_at(obj, 30), shape)
    assert same(shown_at(obj, 1), shapes[1])
    assert len(obj.planar.poses) == 3
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None


def test_a_sequence_whose_action_was_deleted_is_keyed_again():
    obj, shapes = keyed_bar()
    obj.data.shape_keys.animation_data_clear()
    assert frames(obj) == [[], [], []]
    obj.data.shape_keys.eval_time = obj.planar.poses[1].at
    key(obj, 10)
    assert same(shown_at(obj, 10), shapes[25])
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None


def test_all_shape_keys_removed_by_the_user():
    from planar_deform.scene.sequence import pose_state

    obj, _ = keyed_bar()
    obj.shape_key_clear()
    assert not pose_state.is_ours(obj)
    shape = key(obj, 5, 1)
    assert names(obj) == ["Pose"]
    assert same(shown_at(obj, 5), shape)


def test_a_pose_without_a_key_is_deleted_and_the_others_are_shown_as_before():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points.remove(curve.keyframe_points[0])
    shown_at(obj, 25)
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    assert all(same(shown_at(obj, frame), shapes[frame]) for frame in (25, 49))
