# SPDX-License-Identifier: GPL-3.0-or-later
"""Pose sequences survive saving, undo, duplicating and renaming, and refuse what is not theirs."""

import bpy
import numpy as np
import pytest
from sequences import History, curve_of, go_to, key, pushed_down, same, shown_at, stored, write
from support import activate, add_end_pins, bar, coordinates, evaluated, from_library, pose


def keyed_bar():
    obj = bar()
    add_end_pins(obj)
    return obj, {frame: key(obj, frame, seed) for seed, frame in enumerate((1, 25, 49))}


def test_saved_and_loaded_again(tmp_path):
    obj, shapes = keyed_bar()
    before = stored(obj)
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    assert stored(obj) == before
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    activate(obj)
    go_to(25)
    edited = write(obj, 8)
    assert same(shown_at(obj, 25), edited)


def test_appended(tmp_path):
    obj, shapes = keyed_bar()
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.append(directory=f"{path}/Object/", filename="Cutout")
    obj = bpy.data.objects["Cutout"]
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    shape = key(obj, 13, 8)
    assert same(shown_at(obj, 13), shape)


def test_undo_and_redo():
    obj = bar()
    add_end_pins(obj)
    history = History()
    history.did(bpy.ops.planar.key_pose())
    bpy.context.scene.frame_set(25)
    history.did({"FINISHED"})
    history.did(bpy.ops.planar.drag_pins(offset=(0.0, 0.3)))
    history.did(bpy.ops.planar.key_pose())
    history.did(bpy.ops.planar.drag_pins(offset=(0.0, 0.3)))
    bpy.context.scene.frame_set(13)
    history.did({"FINISHED"})
    history.did(bpy.ops.planar.drag_pins(offset=(0.0, 0.3)))
    history.did(bpy.ops.planar.key_pose())
    history.did(bpy.ops.planar.delete_pose(pose=0))
    history.did(bpy.ops.planar.clear_poses())
    history.undo_all()
    history.redo_all()


def test_one_undo_of_a_frame_change_brings_an_unkeyed_pose_back():
    obj, _ = keyed_bar()
    go_to(13)
    bpy.ops.ed.undo_push(message="Frame")
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.3)) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Drag")
    shape = evaluated(obj)
    for frame in (17, 25):
        go_to(frame)
        bpy.ops.ed.undo_push(message="Frame")
    for _ in range(2):
        bpy.ops.ed.undo()
    assert bpy.context.scene.frame_current == 13
    obj = bpy.data.objects["Cutout"]
    assert same(evaluated(obj), shape)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert same(shown_at(obj, 13), shape)


@pytest.mark.parametrize("copied_actions", [True, False])
def test_a_duplicate_has_its_own_poses(copied_actions):
    obj, shapes = keyed_bar()
    bpy.context.preferences.edit.use_duplicate_action = copied_actions
    activate(obj)
    bpy.ops.object.duplicate()
    bpy.context.preferences.edit.use_duplicate_action = True
    twin = bpy.context.object
    assert twin != obj
    new = key(twin, 13, 9)
    assert all(same(shown_at(twin, frame), shape) for frame, shape in {**shapes, 13: new}.items())
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert len(curve_of(obj).keyframe_points) == 3
    bpy.ops.planar.clear_poses()
    assert twin.data.shape_keys is None
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_renaming_and_deleting_objects():
    obj, _ = keyed_bar()
    obj.name = obj.data.name = "Hero"
    shape = key(obj, 13, 5)
    assert same(shown_at(obj, 13), shape)
    other = bar(name="Cutout")
    add_end_pins(other)
    key(other, 3, 1)
    bpy.data.objects.remove(obj)
    assert same(shown_at(other, 3), coordinates(other.data.shape_keys.key_blocks[2].data))


def test_a_shared_mesh_is_refused():
    obj, _ = keyed_bar()
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    activate(obj)
    assert not bpy.ops.planar.key_pose.poll()
    assert not bpy.ops.planar.clear_poses.poll()


