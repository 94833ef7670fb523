# SPDX-License-Identifier: GPL-3.0-or-later
"""What users do to generated in-betweens with Blender's own tools: nothing is lost, and poses stay exact."""

import bpy
import numpy as np
import pytest
from outlines import lines
from sequences import curve_of, go_to, key, same, shown_at, stored, timing, write
from support import activate, bar, coordinates, evaluated

FRAMES = (1, 9, 21)


@pytest.fixture(params=["bar", "edge soup", "3D curve"])
def generated(request):
    """An object with three poses and in-betweens, what its keyed frames show, how it was without those."""
    obj = bar(nx=6, ny=2) if request.param == "bar" else lines(request.param)
    shapes = {frame: key(obj, frame, seed) for seed, frame in enumerate(FRAMES)}
    before = stored(obj)
    generate()
    go_to(FRAMES[-1])
    return obj, shapes, before


def generate():
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}


def exact(obj, shapes):
    return all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def stale(obj):
    from planar_deform.scene.sequence import stretches

    return stretches.stale(obj)


def block_of(obj, pose):
    return obj.data.shape_keys.key_blocks[obj.planar.poses[pose].name]


def edit(obj, command):
    """An operator of Edit Mode on all that there is."""
    activate(obj)
    edits = bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve
    bpy.ops.object.mode_set(mode="EDIT")
    edits.select_all(action="SELECT")
    getattr(edits, command)()
    bpy.ops.object.mode_set(mode="OBJECT")


def test_points_added(generated):
    obj, shapes, _ = generated
    count = len(shapes[1])
    go_to(9)
    edit(obj, "subdivide")
    assert len(evaluated(obj)) > count
    assert stale(obj) == [(0, 1), (1, 2)]
    now = {frame: shown_at(obj, frame) for frame in FRAMES}
    for frame, shape in shapes.items():
        assert {*map(tuple, shape)} <= {*map(tuple, now[frame])}
    generate()
    assert stale(obj) == []
    assert exact(obj, now)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None
    assert len(evaluated(obj)) == len(now[1])


def test_a_generated_shape_removed(generated):
    obj, shapes, before = generated
    keys = obj.data.shape_keys.key_blocks
    obj.shape_key_remove(keys[keys.find(block_of(obj, 1).name) + 3])
    assert stale(obj) == [(1, 2)]
    assert exact(obj, shapes)
    shapes[25] = key(obj, 25, 8)
    assert exact(obj, shapes)
    assert bpy.ops.planar.delete_pose(pose=3) == {"FINISHED"}
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    go_to(FRAMES[-1])
    assert stored(obj) == before


def test_a_generated_shape_removed_from_an_edited_stretch(generated):
    obj, shapes, _ = generated
    go_to(13)
    write(obj, 7)
    posed = evaluated(obj)
    assert bpy.ops.planar.edit_sequence(keep_poses=True) == {"FINISHED"}
    keys = obj.data.shape_keys.key_blocks
    obj.shape_key_remove(keys[keys.find(block_of(obj, 1).name) + 2])  # of frame 11
    assert stale(obj) == []
    generate()  # leaves the edit alone
    assert stale(obj) == []
    assert same(shown_at(obj, 13), posed)
    assert exact(obj, shapes)


def test_a_pose_removed_from_blenders_list(generated):
    obj, shapes, _ = generated
    obj.shape_key_remove(block_of(obj, 1))
    del shapes[9]
    assert exact(obj, shapes)
    assert stale(obj)
    generate()
    assert exact(obj, shapes)
    assert stale(obj) == []
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert exact(obj, shapes)
    assert len(obj.data.shape_keys.key_blocks) == 2 + len(obj.planar.poses)


def test_a_key_removed_and_one_put_in_between(generated):
    obj, shapes, _ = generated
    curve = curve_of(obj)
    curve.keyframe_points.remove(curve.keyframe_points[1])
    curve.keyframe_points.insert(5, block_of(obj, 0).frame + 8.0 * 3)  # the third of seven in-betweens
    curve.update()
    del shapes[9]
    assert exact(obj, shapes)
    generate()
    assert exact(obj, shapes)


