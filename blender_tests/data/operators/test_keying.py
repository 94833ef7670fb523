# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto-key: what it keys, and when it leaves a pose alone."""

import bpy
import pytest
from sequences import go_to, key
from support import add_end_pins, bar


@pytest.fixture
def posed():
    """A bar with one keyed pose, at another frame, with auto-key on."""
    obj = bar()
    add_end_pins(obj)
    key(obj, 1)
    go_to(13)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    return obj


def drag():
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.2)) == {"FINISHED"}


def only_active_keying_set(*paths):
    scene = bpy.context.scene
    scene.tool_settings.use_keyframe_insert_keyingset = True
    keying_set = scene.keying_sets.new(name="Mine")
    for owner, path in paths:
        keying_set.paths.add(owner, path)


def test_a_keying_set_without_the_poses_keeps_auto_key_from_them(posed):
    only_active_keying_set((posed, "location"), (posed.data.shape_keys, "use_relative"))
    drag()
    assert len(posed.planar.poses) == 1


def test_one_of_blender_s_own_keying_sets_keeps_auto_key_from_the_poses(posed):
    only_active_keying_set((posed.data.shape_keys, "eval_time"))
    bpy.context.scene.keying_sets_all.active = bpy.context.scene.keying_sets_all["Location"]
    drag()
    assert len(posed.planar.poses) == 1


def test_a_keying_set_with_the_curve_of_the_poses_lets_them_be_keyed(posed):
    only_active_keying_set((posed, "location"), (posed.data.shape_keys, "eval_time"))
    drag()
    assert len(posed.planar.poses) == 2


def test_without_an_active_keying_set_the_setting_means_nothing(posed):
    bpy.context.scene.tool_settings.use_keyframe_insert_keyingset = True
    drag()
    assert len(posed.planar.poses) == 2


def test_a_keying_set_that_is_not_asked_for_means_nothing(posed):
    only_active_keying_set((posed, "location"))
    bpy.context.scene.tool_settings.use_keyframe_insert_keyingset = False
    drag()
    assert len(posed.planar.poses) == 2


def test_a_drawing_without_poses_is_in_no_keying_set():
    obj = bar()
    add_end_pins(obj)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    only_active_keying_set((obj, "location"))
    drag()
    assert not obj.planar.poses