def refused(obj):
    """The refusal of keying; nothing has changed and nothing can be keyed."""
    from planar_deform.scene.sequence import pose_state

    activate(obj)
    before = stored(obj)
    reason = pose_state.refusal(obj)
    assert reason is not None
    assert not bpy.ops.planar.key_pose.poll()
    assert stored(obj) == before
    return reason


def test_shape_keys_of_the_users_own_are_refused():
    obj = bar()
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile")
    assert "Smile" in refused(obj)
    obj.data.shape_keys.key_blocks["Smile"].name = "Pose"
    obj.shape_key_add(name="Frown")
    assert "Frown" in refused(obj)
    obj.data.shape_keys.use_relative = False
    assert "absolute" in refused(obj)


def test_drivers_actions_and_tracks_are_refused():
    obj = bar()
    obj.shape_key_add(name="Basis")
    block = obj.shape_key_add(name="Pose")
    block.driver_add("value")
    assert "drivers" in refused(obj)
    block.driver_remove("value")
    block.keyframe_insert("value", frame=1)
    assert "action" in refused(obj)
    animation = obj.data.shape_keys.animation_data
    track = animation.nla_tracks.new()
    track.strips.new("Strip", 1, animation.action)
    animation.action = None
    assert "Nonlinear" in refused(obj)


def test_foreign_animation_added_to_a_sequence_is_refused():
    obj, shapes = keyed_bar()
    keys = obj.data.shape_keys
    keys.key_blocks[2].keyframe_insert("value", frame=1)
    assert "action" in refused(obj)
    from planar_deform import compat

    curves = compat.curves_of(keys.animation_data)
    curves.remove(next(curve for curve in curves if curve.data_path != "eval_time"))
    obj.show_only_shape_key = True
    assert "Lock" in refused(obj)
    obj.show_only_shape_key = False
    keys.driver_add("eval_time")
    assert "drivers" in refused(obj)
    keys.driver_remove("eval_time")
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_a_curve_that_cannot_be_keyed_is_refused():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    curve.lock = True
    assert "locked" in refused(obj)
    curve.lock = False
    curve.convert_to_samples(1, 50)
    assert "samples" in refused(obj)
    curve.convert_to_keyframes(1, 50)
    key(obj, 13, 3)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_a_sequence_made_relative_is_refused_until_it_is_absolute_again():
    from planar_deform.scene.objects.cutout_object import pose_refusal

    obj, shapes = keyed_bar()
    obj.data.shape_keys.use_relative = True
    assert "turn off Relative" in refused(obj)
    assert "turn off Relative" in pose_refusal(obj)
    obj.data.shape_keys.use_relative = False
    assert pose_refusal(obj) is None
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_subdividing_during_a_sequence():
    obj, shapes = keyed_bar()
    activate(obj)
    go_to(25)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(obj.data.vertices) == 25 * 9
    for frame, shape in shapes.items():
        assert same(shown_at(obj, frame)[:65], shape)
    go_to(25)
    pose(obj, offset=(0.0, 0.2))
    dragged = evaluated(obj)
    assert same(shown_at(obj, 1)[:65], shapes[1])
    assert same(shown_at(obj, 25), dragged)
    shape = key(obj, 13, 4)
    assert same(shown_at(obj, 13), shape)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert same(coordinates(obj.data.vertices)[:65], shapes[1])  # which was made in the mesh


def test_shape_keys_that_the_user_adds_to_a_sequence_do_not_come_in_its_way():
    obj, shapes = keyed_bar()
    before = len(obj.data.shape_keys.key_blocks)
    go_to(60)
    write(obj, 5)
    obj.shape_key_add(name="Above the scratch", from_mix=True)
    go_to(60)
    write(obj, 6)
    curve_of(obj).keyframe_points[2].co[1] += 100.0  # overshoots into the hold
    assert np.abs(shown_at(obj, 49) - shapes[49]).max() < 1e-6
    curve_of(obj).keyframe_points[2].co[1] -= 100.0
    obj.shape_key_add(name="Behind the poses", from_mix=True)
    assert len(obj.data.shape_keys.key_blocks) == before + 4
    shapes[37] = key(obj, 37, 7)
    shapes[80] = key(obj, 80, 8)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None
    assert same(coordinates(obj.data.vertices), shapes[1])  # which was made in the mesh