def test_renamed_shape_keys(generated):
    obj, shapes, _ = generated
    blocks = obj.data.shape_keys.key_blocks
    blocks["Basis"].name = "Ruhe"
    blocks["Before Poses"].name = "Pose"
    for block in blocks:
        if block.name.endswith("+2"):
            block.name = "ß" * 31  # as long as names can be
    obj.planar.poses[1].name = "Ruhe"  # taken
    assert len({pose.name for pose in obj.planar.poses}) == 3
    generate()
    shapes[5] = key(obj, 5, 9)
    assert exact(obj, shapes)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None


def test_the_action_unlinked(generated):
    obj, shapes, _ = generated
    obj.data.shape_keys.animation_data_clear()
    assert not bpy.ops.planar.generate_inbetweens.poll()
    for pose, frame in enumerate(FRAMES):
        obj.data.shape_keys.eval_time = obj.planar.poses[pose].at
        assert same(evaluated(obj), shapes[frame])
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None


def test_drivers_tracks_and_locks_are_refused_by_all_and_change_nothing(generated):
    obj, shapes, _ = generated
    keys = obj.data.shape_keys

    def refused():
        now = stored(obj)
        names = ("key_pose", "generate_inbetweens", "remove_inbetweens", "clear_poses")
        assert not any(getattr(bpy.ops.planar, name).poll() for name in names)
        assert stored(obj) == now

    keys.driver_add("eval_time")
    refused()
    keys.driver_remove("eval_time")
    obj.show_only_shape_key = True
    refused()
    obj.show_only_shape_key = False
    track = keys.animation_data.nla_tracks.new()
    refused()
    keys.animation_data.nla_tracks.remove(track)
    assert exact(obj, shapes)


