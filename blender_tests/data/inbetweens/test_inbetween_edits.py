# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses keyed, deleted and recorded where in-betweens are, and generated shape keys edited by hand."""

import bpy
import numpy as np
import pytest
from filling import bent_bar, everything, frames_shown, generate, put, remove, shown, stale
from sequences import History, curve_of, go_to, key, same, timing, write
from support import activate, add_end_pins, bar, evaluated


def block(obj, name):
    return obj.data.shape_keys.key_blocks[name]


def names(obj):
    return [block.name for block in obj.data.shape_keys.key_blocks]


def counts(obj):
    return [pose.generated for pose in obj.planar.poses]


@pytest.mark.parametrize("frame", [13, 24, 2])
def test_a_pose_keyed_in_between_leaves_the_other_frames_as_they_are(frame):
    obj, poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    shape = key(obj, frame)  # as it is
    assert same(shape, before[frame])
    assert counts(obj) == [frame - 2, 24 - frame, 23, 0]
    for other, seen in before.items():
        assert np.abs(shown(obj, other) - seen).max() < 1e-6
    assert all(same(shown(obj, other), pose) for other, pose in poses.items())
    assert stale(obj) == {13: [(0, 1), (1, 2)], 24: [(0, 1)], 2: [(1, 2)]}[frame]
    edited = write_at(obj, frame)
    generate(obj)
    assert stale(obj) == []
    assert same(shown(obj, frame), edited)
    assert all(same(shown(obj, other), pose) for other, pose in poses.items())


def write_at(obj, frame, seed=7):
    go_to(frame)
    return write(obj, seed)


def test_a_pose_keyed_between_frames_that_are_shown_is_put_between_them():
    obj, _poses = bent_bar()
    generate(obj)
    curve_of(obj).keyframe_points[0].interpolation = "SINE"
    before = frames_shown(obj, range(25, 50))
    shape = key(obj, 14.5, 3)
    assert sum(counts(obj)) == 46
    assert same(shown(obj, 14.5), shape)
    for frame, seen in before.items():
        assert np.abs(shown(obj, frame) - seen).max() < 1e-6
    assert stale(obj) == [(0, 1), (1, 2)]


@pytest.mark.parametrize("pose", [0, 1, 2])
def test_deleting_a_pose_joins_what_is_generated_on_its_sides(pose):
    obj, poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    activate(obj)
    assert bpy.ops.planar.delete_pose(pose=pose) == {"FINISHED"}
    frames = [1, 25, 49]
    del frames[pose]
    assert counts(obj) == ([46, 0] if pose == 1 else [23, 0])
    assert [pose.frame for pose in obj.planar.poses] == frames
    assert all(same(shown(obj, frame), poses[frame]) for frame in frames)
    if pose == 1:
        assert stale(obj) == [(0, 1)]
        for frame in range(2, 24):  # the old way, a little slower
            assert np.abs(shown(obj, frame) - before[frame]).max() < 0.1
    else:
        assert stale(obj) == []
        kept = range(25, 50) if pose == 0 else range(1, 26)
        assert all(np.abs(shown(obj, frame) - before[frame]).max() < 1e-6 for frame in kept)
    remove(obj)
    assert len(obj.data.shape_keys.key_blocks) == 4
    assert [value for _, value, _ in timing(obj)] == [1024.0, 1032.0]


def test_a_recording_over_in_betweens_takes_out_what_is_generated_in_its_range():
    from planar_deform.scene.objects.any_object import begin_shape, key_poses

    obj, poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    activate(obj)
    go_to(1)
    drawing = begin_shape(bpy.context)
    recorded = {frame: drawing.positions + 0.01 * frame for frame in range(13, 31)}
    expected = {frame: drawing.coordinates(positions) for frame, positions in recorded.items()}
    key_poses(drawing, recorded, throughout=True)
    assert len(obj.planar.poses) == 2 + len(recorded)
    assert counts(obj) == [11] + [0] * 17 + [18, 0]
    for frame in range(1, 50):
        seen = shown(obj, frame)
        if frame in expected:
            assert same(seen, expected[frame])
        else:
            assert np.abs(seen - before[frame]).max() < 1e-6
    generate(obj)
    assert counts(obj) == [11] + [0] * 17 + [18, 0]
    assert all(same(shown(obj, frame), shape) for frame, shape in expected.items())
    assert same(shown(obj, 49), poses[49])


