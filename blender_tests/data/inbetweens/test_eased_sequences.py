# SPDX-License-Identifier: GPL-3.0-or-later
"""The ease of a sequence: what generating and removing in-betweens leave of it, and what new keys get."""

import itertools

import bpy
import numpy as np
import pytest
from sequences import curve_of, go_to, key, shown_at, timing
from support import activate, add_end_pins, bar, evaluated

HANDLES = ("FREE", "ALIGNED", "VECTOR", "AUTO", "AUTO_CLAMPED")
INTERPOLATIONS = (
    *("CONSTANT", "LINEAR", "BEZIER", "SINE", "QUAD", "CUBIC", "QUART", "QUINT", "EXPO", "CIRC"),
    *("BACK", "BOUNCE", "ELASTIC"),
)


def wave(frames=(1, 13, 25, 43, 49), poses=(0, 1, 0, 2, 1)):
    """Three poses, come back to by duplicated keys."""
    obj = bar()
    add_end_pins(obj)
    for frame, seed in ((1, None), (200, 1), (300, 2)):
        key(obj, frame, seed)
    values = [pose.at for pose in obj.planar.poses]
    points = curve_of(obj).keyframe_points
    points.clear()
    for frame, pose in zip(frames, poses, strict=True):
        points.insert(frame, values[pose])
    curve_of(obj).update()
    return obj


def give(obj, *, handles="AUTO_CLAMPED", interpolation="BEZIER", easing="AUTO"):
    for point in curve_of(obj).keyframe_points:
        point.interpolation, point.easing = interpolation, easing
        point.handle_left_type = point.handle_right_type = handles
    curve_of(obj).update()


def progress(obj, *, update=True):
    """Of the way from key to key, at each tenth of a frame of each stretch."""
    curve = curve_of(obj)
    if update:  # as the next edit in the Graph Editor does
        curve.update()
    keys = [tuple(point.co) for point in curve.keyframe_points]
    found = []
    for (start, low), (end, high) in itertools.pairwise(keys):
        frames = np.linspace(start, end, round(10 * (end - start)), endpoint=False)
        values = np.array([curve.evaluate(frame) for frame in frames])
        found.append((values - low) / (high - low) if high != low else values * 0.0)
    return np.concatenate(found)


def state(obj):
    return [
        (
            *point.co,
            *point.handle_left,
            *point.handle_right,
            *(point.handle_left_type, point.handle_right_type, point.interpolation, point.easing),
            *(point.amplitude, point.back, point.period),
        )
        for point in curve_of(obj).keyframe_points
    ]


