# SPDX-License-Identifier: GPL-3.0-or-later
"""Breakdown from a script: what is keyed, where, and how; refusals change nothing."""

import bpy
import numpy as np
import pytest
from sequences import curve_of, go_to, key, same, shown_at, stored, timing, write
from support import PLANES, activate, bar, evaluated, make_object


def bent(obj, frame, height, seed=None):
    """Pose a drawing by bending it up and key it; what is shown."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    go_to(frame)
    drawing = begin_shape(bpy.context)
    rest = drawing.rest
    angle = (rest[:, 0] - rest[:, 0].min()) * height
    radius = 1.0 / height
    drawing.write(
        np.stack(
            [(radius - rest[:, 1]) * np.sin(angle), radius - (radius - rest[:, 1]) * np.cos(angle)], axis=1
        )
    )
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    return evaluated(obj)


def bent_bar(**options):
    obj = bar(**options)
    return obj, [bent(obj, frame, height) for frame, height in ((1, 0.2), (25, 0.9), (49, -0.7))]


def breakdown(percent, **options):
    assert bpy.ops.planar.breakdown(percent=percent, **options) == {"FINISHED"}


def key_types(obj):
    return [(point.co.x, point.type) for point in curve_of(obj).keyframe_points]


@pytest.mark.parametrize("plane", PLANES)
def test_it_keys_what_generating_gives_there(plane):
    obj, _ = bent_bar(plane=plane)
    obj.rotation_euler, obj.scale = (0.2, 0.3, 0.5), (1.0, 1.3, 0.8)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    generated = shown_at(obj, 7)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    linear = shown_at(obj, 7)
    go_to(15)
    breakdown(25.0)
    assert np.abs(evaluated(obj) - generated).max() < 1e-6
    assert np.abs(linear - generated).max() > 1e-2
    assert same(shown_at(obj, 15), evaluated(obj))
    assert key_types(obj) == [(1, "KEYFRAME"), (15, "BREAKDOWN"), (25, "KEYFRAME"), (49, "KEYFRAME")]


@pytest.mark.parametrize("frame", [13, 37, 55])
def test_it_is_what_generating_gives_with_smooth_turns_and_arcs(frame):
    obj, _ = bent_bar()
    bent(obj, 61, 0.4)
    obj.planar.smooth, obj.planar.anchor_path = True, "ARC"
    obj.planar.poses[1].turns = 1
    bpy.ops.planar.generate_inbetweens()
    generated = shown_at(obj, frame)
    bpy.ops.planar.remove_inbetweens()
    go_to(frame)
    before, behind = max(f for f in (1, 25, 49) if f < frame), min(f for f in (25, 49, 61) if f > frame)
    breakdown(100.0 * (frame - before) / (behind - before))
    assert np.abs(evaluated(obj) - generated).max() < 1e-6


def test_the_ends_are_the_poses_and_beyond_them_needs_overshoot():
    obj, poses = bent_bar()
    go_to(37)
    breakdown(0.0)
    assert same(evaluated(obj), poses[1])
    breakdown(100.0)
    assert same(evaluated(obj), poses[2])
    breakdown(130.0)
    assert same(evaluated(obj), poses[2])
    breakdown(130.0, overshoot=True)
    assert np.abs(evaluated(obj) - poses[2]).max() > 0.1
    assert [pose[0] for pose in timing(obj)] == [1, 25, 37, 49]


def test_a_keyed_pose_is_made_again_between_those_around_it():
    obj, poses = bent_bar()
    go_to(25)
    breakdown(0.0)
    assert same(evaluated(obj), poses[0])
    assert same(shown_at(obj, 1), poses[0])
    assert same(shown_at(obj, 49), poses[2])
    assert len(obj.planar.poses) == 3
    assert key_types(obj)[1] == (25, "BREAKDOWN")


def test_an_unkeyed_pose_is_replaced():
    obj, poses = bent_bar()
    go_to(13)
    write(obj, 5)
    breakdown(0.0)
    assert same(shown_at(obj, 13), poses[0])


def test_easing_and_the_other_poses_stay():
    obj, poses = bent_bar()
    for point in curve_of(obj).keyframe_points:
        point.interpolation = "SINE"
    go_to(13)
    breakdown(40.0)
    assert [easing for _, _, easing in timing(obj)] == ["SINE", "LINEAR", "SINE", "SINE"]
    for frame, pose in zip((1, 25, 49), poses, strict=True):
        assert same(shown_at(obj, frame), pose)


def test_inside_of_a_generated_stretch_it_is_stale_and_generated_again():
    from planar_deform.scene.sequence import stretches

    obj, _ = bent_bar()
    bpy.ops.planar.generate_inbetweens()
    go_to(13)
    breakdown(80.0)
    keyed = evaluated(obj)
    assert len(stretches.stale(obj)) == 2
    bpy.ops.planar.generate_inbetweens()
    assert stretches.stale(obj) == []
    assert same(shown_at(obj, 13), keyed)


def test_an_outline():
    x = np.linspace(0.0, 2.0, 13)
    obj = make_object(np.stack([x, np.zeros(13), np.zeros(13)], axis=1), [], [(i, i + 1) for i in range(12)])
    first, last = key(obj, 1), bent(obj, 25, 1.2)
    go_to(13)
    breakdown(50.0)
    lengths = np.linalg.norm(np.diff(evaluated(obj), axis=0), axis=1)
    assert np.abs(lengths - 2.0 / 12).max() < 1e-3
    assert np.abs(evaluated(obj) - (first + last) / 2).max() > 1e-2


@pytest.mark.parametrize("frame", [0, 1, 49, 60])
def test_where_there_is_no_pose_on_both_sides_it_is_refused(frame):
    obj, _ = bent_bar()
    go_to(frame)
    before = stored(obj)
    assert not bpy.ops.planar.breakdown.poll()
    with pytest.raises(RuntimeError, match="between two keyed poses"):
        bpy.ops.planar.breakdown(percent=50.0)
    assert stored(obj) == before


def test_where_a_pose_is_held_it_is_refused():
    obj, _ = bent_bar()
    curve_of(obj).keyframe_points.insert(60, obj.planar.poses[2].at)
    go_to(55)
    with pytest.raises(RuntimeError, match="between two keyed poses"):
        bpy.ops.planar.breakdown()


def test_beside_a_pose_whose_shape_key_has_been_removed_it_is_refused():
    obj, _ = bent_bar()
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Pose.001"])
    go_to(13)
    before = stored(obj)
    with pytest.raises(RuntimeError, match="of pose 'Pose.001' is gone: delete the pose"):
        bpy.ops.planar.breakdown()
    assert stored(obj) == before


def test_invoked_in_background_it_keys_at_once():
    obj, poses = bent_bar()
    go_to(13)
    assert bpy.ops.planar.breakdown("INVOKE_DEFAULT", percent=100.0) == {"FINISHED"}
    assert same(shown_at(obj, 13), poses[1])


def test_an_object_without_poses_is_refused():
    bar()
    with pytest.raises(RuntimeError, match="Key Pose"):
        bpy.ops.planar.breakdown()


def test_one_undo_step():
    obj, _ = bent_bar()
    key(obj, 60, 3)
    go_to(13)
    bpy.ops.ed.undo_push(message="Start")
    before = stored(obj)
    breakdown(30.0)
    bpy.ops.ed.undo_push(message="Breakdown")
    after = stored(obj)
    bpy.ops.ed.undo()
    assert stored(bpy.context.object) == before
    bpy.ops.ed.redo()
    assert stored(bpy.context.object) == after