def test_a_locked_pose_is_not_written():
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    obj, shapes = keyed_bar()
    obj.data.shape_keys.key_blocks[3].lock_shape = True
    go_to(25)
    with pytest.raises(Refusal, match="locked"):
        begin(bpy.context)
    assert same(evaluated(obj), shapes[25])


def test_linked_poses_are_refused_and_shown(tmp_path):
    obj, shapes = keyed_bar()
    obj = from_library(tmp_path)
    activate(obj)
    assert not bpy.ops.planar.key_pose.poll()
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_edit_mode_on_a_keyed_pose():
    obj, shapes = keyed_bar()
    activate(obj)
    bpy.ops.planar.jump_to_pose(pose=1)
    assert obj.active_shape_key.name == obj.planar.poses[1].name
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.5, 0, 0))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.abs(shown_at(obj, 25) - shapes[25] - [0.5, 0, 0]).max() < 1e-6
    assert same(shown_at(obj, 1), shapes[1])


def test_scaling_applied_to_the_object_scales_all_poses():
    obj, shapes = keyed_bar()
    activate(obj)
    obj.scale = (2, 2, 2)
    bpy.ops.object.transform_apply(scale=True)
    for frame, shape in shapes.items():
        assert np.abs(shown_at(obj, frame) - 2.0 * shape).max() < 1e-6
    go_to(25)
    pose(obj, offset=(0.0, 0.2))
    assert np.abs(evaluated(obj) - 2.0 * shapes[25]).max() > 0.1
    assert np.abs(shown_at(obj, 1) - 2.0 * shapes[1]).max() < 1e-6


@pytest.mark.parametrize(("start", "scale"), [(None, 1.0), (101, 1.0), (11, 2.0)])
def test_a_sequence_pushed_down_is_listed_where_its_strip_plays_it(start, scale):
    from planar_deform.scene.sequence import pose_state

    obj, shapes = keyed_bar()
    before = {frame: shown_at(obj, frame) for frame in (1, 13, 25, 49)}
    pushed_down(obj, start=start, scale=scale)
    at = {frame: (start or 1) + (frame - 1) * scale for frame in before}
    frames = [pose_state.frames_of(obj, pose) for pose in range(3)]
    assert frames == [[at[frame]] for frame in shapes]
    assert [pose.frame for pose in obj.planar.poses] == [at[frame] for frame in shapes]
    for frame, shape in before.items():
        assert shown_at(obj, at[frame]) == pytest.approx(shape, abs=1e-5)
        assert pose_state.shape_at(obj, at[frame]) == pytest.approx(shape, abs=1e-5)
    assert pose_state.pose_at(obj, at[25]) == 1


def test_the_remedy_for_a_sequence_pushed_down_loses_nothing():
    from planar_deform import compat

    obj, shapes = keyed_bar()
    before = stored(obj)
    animation = obj.data.shape_keys.animation_data
    name, slot = animation.action.name, compat.slot_of(animation)
    pushed_down(obj)
    activate(obj)
    go_to(25)
    for operator in ("key_pose", "generate_inbetweens", "drag_pins", "delete_pose", "step_poses"):
        with pytest.raises(RuntimeError, match=f"choose the action '{name}'"):
            getattr(bpy.ops.planar, operator)()
    obj.planar.poses[1].frame = 30
    compat.assign_action(animation, bpy.data.actions[name], slot)
    animation.nla_tracks.remove(animation.nla_tracks[0])
    go_to(49)
    assert stored(obj) == before
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert same(shown_at(obj, 13), key(obj, 13))