def generate_and_remove(obj):
    """The progress before generating, behind it and after taking the in-betweens out again."""
    activate(obj)
    before, was = progress(obj), state(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    filled = progress(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    again = progress(obj)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert state(obj) == was
    return before, filled, again, progress(obj)


def assert_kept(before, *later):
    for now in later:
        assert np.abs(now - before).max() < 1e-3


@pytest.mark.parametrize("handles", HANDLES)
def test_poses_that_return_keep_their_ease(handles):
    obj = wave()
    give(obj, handles=handles)
    if handles in {"FREE", "ALIGNED"}:
        for point in curve_of(obj).keyframe_points:
            point.handle_left = point.co[0] - 5.0, point.co[1] - 2.0
            point.handle_right = point.co[0] + 5.0, point.co[1] + 2.0
    assert_kept(*generate_and_remove(obj))


@pytest.mark.parametrize("smoothing", ["NONE", "CONT_ACCEL"])
def test_a_wave_with_automatic_handles_stays_slow_at_its_poses(smoothing):
    obj = wave(frames=(1, 13, 25, 37), poses=(0, 1, 0, 1))
    give(obj)
    curve_of(obj).auto_smoothing = smoothing
    before, *later = generate_and_remove(obj)
    assert_kept(before, *later)
    assert before[12] < 0.07  # of a tenth of the way


@pytest.mark.parametrize("easing", ["EASE_IN", "EASE_OUT", "EASE_IN_OUT"])
@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_each_interpolation_keeps_its_ease(interpolation, easing):
    obj = wave()
    give(obj, interpolation=interpolation, easing=easing)
    for point in curve_of(obj).keyframe_points:
        point.amplitude, point.period, point.back = 5.0, 4.0, 3.0
    assert_kept(*generate_and_remove(obj))


def test_held_poses_and_keys_between_poses_keep_theirs():
    obj = wave(frames=(1, 13, 19, 31, 50), poses=(0, 1, 1, 0, 2))
    points = curve_of(obj).keyframe_points
    low, high = (obj.planar.poses[pose].at for pose in (0, 1))
    points.insert(5, low + 0.3 * (high - low))
    points.insert(25, low + 0.6 * (high - low))  # on the way back
    give(obj, handles="AUTO")
    activate(obj)
    was, before = state(obj), [shown_at(obj, frame) for frame in (13, 19, 31, 50)]
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    curve = curve_of(obj)
    values = {round(point.co[0]): point.co[1] for point in curve.keyframe_points}
    assert (values[25] - values[19]) / (values[31] - values[19]) == pytest.approx(0.4, abs=1e-3)
    assert (values[5] - values[1]) / (values[13] - values[1]) == pytest.approx(0.3, abs=1e-3)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert state(obj) == was
    for frame, shape in zip((13, 19, 31, 50), before, strict=True):
        assert shown_at(obj, frame) == pytest.approx(shape, abs=1e-6)


def test_what_was_retimed_since_keeps_its_ease_when_in_betweens_go():
    obj = wave()
    give(obj, handles="AUTO")
    activate(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    point = curve_of(obj).keyframe_points[2]
    for part in (point.co, point.handle_left, point.handle_right):
        part[0] += 7.0
    before = progress(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    again = progress(obj)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert_kept(before, again, progress(obj))


def test_a_way_through_a_pose_without_a_key_keeps_its_ease():
    obj = wave(frames=(1, 13, 24), poses=(0, 1, 2))
    give(obj, handles="AUTO")
    points = curve_of(obj).keyframe_points
    points.remove(points[1])
    assert_kept(*generate_and_remove(obj))


def eased(**chosen):
    obj = bar()
    add_end_pins(obj)
    for name, value in chosen.items():
        setattr(obj.planar, name, value)
    for frame, seed in ((1, 1), (13, 2), (25, 3)):
        key(obj, frame, seed)
    return obj


@pytest.mark.parametrize(
    ("ease", "shares"),
    [
        ("LINEAR", (1 / 3, 2 / 3)),
        ("EASE", (0.25, 0.75)),
        ("EASE_IN", (0.134, 0.5)),
        ("EASE_OUT", (0.5, 0.866)),
        ("HOLD", (0.0, 0.0)),
    ],
)
def test_new_keys_get_the_ease_that_is_chosen(ease, shares):
    obj = eased(ease=ease)
    first, second = shown_at(obj, 1), shown_at(obj, 13)
    for frame, share in zip((5, 9), shares, strict=True):
        assert shown_at(obj, frame) == pytest.approx(first + share * (second - first), abs=1e-4)


def test_by_default_new_keys_are_as_blenders_preferences_say():
    edit = bpy.context.preferences.edit
    edit.keyframe_new_interpolation_type, edit.keyframe_new_handle_type = "BEZIER", "VECTOR"
    obj = eased()
    assert [kind for *_, kind in timing(obj)] == ["BEZIER"] * 3
    assert {point.handle_right_type for point in curve_of(obj).keyframe_points} == {"VECTOR"}
    edit.keyframe_new_interpolation_type = "CONSTANT"
    key(obj, 7, 4)
    assert [kind for *_, kind in timing(obj)] == ["BEZIER", "CONSTANT", "BEZIER", "BEZIER"]


def test_a_pose_keyed_again_keeps_its_ease():
    obj = eased(ease="EASE")
    obj.planar.ease = "HOLD"
    go_to(13)
    key(obj, 13, 5)
    assert [kind for *_, kind in timing(obj)] == ["SINE"] * 3
    assert evaluated(obj) is not None