def test_generated_shape_keys_that_are_deleted_by_hand_are_passed_over_and_made_again():
    obj, _poses = bent_bar()
    start = everything_plain(obj)
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    for name in ("Pose +3", "Pose +23", "Pose.001 +1", "Pose.001 +2", "Pose.001 +3"):
        obj.shape_key_remove(block(obj, name))
    go_to(1)
    assert stale(obj) == [(0, 1), (1, 2)]
    gone = {4, 24, 26, 27, 28}
    for frame in set(before) - gone:
        assert np.abs(shown(obj, frame) - before[frame]).max() < 1e-6
    assert np.abs(shown(obj, 4) - (before[3].astype(float) + before[5]) / 2).max() < 1e-6
    key(obj, 60, 3)  # moves nothing before it
    bpy.ops.planar.delete_pose(pose=3)
    key(obj, 0, 3)  # moves everything
    bpy.ops.planar.delete_pose(pose=0)
    for frame in set(before) - gone:
        assert np.abs(shown(obj, frame) - before[frame]).max() < 1e-6
    generate(obj)
    assert stale(obj) == []
    for frame, seen in before.items():
        assert np.abs(shown(obj, frame) - seen).max() < 1e-6
    for name in ("Pose +3", "Pose.001 +1", "Pose.001 +23"):
        obj.shape_key_remove(block(obj, name))
    remove(obj)
    assert everything_plain(obj) == start


def everything_plain(obj):
    """Blocks and the curve's keys at frame 1."""
    go_to(1)
    blocks = [(b.name, b.frame) for b in obj.data.shape_keys.key_blocks]
    return blocks, timing(obj), [(p.name, p.at, p.generated) for p in obj.planar.poses]


def test_all_generated_shape_keys_deleted_by_hand():
    obj, poses = bent_bar()
    start = everything_plain(obj)
    generate(obj)
    for name in [name for name in names(obj) if "+" in name]:
        obj.shape_key_remove(block(obj, name))
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())
    assert stale(obj) == [(0, 1), (1, 2)]
    remove(obj)
    assert everything_plain(obj) == start


def test_a_pose_whose_shape_key_is_deleted_by_hand():
    obj, _poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    obj.shape_key_remove(block(obj, "Pose.001"))
    stale(obj)
    key(obj, 60, 4)
    assert [pose.name for pose in obj.planar.poses] == ["Pose", "Pose.002", "Pose.001"]
    assert counts(obj) == [47, 0, 0]
    for frame in set(range(1, 50)) - {25}:
        assert np.abs(shown(obj, frame) - before[frame]).max() < 1e-6
    generate(obj)
    assert counts(obj) == [47, 10, 0]
    assert stale(obj) == []


def test_renamed_and_moved_shape_keys():
    obj, _poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    block(obj, "Pose +3").name = "Mine"
    obj.planar.poses[1].name = "Jump"
    assert [name for name in names(obj) if name.startswith("Jump")][:2] == [
        "Jump",
        "Jump +1",
    ]
    obj.planar.poses[2].name = "Jump"
    assert [pose.name for pose in obj.planar.poses] == ["Pose", "Jump", "Jump.001"]
    assert all(block(obj, pose.name).frame == pytest.approx(pose.at) for pose in obj.planar.poses)
    activate(obj)
    obj.active_shape_key_index = obj.data.shape_keys.key_blocks.find("Pose +5")
    bpy.ops.object.shape_key_move(type="DOWN")
    bpy.ops.object.shape_key_move(type="DOWN")
    go_to(40)
    for frame in set(before) - {6, 7, 8}:
        assert np.abs(shown(obj, frame) - before[frame]).max() < 1e-6
    obj.planar.poses[0].turns = 1
    generate(obj)
    obj.planar.poses[0].turns = 0
    generate(obj)
    for frame, seen in before.items():
        assert np.abs(shown(obj, frame) - seen).max() < 1e-6
    assert "Pose +3" in obj.data.shape_keys.key_blocks
    assert "Mine" not in obj.data.shape_keys.key_blocks


