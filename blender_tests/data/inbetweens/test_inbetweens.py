# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens: what the frames between keyed poses show, and that all of it can be taken back to the bit."""

import bpy
import numpy as np
import pytest
from filling import (
    FRAMES,
    bent,
    bent_bar,
    curve_fields,
    everything,
    frames_shown,
    generate,
    put,
    remove,
    shown,
    stale,
)
from sequences import curve_of, go_to, key, same, timing, write
from support import PLANES, activate, add_pins, bar, coordinates, evaluated, grid, make_object, world

import planar_native


def native_frames(obj, shapes, **options):
    """The frames of a cutout between poses (shapes by frame), solved anew, as shapes of the object."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    drawing = begin_shape(bpy.context)
    frames = sorted(shapes)
    times = np.arange(frames[0], frames[-1] + 1)
    found = planar_native.inbetween(
        [drawing.flattened(shapes[frame]) for frame in frames],
        times,
        **drawing.elements,
        key_times=frames,
        rest=drawing.rest,
        **options,
    )
    result = {}
    for frame, positions in zip(times.tolist(), found, strict=True):
        after = next(other for other in frames if other >= frame)
        before = max(other for other in frames if other <= frame)
        share = 0.0 if after == before else (frame - before) / (after - before)
        blend = shapes[before].astype(float) * (1.0 - share) + shapes[after].astype(float) * share
        result[frame] = drawing.moved(blend.astype(np.float32), positions)
    return result


def assert_shows(obj, expected, tolerance=1e-6):
    size = np.ptp(coordinates(obj.data.vertices), axis=0).max()
    for frame, shape in expected.items():
        assert np.abs(shown(obj, frame) - shape).max() < tolerance * size, frame


@pytest.mark.parametrize("plane", PLANES)
def test_every_frame_shows_the_frame_that_the_solver_gives_and_keyed_ones_the_pose_to_the_bit(plane):
    obj, poses = bent_bar(plane=plane)
    obj.matrix_world = [[1.0, 0.4, 0.0, 3.0], [-0.3, 2.0, 0.1, -1.0], [0.0, 0.2, 1.5, 2.0], [0, 0, 0, 1]]
    generate(obj)
    for frame, pose in poses.items():
        assert same(shown(obj, frame), pose)
    assert_shows(obj, native_frames(obj, poses))
    assert stale(obj) == []
    assert [pose.generated for pose in obj.planar.poses] == [23, 23, 0]
    assert len(timing(obj)) == 3


def test_smooth_and_the_path_are_the_solvers():
    obj, poses = bent_bar((1, 9, 30))
    generate(obj, smooth=True, path="ARC")
    assert_shows(obj, native_frames(obj, poses, smooth=True, anchor_path="arc"))
    assert obj.planar.smooth
    assert obj.planar.anchor_path == "ARC"
    generate(obj)  # as they are
    assert_shows(obj, native_frames(obj, poses, smooth=True, anchor_path="arc"))
    generate(obj, smooth=False)
    assert_shows(obj, native_frames(obj, poses, anchor_path="arc"))


def test_turns_are_extra_and_counter_clockwise():
    obj, poses = bent_bar((1, 25), (0.5, 0.7))
    generate(obj)
    plain = shown(obj, 13)
    obj.planar.poses[0].turns = 1
    assert stale(obj) == [(0, 1)]
    generate(obj)
    assert_shows(obj, native_frames(obj, poses, turns=[[1]]))
    turned = shown(obj, 13)
    middle = plain.mean(axis=0)
    assert np.abs(turned - (2.0 * middle - plain)).max() < 0.02  # half a turn at half of the time
    early = shown(obj, 7) - shown(obj, 7).mean(axis=0)
    start = poses[1] - poses[1].mean(axis=0)
    assert (start[:, 0] * early[:, 1] - start[:, 1] * early[:, 0]).sum() > 0.0
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())


def test_a_planted_pin_stays_where_it_is_and_the_rest_swings_about_it():
    obj = bar()
    column = list(range(0, 65, 13))
    add_pins(obj, column, range(12, 65, 13))
    rest = coordinates(obj.data.vertices)[:, :2].astype(float)

    def turned(angle):
        c, s = np.cos(angle), np.sin(angle)
        centre = rest[column].mean(axis=0)
        return (rest - centre) @ np.array([[c, s], [-s, c]]) + centre

    put(obj, {1: turned(0.0), 25: turned(2.0)})
    generate(obj)
    for frame in range(1, 26):
        shape = shown(obj, frame)[:, :2]
        assert np.abs(shape[column].mean(axis=0) - rest[column].mean(axis=0)).max() < 1e-6
        assert np.abs(shape - turned(2.0 * (frame - 1) / 24)).max() < 1e-5
    # Pins that move do not hold the middle, which no pin is at.
    obj.planar.pins[0].enabled = False
    put(obj, {25: turned(2.0) + np.array([1.0, 0.0])})
    generate(obj)
    moved = [shown(obj, frame)[12:65:13, :2].mean(axis=0) for frame in (1, 13, 25)]
    assert np.abs(moved[1] - (moved[0] + moved[2]) / 2).max() < 1e-6


def test_depths_and_what_the_cutout_does_not_have_are_blended():
    vertices, faces = grid(6, 3)
    back, _ = grid(6, 3, origin=(0.2, 0.1), depth=-0.5)
    loose = [[5.0, 5.0, 1.0]]
    obj = make_object(np.concatenate([vertices, back, loose]), [*faces.tolist(), *(faces + 28).tolist()])
    put(obj, {1: bent(None, coordinates(obj.data.vertices)[:56, :2].astype(float), 0.5)})
    obj.data.shape_keys.key_blocks[2].data[56].co = (9.0, 1.0, 4.0)
    put(obj, {9: bent(None, coordinates(obj.data.vertices)[:56, :2].astype(float), -0.9)})
    block = obj.data.shape_keys.key_blocks[3]
    block.data[56].co = (1.0, 5.0, 0.0)
    depths = coordinates(block.data)
    depths[28:56, 2] += 1.0
    block.data.foreach_set("co", depths.ravel())
    generate(obj)
    middle = shown(obj, 5)
    assert np.allclose(middle[56], [5.0, 3.0, 2.0], atol=1e-6)
    assert np.allclose(middle[:28, 2], 0.0, atol=1e-6)
    assert np.allclose(middle[28:56, 2], 0.0, atol=1e-6)


def test_timing_stays_a_matter_of_the_curve():
    obj, poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50))
    curve = curve_of(obj)
    for point, frame in zip(curve.keyframe_points, (5, 53, 65), strict=True):
        point.co[0] = frame
    curve.update()
    assert same(shown(obj, 5), poses[1])
    assert same(shown(obj, 53), poses[25])
    assert same(shown(obj, 65), poses[49])
    for frame in range(1, 25):  # twice as slow, then twice as fast
        assert np.abs(shown(obj, 5 + 2 * (frame - 1)) - before[frame]).max() < 1e-5
        assert np.abs(shown(obj, 53 + (frame - 1) / 2) - before[24 + frame]).max() < 1e-5
    assert stale(obj) == []


def test_generating_again_after_retiming_fills_the_new_frames():
    obj, poses = bent_bar()
    generate(obj)
    obj.planar.poses[1].frame = 37
    generate(obj)
    assert [pose.generated for pose in obj.planar.poses] == [35, 11, 0]
    assert_shows(obj, native_frames(obj, {1: poses[1], 37: poses[25], 49: poses[49]}))


def eased(obj):
    """Easing of many kinds on the poses' keys."""
    curve = curve_of(obj)
    first, second, third, *_ = curve.keyframe_points
    first.interpolation, first.easing = "SINE", "EASE_IN"
    second.interpolation, second.type = "BEZIER", "EXTREME"
    second.handle_left_type = second.handle_right_type = "FREE"
    second.handle_left = (17.3, second.co[1] - 3.3331)
    second.handle_right = (30.7, second.co[1] + 1.2347)
    third.handle_left_type = third.handle_right_type = "AUTO"
    between = curve.keyframe_points.insert(40, curve.keyframe_points[1].co[1] + 4.123)
    between.interpolation = "BEZIER"
    curve.modifiers.new("NOISE").mute = True
    curve.update()


