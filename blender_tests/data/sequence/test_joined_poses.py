# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings with keyed poses that are joined: every part shows at every frame what it showed before."""

import bpy
import numpy as np
import pytest
from drawings import DRAWINGS, extremes
from sequences import curve_of, go_to, key, pull, timing
from support import activate, add_end_pins, add_pins, bar, evaluated, pose

FRAMES = range(-2, 34)
TOLERANCE = 2e-5


def drawing(name="Cutout", at=(0.0, 0.0, 0.0), turned=False):
    obj = bar(name=name)
    add_end_pins(obj)
    obj.location = at
    if turned:
        obj.rotation_euler = (0.0, 0.0, np.pi / 2)
        obj.scale = (0.5, 0.5, 0.5)
    return obj


def posed(obj, frames, ease=None, generate=False):
    """Key a pose at each frame, each another one."""
    if ease is not None:
        obj.planar.ease = ease
    for number, frame in enumerate(frames):
        pull(obj, frame, (0.1 * (-1) ** number, 0.3 + 0.2 * number))
    if generate:
        assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    return obj


def shown(*objects, frames=FRAMES):
    """What is shown in the world at each frame, frames x vertices x 3."""
    found = []
    for frame in frames:
        go_to(frame)
        found.append(np.concatenate([in_world(obj) for obj in objects]))
    return np.array(found)


def in_world(obj):
    return evaluated(obj) @ np.array(obj.matrix_world.to_3x3()).T + np.array(obj.matrix_world.translation)


def join(active, *others):
    activate(active)
    for other in others:
        other.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.object


def frames_of(obj):
    return [pose.frame for pose in obj.planar.poses]


def assert_joined_plays(active, *others, frames=FRAMES, at=5):
    expected = shown(active, *others, frames=frames)
    go_to(at)
    joined = join(active, *others)
    found = shown(joined, frames=frames)
    gaps = np.abs(found - expected).max(axis=(1, 2))
    assert gaps.max() < TOLERANCE, [
        (frame, gap) for frame, gap in zip(frames, gaps, strict=True) if gap >= TOLERANCE
    ]
    assert bpy.ops.planar.key_pose.poll(), "keying is not refused"
    return joined


CASES = {
    "the same frames": ((1, 13, 25), (1, 13, 25), None, None, False, False),
    "other frames": ((1, 13, 25), (5, 13, 30), None, None, False, False),
    "linear, other frames": ((1, 13, 25), (5, 20), "LINEAR", "LINEAR", False, False),
    "other eases": ((1, 13, 25), (1, 13, 25), "EASE", "EASE_IN", False, False),
    "one behind the other": ((1, 10), (15, 25), "EASE", "EASE_OUT", False, False),
    "held": ((1, 13, 25), (1, 9, 25), "HOLD", None, False, False),
    "in-betweens of both, the same frames": ((1, 13, 25), (1, 13, 25), None, None, True, True),
    "in-betweens of both": ((1, 13, 25), (4, 21), None, "EASE", True, True),
    "in-betweens of the active one": ((1, 13, 25), (1, 13, 25), None, None, True, False),
    "in-betweens of the other": ((1, 13, 25), (7, 21), None, None, False, True),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("turned", [False, True])
def test_both_have_keyed_poses(case, turned):
    one, other, ease, other_ease, generated, other_generated = CASES[case]
    first = posed(drawing("First"), one, ease, generated)
    second = posed(drawing("Second", (0, 3, 0.1), turned), other, other_ease, other_generated)
    joined = assert_joined_plays(first, second)
    assert frames_of(joined) == sorted({*one, *other})
    assert len(joined.planar.pins) == 4


def test_alike_timing_stays_as_it_is():
    first = posed(drawing("First"), (1, 13, 25), "EASE")
    second = posed(drawing("Second", (0, 3, 0)), (1, 13, 25), "EASE")
    before, names = timing(first), [pose.name for pose in first.planar.poses]
    joined = assert_joined_plays(first, second)
    assert timing(joined) == before
    assert [pose.name for pose in joined.planar.poses] == names
    assert not any(pose.generated for pose in joined.planar.poses)


def test_an_ease_is_kept_where_one_part_moves_alone():
    first = posed(drawing("First"), (1, 10), "EASE")
    second = posed(drawing("Second", (0, 3, 0)), (15, 25), "EASE_OUT")
    joined = assert_joined_plays(first, second)
    curve = curve_of(joined)
    assert [point.interpolation for point in curve.keyframe_points][0::2] == ["SINE", "SINE"]
    assert [pose.generated for pose in joined.planar.poses] == [0, 0, 0, 0]
    assert frames_of(joined) == [1, 10, 15, 25]


def test_a_duplicate_that_was_keyed_at_other_frames():
    first = posed(drawing("First"), (1, 13))
    activate(first)
    bpy.ops.object.duplicate()
    second = bpy.context.object
    second.location.y += 3.0
    posed(second, (7, 25))
    joined = assert_joined_plays(first, second)
    assert frames_of(joined) == [1, 7, 13, 25]


def test_a_keyed_one_joined_into_one_that_is_only_posed():
    first = drawing("First")
    second = posed(drawing("Second", (0, 3, 0.1), turned=True), (1, 13, 25), generate=True)
    pose(first, offset=(0.1, 0.5))
    joined = assert_joined_plays(first, second)
    assert frames_of(joined) == [1, 13, 25]
    assert [pose.generated for pose in joined.planar.poses] == [11, 11, 0]
    go_to(40)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    rest = in_world(joined)
    assert np.ptp(rest[:65], axis=0) == pytest.approx([2.0, 1.0, 0.0], abs=1e-5)
    assert np.ptp(rest[65:], axis=0) == pytest.approx([0.5, 1.0, 0.0], abs=1e-5)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert in_world(joined) == pytest.approx(rest, abs=1e-5)


def test_a_keyed_one_joined_into_one_that_nobody_has_pinned():
    plain = bar(name="Plain")
    second = posed(drawing("Second", (0, 3, 0)), (1, 13))
    third = posed(drawing("Third", (0, 6, 0)), (4, 20))
    joined = assert_joined_plays(plain, second, third)
    assert frames_of(joined) == [1, 4, 13, 20]


def test_one_that_is_posed_joined_to_one_with_keyed_poses():
    from planar_deform.scene.sequence import stretches

    first = drawing("First")
    first.scale = (0.5, 0.8, 0.7)
    posed(first, (1, 13, 25), generate=True)
    second = drawing("Second", (0, 3, 0.1))
    pose(second, offset=(0.2, 0.4))
    joined = assert_joined_plays(first, second)
    assert stretches.stale(joined) == [], "with pins and depth it has not had before"
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}