def test_shape_keys_of_the_user_between_the_poses_stay():
    obj, poses = bent_bar()
    generate(obj)
    obj.data.shape_keys.eval_time = 1024.0 + 8.0 * 30 + 4.0
    obj.shape_key_add(name="Mine", from_mix=False).data[0].co = (7.0, 7.0, 7.0)
    go_to(1)
    generate(obj)
    assert "Mine" in obj.data.shape_keys.key_blocks
    remove(obj)
    mine = block(obj, "Mine")
    assert tuple(mine.data[0].co) == (7.0, 7.0, 7.0)
    generate(obj)
    assert counts(obj) == [23, 0, 0]  # nothing is generated past a shape that is no pose
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())


@pytest.mark.parametrize("copied_actions", [True, False])
def test_duplicated_objects_have_their_own(copied_actions):
    obj, _poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    bpy.context.preferences.edit.use_duplicate_action = copied_actions
    bpy.ops.object.duplicate()
    bpy.context.preferences.edit.use_duplicate_action = True
    twin = bpy.context.object
    assert twin != obj
    assert stale(twin) == []
    write_at(twin, 25)
    assert stale(twin) == [(0, 1), (1, 2)]
    assert stale(obj) == []
    generate(twin)
    remove(twin)
    assert stale(obj) == []
    for frame, seen in before.items():
        assert same(shown(obj, frame), seen)


def test_undo_and_redo():
    bent_bar()
    history = History(everything)
    history.did(bpy.ops.planar.generate_inbetweens())
    history.did(bpy.ops.planar.generate_inbetweens(path="ARC", smooth=True))
    history.did(bpy.ops.planar.retime_pose(pose=0, frame=30))
    history.did(bpy.ops.planar.generate_inbetweens())
    history.did(bpy.ops.planar.duplicate_pose(pose=1, frame=60))
    history.did(bpy.ops.planar.delete_pose(pose=1))
    history.did(bpy.ops.planar.step_poses(step=2))
    history.did(bpy.ops.planar.generate_inbetweens())
    history.did(bpy.ops.planar.remove_inbetweens())
    history.undo_all()
    assert stale(bpy.data.objects["Cutout"]) == []
    history.redo_all()


def test_saved_and_loaded_again(tmp_path):
    obj, _poses = bent_bar()
    curve_of(obj).keyframe_points[1].interpolation = "BEZIER"
    curve_of(obj).update()
    go_to(1)
    start = everything(obj)
    generate(obj)
    before = everything(obj)
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    assert everything(obj) == before
    assert stale(obj) == []
    remove(obj)
    go_to(1)
    assert everything(obj) == start
    generate(obj)
    assert everything(obj) == before
    write_at(obj, 25)
    assert stale(obj) == [(0, 1), (1, 2)]


def test_clearing_poses_takes_in_betweens_away_too():
    obj = bar()
    add_end_pins(obj)
    from sequences import stored

    before = stored(obj)
    for frame in (1, 9, 17):
        key(obj, frame, frame)
    generate(obj)
    activate(obj)
    go_to(5)
    write(obj, 4)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(obj)[1:] == before[1:]
    assert obj.data.shape_keys is None
    assert obj.planar.curve_before == ""
    assert not bpy.data.actions


def test_locked_shape_keys_and_their_other_settings_stay():
    obj, _ = bent_bar()
    keys = obj.data.shape_keys
    keys.key_blocks["Pose.001"].lock_shape = True
    keys.key_blocks["Pose.002"].slider_max = 3.0
    generate(obj)
    assert keys.key_blocks["Pose.001"].lock_shape
    assert keys.key_blocks["Pose.002"].slider_max == 3.0
    remove(obj)
    assert keys.key_blocks["Pose.001"].lock_shape
    assert not keys.key_blocks["Pose"].lock_shape
    assert keys.key_blocks["Pose.002"].slider_max == 3.0