def test_easing_stays_and_plays_the_generated_shapes():
    obj, poses = bent_bar()
    eased(obj)
    places = {frame: (curve_of(obj).evaluate(frame) - 1024.0) / 8.0 for frame in np.arange(1.0, 26.0, 0.5)}
    generate(obj)
    solved = native_frames(obj, poses)
    kinds = [point.interpolation for point in curve_of(obj).keyframe_points]
    for frame, share in places.items():
        exact = 1.0 + 24.0 * share
        low, part = int(exact), exact % 1.0
        expected = solved[low] * (1.0 - part) + solved[min(low + 1, 49)] * part
        # A place is told to 1.2e-4 of 8 in float32, here of a way of about 2.
        assert np.abs(shown(obj, frame) - expected).max() < 3e-5
    write_over(obj, 25)
    generate(obj)
    assert [point.interpolation for point in curve_of(obj).keyframe_points] == kinds
    assert kinds == ["SINE", "BEZIER", "BEZIER", "LINEAR"]


def write_over(obj, frame, seed=5):
    """Change the pose of a frame a little."""
    go_to(frame)
    return write(obj, seed)


@pytest.mark.parametrize("kind", ["linear", "eased", "twos", "held", "loop", "crossed", "unkeyed", "shared"])
def test_removing_restores_what_was_there_to_the_bit(kind):
    obj, _ = bent_bar()
    curve = curve_of(obj)
    if kind == "eased":
        eased(obj)
    if kind == "twos":
        bpy.ops.planar.step_poses()
    if kind in {"held", "loop"}:
        curve.keyframe_points.insert({"held": 35, "loop": 73}[kind], curve.keyframe_points[1].co[1])
        curve.update()
    if kind == "crossed":
        curve.keyframe_points[0].co[0] = 30
        curve.update()
    if kind == "unkeyed":
        curve.keyframe_points.remove(curve.keyframe_points[1])
    if kind == "shared":
        bpy.context.preferences.edit.use_duplicate_action = False
        bpy.ops.object.duplicate()
        bpy.context.preferences.edit.use_duplicate_action = True
        activate(obj)
    obj.planar.active_pose = 1
    go_to(41)
    before, seen = everything(obj), evaluated(obj)
    for options in ({}, {"path": "ARC"}, {"path": "STRAIGHT"}):
        generate(obj, **options)
        assert stale(obj) == []
    assert not same(shown(obj, 41), seen)
    remove(obj)
    go_to(41)
    after = everything(obj)
    if kind == "shared":  # the twin keeps the action it had, and this object has its own
        before[-1] += 1
    assert after == before
    assert same(evaluated(obj), seen)
    generate(obj)
    generated = everything(obj)
    remove(obj)
    generate(obj)
    assert everything(obj) == generated