def test_three_with_other_timing_and_a_plain_one_between():
    first = posed(drawing("A"), (1, 13))
    vertices = bar(name="B plain")
    vertices.location.y = -4.0
    third = posed(drawing("C", (0, 3, 0)), (6, 25), generate=True)
    fourth = posed(drawing("D", (0, 6, 0)), (1, 3, 30), "LINEAR")
    joined = assert_joined_plays(first, vertices, third, fourth)
    assert frames_of(joined) == [1, 3, 6, 13, 25, 30]


@pytest.mark.parametrize("both", [False, True])
def test_on_twos(both):
    first = posed(drawing("First"), (1, 13, 25))
    assert bpy.ops.planar.step_poses(step=2) == {"FINISHED"}
    second = posed(drawing("Second", (0, 3, 0)), (3, 17))
    if both:
        assert bpy.ops.planar.step_poses(step=2) == {"FINISHED"}
    joined = assert_joined_plays(first, second)
    assert len(curve_of(joined).modifiers) == both


def test_a_loop_goes_on_to_the_end_of_the_range():
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 33
    first = posed(drawing("First"), (1, 5, 9))
    curve_of(first).modifiers.new("CYCLES")
    first.data.shape_keys.animation_data.action.update_tag()
    second = posed(drawing("Second", (0, 3, 0)), (3, 17))
    assert_joined_plays(first, second, frames=range(1, 34))


def test_a_pose_that_comes_back():
    first = posed(drawing("First"), (1, 13))
    activate(first)
    curve = curve_of(first)
    point = curve.keyframe_points[0].co[1]
    curve.keyframe_points.insert(25, point)
    curve.keyframe_points.insert(29, point)
    second = posed(drawing("Second", (0, 3, 0)), (1, 20))
    joined = assert_joined_plays(first, second)
    assert frames_of(joined) == [1, 13, 20, 25]


def test_in_betweens_are_kept_and_can_be_made_anew():
    from planar_deform.scene.sequence import stretches

    first = posed(drawing("First"), (1, 13, 25), generate=True)
    second = posed(drawing("Second", (0, 3, 0)), (4, 21), generate=True)
    joined = assert_joined_plays(first, second)
    assert stretches.stale(joined) == []
    before = shown(joined)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    after = shown(joined)
    for frame in (1, 4, 13, 21, 25):
        index = list(FRAMES).index(frame)
        assert after[index] == pytest.approx(before[index], abs=1e-5)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert frames_of(joined) == [1, 4, 13, 21, 25]


def test_alike_in_betweens_stay_up_to_date():
    from planar_deform.scene.sequence import stretches

    first = posed(drawing("First"), (1, 13, 25), generate=True)
    second = posed(drawing("Second", (0, 3, 0.1)), (1, 13, 25), generate=True)
    joined = assert_joined_plays(first, second)
    bpy.context.view_layer.update()
    assert stretches.stale(joined) == []


