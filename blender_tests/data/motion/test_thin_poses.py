# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings thinned to key poses with in-betweens."""

import base64

import bpy
import numpy as np
import pytest
from sequences import curve_of, go_to, key, same, shown_at, stored, timing
from support import add_end_pins, bar, evaluated


def recorded(frames=36, **options):
    """A bar whose right end goes up and down again, with a pose at each frame from 1 on."""
    obj = bar()
    add_end_pins(obj)
    go_to(1)
    time = np.arange(frames + 1) / frames
    path = np.stack([0.2 * time, 0.6 * np.sin(np.pi * time), 0 * time], axis=1)
    packed = base64.b64encode(path.astype("<f4").tobytes()).decode("ascii")
    assert bpy.ops.planar.record_pins(path=packed, smoothing=0.0, **options) == {"FINISHED"}
    return obj


def poses_at(obj):
    from planar_deform.scene.sequence import pose_state

    return [pose_state.frames_of(obj, pose) for pose in range(len(obj.planar.poses))]


def size(obj):
    return float(np.linalg.norm(np.ptp(shown_at(obj, 1), axis=0)))


def test_few_poses_are_left_and_all_frames_are_near_what_they_were():
    from planar_deform.scene.sequence import stretches

    obj = recorded()
    before = {frame: shown_at(obj, frame) for frame in range(1, 38)}
    counts = []
    for tolerance in (0.003, 0.01, 0.03):
        assert bpy.ops.planar.thin_poses(tolerance=tolerance) == {"FINISHED"}
        frames = poses_at(obj)
        counts.append(len(frames))
        assert frames[0] == [1.0]
        assert frames[-1] == [37.0]
        assert [point[0] for point in timing(obj)] == [row[0] for row in frames]
        for row in frames:
            assert same(shown_at(obj, row[0]), before[row[0]])
        worst = max(np.abs(shown_at(obj, frame) - before[frame]).max() for frame in before)
        assert worst <= 1.001 * tolerance * size(obj)
        assert stretches.stale(obj) == []
    assert 37 > counts[0] > counts[1] >= counts[2] >= 2
    assert counts[1] <= 10


def test_no_inbetween_is_farther_than_told():
    from planar_deform.scene.motion.thinning import Thinning

    obj = recorded(frame_step=3)
    before = {frame: shown_at(obj, frame) for frame in range(1, 38, 3)}
    plan = Thinning(bpy.context, 0.01)
    solved = plan.solve(lambda share: True)
    for _ in plan.write(solved):
        pass
    worst = max(np.abs(shown_at(obj, frame) - before[frame]).max() for frame in before)
    assert worst <= solved.furthest * 1.0001
    told = plan.summary(solved)
    assert told.startswith(f"13 poses → {len(obj.planar.poses)}, furthest")
    assert told.endswith(f"{solved.furthest / plan._drawing.diagonal:.2%} of the size")
    # What was recorded on threes is filled at every frame.
    assert sum(item.generated for item in obj.planar.poses) + len(obj.planar.poses) == 37


def test_poses_with_easing_or_several_keys_stay():
    obj = recorded(frames=20)
    curve = curve_of(obj)
    curve.keyframe_points[5].interpolation = "CONSTANT"
    curve.keyframe_points.insert(30.0, curve.keyframe_points[10].co.y)
    curve.update()
    assert bpy.ops.planar.thin_poses(tolerance=1.0) == {"FINISHED"}
    frames = poses_at(obj)
    # In-betweens need a pose of its own for what is come back to.
    assert sorted(frames) == [[1.0], [6.0], [7.0], [11.0], [21.0], [30.0]]
    kinds = {point[0]: point[2] for point in timing(obj)}
    assert kinds[6.0] == "CONSTANT"


def test_too_few_poses_are_refused():
    obj = bar()
    key(obj, 1, 1)
    key(obj, 5, 2)
    before = stored(obj)
    with pytest.raises(RuntimeError, match="2 poses: Record"):
        bpy.ops.planar.thin_poses()
    assert stored(obj) == before


def test_a_pose_whose_shape_key_has_been_removed_is_refused():
    obj = bar()
    for frame in (1, 5, 9):
        key(obj, frame, frame)
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Pose.001"])
    before = stored(obj)
    with pytest.raises(RuntimeError, match="of pose 'Pose.001' is gone: delete the pose"):
        bpy.ops.planar.thin_poses()
    assert stored(obj) == before


def test_stopped_and_closed_everything_is_as_it_was():
    from planar_deform import native
    from planar_deform.scene.motion.thinning import Thinning

    obj = recorded(frames=12)
    before = stored(obj)
    thinning = Thinning(bpy.context, 0.02)
    with pytest.raises(native.Cancelled):
        thinning.solve(lambda share: False)
    assert stored(obj) == before
    solved = thinning.solve(lambda share: True)
    for share in (0.0, 0.6, 0.9):  # before 0.5 in-betweens are solved
        writing = thinning.write(solved)
        while next(writing) < share:
            pass
        assert share < 0.5 or stored(obj) != before
        writing.close()
        assert stored(obj) == before


def test_the_pose_that_is_shown_may_go():
    from planar_deform.scene.sequence import pose_state

    obj = recorded()
    go_to(36)
    before = evaluated(obj)
    assert bpy.ops.planar.thin_poses(tolerance=0.03) == {"FINISHED"}
    assert pose_state.pose_at(obj, 36) is None
    assert not same(evaluated(obj), before)
    assert same(evaluated(obj), shown_at(obj, 36))
    assert np.abs(evaluated(obj) - before).max() < 0.03 * size(obj)


def test_one_undo_step_and_the_last_shape_stays_in_view():
    obj = recorded()
    shape = evaluated(obj)
    bpy.ops.ed.undo_push(message="Record")
    before = stored(obj)
    bpy.ops.planar.thin_poses()
    assert same(evaluated(obj), shape)
    bpy.ops.ed.undo_push(message="Thin")
    after = stored(bpy.data.objects["Cutout"])
    bpy.ops.ed.undo()
    assert stored(bpy.data.objects["Cutout"]) == before
    bpy.ops.ed.redo()
    assert stored(bpy.data.objects["Cutout"]) == after


def test_pins_go_on_holding_what_is_shown():
    obj = recorded()
    frame = bpy.context.scene.frame_current
    assert bpy.ops.planar.thin_poses() == {"FINISHED"}
    for at in (frame, frame - 7):
        bpy.context.scene.frame_set(at)
        before = evaluated(obj)
        assert bpy.ops.planar.drag_pins(offset=(0.0, 0.0)) == {"FINISHED"}
        assert evaluated(obj) == pytest.approx(before, abs=0.01)