def test_generating_again_is_generating_from_scratch():
    obj, _ = bent_bar()
    eased(obj)
    generate(obj)
    write_over(obj, 25)
    assert stale(obj) == [(0, 1), (1, 2)]
    go_to(1)
    generate(obj)
    again = everything(obj)
    assert stale(obj) == []
    remove(obj)
    generate(obj)
    assert everything(obj) == again


def test_what_is_stale_is_told():
    from planar_deform.scene.sequence import stretches

    obj, _ = bent_bar((1, 10, 20, 30))
    assert not stretches.has_inbetweens(obj)
    assert stale(obj) == []
    generate(obj)
    write_over(obj, 30)
    assert stale(obj) == [(2, 3)]
    generate(obj)
    obj.planar.smooth = True
    assert stale(obj) == [(0, 1), (1, 2), (2, 3)]
    generate(obj)
    write_over(obj, 30)
    assert stale(obj) == [(1, 2), (2, 3)]  # smooth: the neighbours' ways change, too
    obj.planar.smooth = False
    generate(obj)
    key(obj, 50, 8)
    assert stale(obj) == [(3, 4)]  # not filled yet
    generate(obj)
    basis = obj.data.shape_keys.reference_key
    basis.data[0].co[0] -= 0.1
    obj.data.update()
    bpy.context.view_layer.update()
    assert len(stale(obj)) == 4
    remove(obj)
    assert stale(obj) == []


def test_holds_and_neighbouring_frames_are_not_filled():
    obj, poses = bent_bar((1, 10, 20, 21))
    go_to(10)
    held = evaluated(obj)
    put(obj, {15: held[:, :2].astype(float)})  # another pose that is the same
    generate(obj)
    assert [pose.generated for pose in obj.planar.poses] == [8, 0, 4, 0, 0]
    assert all(np.abs(shown(obj, frame) - held).max() < 1e-6 for frame in (10, 12, 12.5, 15))
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())
    assert stale(obj) == []


def test_a_loop_has_a_pose_of_its_own_at_its_end_which_follows_the_first_until_it_is_edited():
    obj, poses = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points.insert(73, curve.keyframe_points[0].co[1]).interpolation = "LINEAR"
    curve.update()
    generate(obj)
    names = [pose.name for pose in obj.planar.poses]
    assert names == ["Pose", "Pose.001", "Pose.002", "Pose Repeat"]
    assert_shows(obj, native_frames(obj, {**poses, 73: poses[1]}))
    edited = write_over(obj, 1)
    assert stale(obj) == [(0, 1), (2, 3)]
    generate(obj)
    assert same(shown(obj, 73), edited)
    assert_shows(obj, native_frames(obj, {**poses, 1: edited, 73: edited}))
    remove(obj)
    assert len(obj.planar.poses) == 3
    assert [value for _, value, _ in timing(obj)] == [1024, 1032, 1040, 1024]
    generate(obj)
    last = write_over(obj, 73)
    generate(obj)
    assert same(shown(obj, 1), edited)
    assert same(shown(obj, 73), last)
    remove(obj)
    assert len(obj.planar.poses) == 4
    assert same(shown(obj, 73), last)