def test_a_pose_without_a_key_stays_in_the_list():
    first = posed(drawing("First"), (1, 13, 25))
    curve = curve_of(first)
    curve.keyframe_points.remove(curve.keyframe_points[1])
    second = posed(drawing("Second", (0, 3, 0)), (5, 17))
    joined = assert_joined_plays(first, second)
    assert len(joined.planar.poses) == 5


@pytest.mark.parametrize("which", [0, 1])
def test_a_pose_that_is_not_keyed_yet_stays_shown(which):
    objects = posed(drawing("First"), (1, 13)), posed(drawing("Second", (0, 3, 0)), (5, 17))
    go_to(9)
    pose(objects[which], offset=(0.3, -0.4))
    expected = np.concatenate([in_world(obj) for obj in objects])
    joined = join(*objects)
    joined.update_tag()  # in the window the next redraw does
    bpy.context.view_layer.update()
    assert in_world(joined) == pytest.approx(expected, abs=TOLERANCE)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert in_world(joined) == pytest.approx(expected, abs=TOLERANCE)
    assert frames_of(joined) == [1, 5, 9, 13, 17]


def test_right_after_a_file_has_been_opened(tmp_path):
    posed(drawing("First"), (1, 13, 25))
    posed(drawing("Second", (0, 3, 0)), (4, 21), generate=True)
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    first, second = (bpy.data.objects[name] for name in ("First", "Second"))
    joined = assert_joined_plays(first, second)
    assert frames_of(joined) == [1, 4, 13, 21, 25]


@pytest.mark.parametrize("keyed", [False, True])
def test_a_join_is_undone_and_redone(keyed):
    first = drawing("First")
    if keyed:
        posed(first, (1, 13, 25))
    second = posed(drawing("Second", (0, 3, 0)), (4, 21))

    def objects():
        return [bpy.data.objects[name] for name in ("First", "Second") if name in bpy.data.objects]

    before = shown(first, second)
    lists = [frames_of(obj) for obj in (first, second)]
    go_to(5)
    activate(first)
    second.select_set(True)
    bpy.ops.ed.undo_push(message="Start")
    join(first, second)
    bpy.ops.ed.undo_push(message="Join")
    for _ in range(2):
        assert shown(*objects()) == pytest.approx(before, abs=TOLERANCE)
        assert frames_of(objects()[0]) == sorted({*lists[0], *lists[1]})
        go_to(5)
        bpy.ops.ed.undo()
        assert [frames_of(obj) for obj in objects()] == lists
        assert shown(*objects()) == pytest.approx(before, abs=TOLERANCE)
        for obj in objects():
            activate(obj)
            assert bpy.ops.planar.key_pose.poll()
        bpy.ops.ed.redo()
        bpy.context.view_layer.update()
    joined = objects()[0]
    key(joined, 30, seed=3)
    bpy.ops.ed.undo_push(message="Key")
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert shown(*objects()) == pytest.approx(before, abs=TOLERANCE)
    assert frames_of(objects()[0]) == sorted({*lists[0], *lists[1]})


def test_joined_twice():
    first = posed(drawing("First"), (1, 13))
    second = posed(drawing("Second", (0, 3, 0)), (4, 21))
    third = posed(drawing("Third", (0, 6, 0)), (2, 30), generate=True)
    joined = assert_joined_plays(first, second)
    joined = assert_joined_plays(joined, third)
    assert frames_of(joined) == [1, 2, 4, 13, 21, 30]


def test_shape_keys_of_the_user_stand_in_the_way(capsys):
    first = drawing("First")
    first.shape_key_add(name="Basis")
    first.shape_key_add(name="Smile")
    second = posed(drawing("Second", (0, 3, 0)), (4, 21))
    join(first, second)
    assert "Smile" in capsys.readouterr().out


def test_a_curve_that_cannot_be_edited_leaves_a_list_to_work_with(capsys):
    first = posed(drawing("First"), (1, 13))
    curve_of(first).lock = True
    second = posed(drawing("Second", (0, 3, 0)), (4, 21))
    go_to(4)
    expected = in_world(second)
    joined = join(first, second)
    assert "locked" in capsys.readouterr().out
    curve_of(joined).lock = False
    assert frames_of(joined) == [1, 13]
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert in_world(joined)[65:] == pytest.approx(expected, abs=TOLERANCE)


def test_drawings_from_elsewhere():
    first, second = DRAWINGS["outline"](), DRAWINGS["text"]()
    for obj, frames in ((first, (1, 13)), (second, (4, 21))):
        left, _middle, right = extremes(obj)
        add_pins(obj, [left], [right])
        size = np.ptp(in_world(obj), axis=0).max()
        for number, frame in enumerate(frames):
            pull(obj, frame, (0.05 * size, 0.1 * size * (number + 1)))
    assert_joined_plays(first, second)
