# SPDX-License-Identifier: GPL-3.0-or-later
"""A point cache is out of date as soon as the poses show something else at its frames, and not before."""

import bpy
import pytest
from sequences import filled, go_to, key, write
from support import activate


@pytest.fixture
def baked(tmp_path):
    """A bar with poses at 1, 13 and 25 and in-betweens, of which frames 1 to 25 are in a cache."""
    obj = filled()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bake()
    obj.modifiers[0].show_viewport = False
    return obj


def bake():
    assert bpy.ops.planar.bake(to="POINT_CACHE", frame_start=1, frame_end=25) == {"FINISHED"}


def old(obj):
    from planar_deform.scene.motion.cache_age import is_out_of_date

    return is_out_of_date(obj)


def curve(obj):
    from planar_deform.scene.sequence.pose_blocks import shown_curve

    return shown_curve(obj.data.shape_keys)


def test_it_is_up_to_date_when_it_is_baked_and_when_only_other_things_change(baked):
    assert not old(baked)
    go_to(9)
    baked.location.x = 3.0
    baked.modifiers[0].show_viewport = True
    assert not old(baked)
    baked.modifiers[0].show_viewport = False
    write(baked, 5)  # shown until the frame changes, in no pose
    assert not old(baked)


def test_a_pose_changed_makes_it_out_of_date_until_it_is_baked_again(baked):
    go_to(13)
    write(baked, 7)
    assert old(baked)
    bake()
    assert not old(baked)


@pytest.mark.parametrize("what", ["retime", "ease", "step", "remove", "inbetweens"])
def test_so_does_whatever_changes_what_is_shown(baked, what):
    activate(baked)
    if what == "retime":
        bpy.ops.planar.retime_pose(pose=1, frame=14)
    elif what == "ease":
        curve(baked).keyframe_points[0].interpolation = "SINE"
    elif what == "step":
        bpy.ops.planar.step_poses(step=2)
    elif what == "remove":
        bpy.ops.planar.delete_pose(pose=1)
    else:
        bpy.ops.planar.remove_inbetweens()
    assert old(baked)


def test_what_is_keyed_behind_its_frames_does_not(baked):
    shown = baked.data.shape_keys.eval_time
    key(baked, 40, 3)
    assert baked.data.shape_keys.eval_time != shown
    assert not old(baked)


def test_it_is_told_after_the_file_was_saved_and_opened(baked):
    name, path = baked.name, bpy.data.filepath
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects[name]
    assert not old(obj)
    activate(obj)
    bpy.ops.planar.retime_pose(pose=1, frame=14)
    assert old(obj)


def test_without_poses_or_without_the_cache_nothing_is_out_of_date(baked):
    activate(baked)
    bpy.ops.planar.retime_pose(pose=1, frame=14)
    modifier = baked.modifiers[0]
    kept = modifier.filepath
    baked.modifiers.remove(modifier)
    assert not old(baked)
    baked.modifiers.new("Point Cache", "MESH_CACHE").filepath = kept
    assert old(baked)
    bpy.ops.planar.clear_poses()
    assert not old(baked)