def test_poses_moved_past_one_another_in_the_dope_sheet_are_put_in_order():
    obj, poses = bent_bar()
    generate(obj)
    curve = curve_of(obj)
    curve.keyframe_points[0].co[0] = 37
    curve.update()
    assert stale(obj) != []
    generate(obj)
    assert stale(obj) == []
    assert_shows(obj, native_frames(obj, {25: poses[25], 37: poses[1], 49: poses[49]}))
    assert [pose.frame for pose in obj.planar.poses] == [25, 37, 49]


def test_an_unkeyed_pose_stays_shown():
    from planar_deform.scene.sequence import pose_state

    obj, poses = bent_bar()
    unkeyed = write_over(obj, 13)
    for act in (generate, generate, remove):
        act(obj)
        assert pose_state.unkeyed(obj)
        assert same(evaluated(obj), unkeyed)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert same(shown(obj, 13), unkeyed)
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())


def generating(obj):
    from planar_deform.scene.inbetweens import planning, writing
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    drawing = begin_shape(bpy.context)
    plan = planning.plan(drawing, path="ARC")
    return writing.write(drawing, plan, plan.solve())


@pytest.mark.parametrize("kind", ["new", "again", "crossed"])
def test_ended_early_everything_is_back_to_the_bit(kind):
    obj, _ = bent_bar((1, 4, 7, 12))
    eased(obj)
    if kind == "again":
        generate(obj)
        write_over(obj, 4)
        obj.planar.poses[2].frame = 10
    if kind == "crossed":
        curve_of(obj).keyframe_points[0].co[0] = 9
        curve_of(obj).update()
    go_to(2)
    seen = write(obj, 9) if kind == "again" else evaluated(obj)  # unkeyed
    before = everything(obj)
    for stop in range(60):
        running = generating(obj)
        try:
            for _ in range(stop):
                share = next(running)
                assert share == 1.0 or same(evaluated(obj), seen)  # then the rest comes in one piece
        except StopIteration:
            assert stop > 10
            break
        running.close()
        assert everything(obj) == before, stop
        assert same(evaluated(obj), seen)
    assert everything(obj) != before


def test_an_error_while_writing_puts_everything_back(monkeypatch):
    from planar_deform.scene.inbetweens.plan import Plan

    obj, _ = bent_bar()
    before = everything(obj)
    calls = []

    def fails(self, transition, share, positions):
        calls.append(share)
        if len(calls) > 20:
            raise MemoryError
        return self.shapes[transition]

    monkeypatch.setattr(Plan, "coordinates", fails)
    with pytest.raises(MemoryError):
        for _ in generating(obj):
            pass
    assert everything(obj) == before


def test_a_thousand_frames():
    obj, poses = bent_bar((1, 1001))
    generate(obj)
    assert obj.planar.poses[0].generated == 999
    names = [block.name for block in obj.data.shape_keys.key_blocks]
    assert names[2:5] == ["Pose", "Pose +1", "Pose +2"]
    assert len(set(names)) == len(names)
    frames = native_frames(obj, poses)
    assert_shows(obj, {frame: frames[frame] for frame in range(1, 1002, 37)})
    assert all(same(shown(obj, frame), pose) for frame, pose in poses.items())
    remove(obj)
    assert len(obj.data.shape_keys.key_blocks) == 4


def test_world_transforms_count():
    """A drawing that is stretched as an object bends as it is seen."""
    obj, poses = bent_bar((1, 25), (0.0, 2.0))
    generate(obj)
    plain = shown(obj, 13)
    remove(obj)
    obj.scale = (1.0, 3.0, 1.0)
    bpy.context.view_layer.update()
    generate(obj)
    assert np.abs(shown(obj, 13) - plain).max() > 0.01
    assert_shows(obj, native_frames(obj, poses))
    assert np.isfinite(world(obj)).all()


def test_modifiers_of_the_curve_are_the_users():
    obj, poses = bent_bar()
    bpy.ops.planar.step_poses(step=2)
    generate(obj)
    assert [kind for kind, _ in curve_fields(obj)[1]] == ["STEPPED"]
    assert same(shown(obj, 4), shown(obj, 3))
    assert not same(shown(obj, 5), shown(obj, 3))
    assert all(same(shown(obj, frame), poses[frame]) for frame in FRAMES)
