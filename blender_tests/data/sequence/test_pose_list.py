# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of poses: retimed, also past one another, updated, duplicated, renamed, shown on twos."""

import bpy
import numpy as np
import pytest
from filling import bent_bar, everything, frames_shown, generate, remove, shown, stale
from sequences import curve_of, go_to, same, timing, write
from support import activate, bar, evaluated


def names(obj):
    return [pose.name for pose in obj.planar.poses]


def times(obj):
    return [pose.frame for pose in obj.planar.poses]


def refused(match, operator, **options):
    with pytest.raises(RuntimeError, match=match):
        operator(**options)


def test_the_frame_of_a_pose_is_that_of_its_first_key():
    obj, _ = bent_bar((1, 25.5, 49))
    assert times(obj) == [1, 25.5, 49]
    curve = curve_of(obj)
    curve.keyframe_points.insert(60, curve.keyframe_points[0].co[1])
    assert times(obj) == [1, 25.5, 49]
    curve.keyframe_points[0].co[0] = -3
    curve.update()
    assert times(obj) == [-3, 25.5, 49]


@pytest.mark.parametrize("filled", [False, True])
def test_a_pose_that_is_retimed_between_its_neighbours_takes_its_key_along(filled):
    obj, poses = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points[1].interpolation = "BEZIER"
    for point in curve.keyframe_points:
        point.handle_left_type = point.handle_right_type = "FREE"
    curve.keyframe_points[1].handle_right = (30.0, curve.keyframe_points[1].co[1] + 1.0)
    if filled:
        generate(obj)
    handle = curve.keyframe_points[1].handle_right[1] - curve.keyframe_points[1].co[1]
    obj.planar.poses[1].frame = 40
    assert [frame for frame, *_ in timing(obj)] == [1, 40, 49]
    point = curve_of(obj).keyframe_points[1]
    assert point.interpolation == "BEZIER"
    assert point.handle_right[0] == pytest.approx(45.0)
    assert point.handle_right[1] - point.co[1] == pytest.approx(handle)
    for old, new in ((1, 1), (25, 40), (49, 49)):
        assert same(shown(obj, new), poses[old])
    assert stale(obj) == []
    assert names(obj) == ["Pose", "Pose.001", "Pose.002"]


@pytest.mark.parametrize("filled", [False, True])
@pytest.mark.parametrize(
    ("pose", "frame", "order"),
    [(0, 30, [1, 0, 2]), (0, 60, [1, 2, 0]), (2, 10, [0, 2, 1]), (2, -4, [2, 0, 1]), (1, 70, [0, 2, 1])],
)
def test_a_pose_that_is_retimed_past_others_is_played_in_their_order(pose, frame, order, filled):
    obj, poses = bent_bar()
    curve_of(obj).keyframe_points[pose].interpolation = "SINE"
    if filled:
        generate(obj)
    before = names(obj)
    activate(obj)
    assert bpy.ops.planar.retime_pose(pose=pose, frame=frame) == {"FINISHED"}
    assert names(obj) == [before[index] for index in order]
    shapes = list(poses.values())
    assert times(obj) == sorted(times(obj))
    for index, at in zip(order, times(obj), strict=True):
        assert same(shown(obj, at), shapes[index])
    values = [value for _, value, _ in timing(obj)]
    assert values == sorted(values)
    moved = order.index(pose)
    assert timing(obj)[moved][2] == "SINE"
    if filled:
        assert stale(obj) != []
        generate(obj)
        assert stale(obj) == []
    keys = obj.data.shape_keys
    assert all(keys.key_blocks[p.name].frame == pytest.approx(p.at) for p in obj.planar.poses)


def test_retiming_through_the_list_and_back_is_as_before():
    obj, poses = bent_bar()
    go_to(1)
    before = everything(obj)
    for frame in (30, 60, 48, 26, 25):
        obj.planar.poses[names(obj).index("Pose.001")].frame = frame
    go_to(1)
    assert [row[:-1] if index == 8 else row for index, row in enumerate(everything(obj))][:4] == before[:4]
    assert timing(obj) == [(1.0, 1024.0, "LINEAR"), (25.0, 1032.0, "LINEAR"), (49.0, 1040.0, "LINEAR")]
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())