@pytest.mark.parametrize("place", [0, 1])
def test_a_duplicate_has_its_own_in_betweens(generated, place):
    obj, shapes, _ = generated
    activate(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    go_to(FRAMES[place])
    write(twin, 7)
    shape = evaluated(twin)
    assert stale(twin)
    assert stale(obj) == []
    middle = shown_at(obj, 5)
    generate()
    assert same(shown_at(twin, FRAMES[place]), shape)
    assert same(shown_at(obj, 5), middle)
    assert exact(obj, shapes)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert exact(obj, shapes)
    assert len(timing(obj)) == 3


def test_appended_twice(generated, tmp_path):
    _, shapes, _ = generated
    path = tmp_path / "file.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for _ in range(2):
        bpy.ops.wm.append(directory=str(path / "Object/"), filename="Cutout")
    first, second = (bpy.data.objects[name] for name in ("Cutout", "Cutout.001"))
    activate(second)
    assert stale(second) == []
    go_to(9)
    write(second, 5)
    generate()
    assert exact(first, shapes)
    del shapes[9]
    assert exact(second, shapes)


@pytest.mark.parametrize("scale", [(3.0, 0.5, 1.0), (-1.0, 1.0, 1.0), (-2.0, -2.0, -2.0)])
def test_a_scale_changed_after_generating(generated, scale):
    obj, shapes, before = generated
    obj.scale = scale
    generate()
    assert exact(obj, shapes)
    for frame in range(1, 22):
        shape = shown_at(obj, frame)
        assert np.isfinite(shape).all()
        assert np.abs(shape - shapes[1]).max() < 1.0  # poses differ by 0.02 in either coordinate
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert stored(obj) == before


def test_a_pose_that_is_not_made_of_numbers(generated):
    obj, shapes, _ = generated
    block_of(obj, 1).data[0].co.x = np.nan
    now = stored(obj)
    with pytest.raises(RuntimeError, match="not numbers"):
        bpy.ops.planar.generate_inbetweens()
    assert str(stored(obj)) == str(now)
    assert bpy.ops.planar.delete_pose(pose=1) == {"FINISHED"}
    generate()
    del shapes[9]
    assert exact(obj, shapes)


def test_a_pose_in_one_point_and_one_far_away(generated):
    obj, shapes, before = generated
    points = coordinates(block_of(obj, 1).data)
    block_of(obj, 1).data.foreach_set("co", np.zeros(points.size, np.float32))
    generate()
    assert all(np.isfinite(shown_at(obj, frame)).all() for frame in range(1, 22))
    block_of(obj, 1).data.foreach_set("co", (points * np.float32([1e6, 1e6, 1.0])).ravel())
    generate()
    assert all(np.isfinite(shown_at(obj, frame)).all() for frame in range(1, 22))
    block_of(obj, 1).data.foreach_set("co", points.ravel())
    assert exact(obj, shapes)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    go_to(FRAMES[-1])
    assert stored(obj) == before


def test_in_betweens_are_removed_where_the_shown_pose_is_not_flat(generated):
    obj, shapes, _ = generated
    for point in block_of(obj, 2).data:
        point.co.z += 0.4 * point.co.x**2
    go_to(21)
    with pytest.raises(RuntimeError, match="planes"):
        bpy.ops.planar.generate_inbetweens()
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    del shapes[21]
    assert exact(obj, shapes)


def test_a_pose_outside_of_the_plane_is_reached_in_depth(generated):
    obj, shapes, _ = generated
    for point in block_of(obj, 2).data:
        point.co.z += 0.5
    go_to(1)
    generate()
    low, high = shown_at(obj, 9)[:, 2], shown_at(obj, 21)[:, 2]
    assert shown_at(obj, 15)[:, 2] == pytest.approx((low + high) / 2, abs=1e-6)
    assert all(same(shown_at(obj, frame), shapes[frame]) for frame in (1, 9))


def test_a_new_pose_with_the_name_of_one_that_others_repeated():
    obj = bar(nx=6, ny=2)
    key(obj, 1, 0)
    key(obj, 9, 1)
    curve = curve_of(obj)
    curve.keyframe_points.insert(17, curve.keyframe_points[0].co[1])  # a loop
    curve.update()
    generate()
    loop = shown_at(obj, 17)
    assert [pose.copy_of for pose in obj.planar.poses] == ["", "", "Pose"]
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    key(obj, 5, 6)
    assert "Pose" in [pose.name for pose in obj.planar.poses]
    generate()
    assert same(shown_at(obj, 17), loop)


def test_a_pose_that_others_repeat_removed_from_blenders_list():
    obj = bar(nx=6, ny=2)
    key(obj, 1, 0)
    key(obj, 9, 1)
    curve = curve_of(obj)
    curve.keyframe_points.insert(17, curve.keyframe_points[0].co[1])  # a loop
    curve.update()
    generate()
    loop = shown_at(obj, 17)
    obj.shape_key_remove(block_of(obj, 0))
    go_to(12)
    assert stale(obj) == []  # what is generated from 9 to 17 is still made of the same
    generate()
    assert [pose.copy_of for pose in obj.planar.poses] == ["", ""]
    assert same(shown_at(obj, 17), loop)


def test_two_objects_with_poses_joined():
    """Of drawings without pins; what else there is to joins: test_joined_poses.py."""
    first, second = bar(nx=6, ny=2, name="First"), bar(nx=6, ny=2, name="Second")
    shapes = {frame: key(first, frame, frame) for frame in FRAMES}
    generate()
    others = {frame: key(second, frame, frame) for frame in (1, 5, 17, 30)}
    generate()
    go_to(1)
    activate(first)
    second.select_set(True)
    bpy.ops.object.join()
    bpy.context.view_layer.update()
    names = ("key_pose", "generate_inbetweens", "remove_inbetweens", "clear_poses")
    assert all(getattr(bpy.ops.planar, name).poll() for name in names)
    assert [pose.frame for pose in first.planar.poses] == sorted({*FRAMES, 1, 5, 17, 30})
    count = len(shapes[1])
    assert all(same(shown_at(first, frame)[:count], shape) for frame, shape in shapes.items())
    assert all(same(shown_at(first, frame)[count:], shape) for frame, shape in others.items())


@pytest.mark.parametrize("generated", ["bar", "edge soup"], indirect=True)  # of curves: test_outlines.py
def test_an_object_without_poses_joined_to_one_with_poses(generated):
    obj, shapes, _ = generated
    other = bar(nx=2, ny=1, name="Other")
    other.location.y = 5.0
    activate(obj)
    other.select_set(True)
    bpy.ops.object.join()
    generate()
    count = len(shapes[1])
    assert all(same(shown_at(obj, frame)[:count], shape) for frame, shape in shapes.items())
    shapes[5] = key(obj, 5, 4)[:count]
    assert all(same(shown_at(obj, frame)[:count], shape) for frame, shape in shapes.items())


def test_shape_keys_re_timed(generated):
    """Blender's own button, which puts all absolute keys 10 apart."""
    from planar_deform.scene.objects.any_object import shape_refusal

    obj, _, _ = generated
    activate(obj)
    bpy.ops.object.shape_key_retime()
    before = stored(obj)
    assert "undo Re-Time" in shape_refusal(obj)
    assert not bpy.ops.planar.key_pose.poll()
    assert stored(obj) == before