def test_edited_stretches_are_kept_as_long_as_their_poses_are():
    from planar_deform.scene.sequence import stretches

    obj, _ = bent_bar()
    generate(obj)
    block(obj, "Pose +5").data[0].co = (0.5, 0.5, 0.0)
    stretches.mark(obj, [0], edited=True)
    generate(obj)
    assert shown(obj, 6)[0] == pytest.approx([0.5, 0.5, 0.0], abs=1e-6)
    obj.planar.poses[2].frame = 55
    generate(obj)
    assert counts(obj) == [23, 29, 0]
    assert shown(obj, 6)[0] == pytest.approx([0.5, 0.5, 0.0], abs=1e-6)
    write_at(obj, 25)
    assert stale(obj) == [(0, 1), (1, 2)]
    generate(obj)
    assert not obj.planar.poses[0].edited
    assert np.abs(shown(obj, 6)[0] - [0.5, 0.5, 0.0]).max() > 0.1


def test_chosen_poses_alone():
    from planar_deform.scene.inbetweens import planning, writing
    from planar_deform.scene.objects.any_object import begin_shape

    obj, poses = bent_bar((1, 9, 17, 25, 33))
    curve_of(obj).keyframe_points[0].interpolation = "BEZIER"
    generate(obj)
    go_to(3)
    before, seen = everything(obj), evaluated(obj)
    activate(obj)
    drawing = begin_shape(bpy.context)
    plan = planning.plan(drawing, poses=[0, 3, 4])
    running = writing.write(drawing, plan, plan.solve())
    for _ in range(20):
        next(running)
    running.close()
    assert everything(obj) == before
    assert same(evaluated(obj), seen)
    for _ in writing.write(drawing, plan, plan.solve()):
        pass
    assert [pose.frame for pose in obj.planar.poses] == [1, 25, 33]
    assert counts(obj) == [23, 7, 0]
    assert stale(obj) == []
    assert all(same(shown(obj, frame), poses[frame]) for frame in (1, 25, 33))
    fresh = frames_shown(obj, range(1, 34))
    remove(obj)
    generate(obj)
    for frame, seen in fresh.items():
        assert same(shown(obj, frame), seen)


def test_poses_put_again_on_generated_ones_keep_their_turns():
    obj, _ = bent_bar()
    obj.planar.poses[1].turns = -2
    generate(obj)
    put(obj, {25: np.zeros((65, 2)) + np.arange(65)[:, None]})
    key(obj, 30, 2)
    assert [pose.turns for pose in obj.planar.poses] == [0, -2, 0, 0]


def test_without_a_curve_what_is_shown_stays_shown():
    obj, _ = bent_bar()
    generate(obj)
    seen = shown(obj, 35)
    bpy.data.actions.remove(obj.data.shape_keys.animation_data.action)
    activate(obj)
    assert same(evaluated(obj), seen)
    assert not bpy.ops.planar.generate_inbetweens.poll()
    obj.data.shape_keys.eval_time = obj.planar.poses[1].at
    seen = evaluated(obj)
    remove(obj)
    assert same(evaluated(obj), seen)
    assert [pose.at for pose in obj.planar.poses] == [1024.0, 1032.0, 1040.0]


def test_poses_retimed_by_the_list_stay_in_their_order_when_in_betweens_are_removed():
    obj, poses = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points[0].co[0] = 30
    curve.update()
    generate(obj)  # puts them in order
    obj.planar.poses[0].frame = 40  # past the first pose
    assert [pose.frame for pose in obj.planar.poses] == [30, 40, 49]
    remove(obj)
    assert [pose.frame for pose in obj.planar.poses] == [30, 40, 49]
    for frame, pose in ((30, 1), (40, 25), (49, 49)):
        assert same(shown(obj, frame), poses[pose])