def test_a_frame_that_has_a_key_is_refused():
    obj, _poses = bent_bar()
    before = everything(obj)
    refused("Frame 49 has a key", bpy.ops.planar.retime_pose, pose=0, frame=49)
    refused("no pose 7", bpy.ops.planar.retime_pose, pose=7, frame=60)
    assert everything(obj) == before
    obj.planar.poses[0].frame = 49  # the number simply stays
    assert times(obj) == [1, 25, 49]
    assert everything(obj) == before
    assert bpy.ops.planar.retime_pose(pose=1, frame=25) == {"FINISHED"}
    assert everything(obj) == before


def test_a_pose_that_is_shown_twice_is_retimed_where_it_is_first():
    obj, poses = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points.insert(60, curve.keyframe_points[0].co[1])
    curve.update()
    obj.planar.poses[0].frame = 30
    assert [frame for frame, *_ in timing(obj)] == [25, 30, 49, 60]
    assert same(shown(obj, 30), poses[1])
    assert same(shown(obj, 60), poses[1])
    assert same(shown(obj, 25), poses[25])


def test_a_pose_without_a_key_is_keyed_by_retiming_it():
    obj, poses = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points.remove(curve.keyframe_points[1])
    assert obj.planar.poses[1].frame == 0.0
    obj.planar.poses[1].frame = 60
    assert names(obj) == ["Pose", "Pose.002", "Pose.001"]
    assert same(shown(obj, 60), poses[25])
    assert same(shown(obj, 49), poses[49])


@pytest.mark.parametrize("operator", ["retime_pose", "update_pose", "duplicate_pose"])
def test_a_pose_whose_shape_key_has_been_removed_is_refused(operator):
    obj, _ = bent_bar()
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Pose.001"])
    activate(obj)
    go_to(60)
    before = everything(obj)
    refused("of pose 'Pose.001' is gone: delete the pose", getattr(bpy.ops.planar, operator), pose=1)
    assert everything(obj) == before


def test_a_locked_curve_is_not_retimed():
    obj, _ = bent_bar()
    curve_of(obj).lock = True
    before = everything(obj)
    obj.planar.poses[1].frame = 30
    assert everything(obj) == before
    assert not bpy.ops.planar.retime_pose.poll()
    assert not bpy.ops.planar.step_poses.poll()


def test_updating_makes_a_pose_what_is_shown():
    obj, poses = bent_bar()
    generate(obj)
    go_to(13)
    unkeyed = write(obj, 4)
    assert bpy.ops.planar.update_pose(pose=2) == {"FINISHED"}
    assert same(evaluated(obj), unkeyed)  # it still is shown
    assert same(shown(obj, 49), unkeyed)
    assert stale(obj) == [(1, 2)]
    assert same(shown(obj, 1), poses[1])
    go_to(1)
    obj.planar.active_pose = 1
    assert bpy.ops.planar.update_pose() == {"FINISHED"}
    assert same(shown(obj, 25), poses[1])
    obj.data.shape_keys.key_blocks["Pose.002"].lock_shape = True
    before = everything(obj)
    refused("locked", bpy.ops.planar.update_pose, pose=2)
    assert everything(obj) == before


def test_duplicating_keys_a_pose_once_more_as_one_of_its_own():
    obj, poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    go_to(73)
    assert bpy.ops.planar.duplicate_pose(pose=0) == {"FINISHED"}
    assert times(obj) == [1, 25, 49, 73]
    assert same(shown(obj, 73), poses[1])
    for frame, seen in before.items():
        assert np.abs(shown(obj, frame) - seen).max() < 1e-6
    go_to(73)
    edited = write(obj, 3)
    assert same(shown(obj, 1), poses[1])
    assert same(shown(obj, 73), edited)
    at = everything(obj)
    refused("Frame 25 has a key", bpy.ops.planar.duplicate_pose, pose=0, frame=25)
    assert everything(obj) == at


def test_on_twos_every_second_frame_is_shown_and_held():
    from planar_deform.scene.sequence import pose_list

    obj, poses = bent_bar((2, 26, 51))
    generate(obj)
    ones = frames_shown(obj, range(2, 52))
    assert pose_list.step_of(obj) == 1
    assert bpy.ops.planar.step_poses() == {"FINISHED"}
    assert pose_list.step_of(obj) == 2
    for frame in range(2, 50):
        assert np.abs(shown(obj, frame) - ones[frame - frame % 2]).max() < 1e-6
    assert same(shown(obj, 26), poses[26])
    go_to(31)
    posed = write(obj, 5)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}  # at a frame that shows the one before
    assert times(obj) == [2, 26, 30, 51]
    assert bpy.ops.planar.step_poses(step=3) == {"FINISHED"}
    assert len(curve_of(obj).modifiers) == 1
    assert bpy.ops.planar.step_poses(step=1) == {"FINISHED"}
    assert len(curve_of(obj).modifiers) == 0
    assert np.abs(shown(obj, 30) - posed).max() < 1e-6
    for frame in (*range(2, 30), *range(31, 52)):
        assert np.abs(shown(obj, frame) - ones[frame]).max() < 1e-5


def test_twos_do_not_take_an_unkeyed_pose_away():
    obj, _ = bent_bar()
    go_to(13)
    unkeyed = write(obj, 5)
    assert bpy.ops.planar.step_poses() == {"FINISHED"}
    assert same(evaluated(obj), unkeyed)
    obj.planar.poses[1].frame = 30
    assert same(evaluated(obj), unkeyed)
    obj.planar.poses[1].frame = 60
    assert same(evaluated(obj), unkeyed)


def test_names_of_poses_are_those_of_their_shape_keys():
    obj, _ = bent_bar()
    obj.planar.poses[0].name = "Basis"
    assert names(obj) == ["Basis.001", "Pose.001", "Pose.002"]
    obj.planar.poses[1].name = "ä" * 60
    generate(obj)
    blocks = [block.name for block in obj.data.shape_keys.key_blocks]
    assert len(set(blocks)) == len(blocks)
    assert names(obj)[1] in blocks
    remove(obj)
    assert len(obj.data.shape_keys.key_blocks) == 5


def test_the_operators_ask_for_poses():
    obj = bar()
    activate(obj)
    for name in ("update_pose", "duplicate_pose", "retime_pose", "step_poses"):
        assert not getattr(bpy.ops.planar, name).poll()


def test_jumping_after_filling():
    obj, poses = bent_bar((1, 25.5, 49))
    generate(obj)
    activate(obj)
    assert bpy.ops.planar.jump_to_pose(pose=1) == {"FINISHED"}
    assert bpy.context.scene.frame_current_final == 25.5
    assert same(evaluated(obj), poses[25.5])
    assert obj.active_shape_key.name == "Pose.001"


def test_what_the_list_shows_cannot_be_animated():
    obj, _ = bent_bar()
    pose = obj.planar.poses[1]
    for owner, name in ((pose, "frame"), (pose, "turns"), (obj.planar, "smooth")):
        assert not owner.bl_rna.properties[name].is_animatable


def test_a_frame_typed_past_another_pose_moves_no_pose_in_memory():
    obj, poses = bent_bar()
    generate(obj)
    obj.planar.poses[1].turns = 1
    listed = list(obj.planar.poses)
    places = [pose.as_pointer() for pose in listed]
    listed[2].frame = 13
    assert times(obj) == [1, 13, 25]
    assert [pose.as_pointer() for pose in obj.planar.poses] == places
    assert [pose.frame for pose in listed] == [1, 13, 25]  # Blender's own pointers are as good as these
    assert [pose.turns for pose in listed] == [0, 0, 1]
    assert same(shown(obj, 13), poses[49])
    assert same(shown(obj, 25), poses[25])


def test_a_frame_that_is_refused_says_why(capsys):
    obj, _ = bent_bar()
    before = everything(obj)
    obj.planar.poses[2].frame = 25
    assert "Frame 25 has a key" in capsys.readouterr().out
    curve_of(obj).lock = True
    obj.planar.poses[2].frame = 30
    assert "locked" in capsys.readouterr().out
    curve_of(obj).lock = False
    assert everything(obj) == before
