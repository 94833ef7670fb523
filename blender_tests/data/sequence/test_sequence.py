# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed poses: what is keyed is what is shown at its frame, however it is timed or edited."""

import bpy
import numpy as np
import pytest
from keyed_bars import frames, keyed_bar, names
from sequences import curve_of, go_to, key, same, shown_at, stored, timing, write
from support import PLANES, activate, add_end_pins, bar, coordinates, evaluated, grid, make_object


@pytest.mark.parametrize("plane", PLANES)
def test_each_keyed_frame_shows_the_pose_keyed_there_to_the_bit(plane):
    obj, shapes = keyed_bar(plane=plane)
    for frame, shape in shapes.items():
        assert same(shown_at(obj, frame), shape)
    assert len({shape.tobytes() for shape in shapes.values()}) == 3


@pytest.mark.parametrize("order", [(25, 1, 49), (49, 25, 1), (25, 49, 1, 13, 37, 36, 38)])
def test_poses_keyed_in_any_order_are_in_the_order_of_time(order):
    obj, shapes = keyed_bar(order)
    assert frames(obj) == [[frame] for frame in sorted(order)]
    for frame, shape in shapes.items():
        assert same(shown_at(obj, frame), shape)
    keys = obj.data.shape_keys
    assert [block.name for block in keys.key_blocks][2:] == names(obj)
    values = [value for _, value, _ in timing(obj)]
    assert values == sorted(values)


def test_between_keys_the_poses_are_blended_linearly_and_nothing_else_is():
    obj, shapes = keyed_bar()
    assert all(interpolation == "LINEAR" for *_, interpolation in timing(obj))
    middle = shown_at(obj, 13).astype(float)
    assert np.abs(middle - (shapes[1].astype(float) + shapes[25]) / 2).max() < 1e-6
    assert same(shown_at(obj, -20), shapes[1])
    assert same(shown_at(obj, 100), shapes[49])


def test_the_basis_is_the_rest_and_the_solver_starts_from_what_is_shown():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar()
    add_end_pins(obj)
    rest = coordinates(obj.data.vertices)
    key(obj, 1, 0)
    key(obj, 25, 1)
    assert same(coordinates(obj.data.shape_keys.reference_key.data), rest)
    for frame in (1, 7.25, 25):
        go_to(frame)
        drawing = begin(bpy.context)
        assert np.abs(drawing.positions - drawing.from_local(evaluated(obj).astype(float))).max() < 1e-6
        assert np.abs(drawing.cutout.rest - drawing.from_local(rest.astype(float))).max() < 1e-7


def test_posing_at_a_keyed_frame_edits_that_pose():
    obj, shapes = keyed_bar()
    go_to(25)
    blocks = len(obj.data.shape_keys.key_blocks)
    edited = write(obj, 7)
    assert len(obj.data.shape_keys.key_blocks) == blocks
    assert not same(edited, shapes[25])
    assert same(shown_at(obj, 1), shapes[1])
    assert same(shown_at(obj, 25), edited)
    assert same(shown_at(obj, 49), shapes[49])


@pytest.mark.parametrize("frame", [13, 60, -5, 25.5])
def test_posing_elsewhere_is_lost_with_the_next_frame_unless_it_is_keyed(frame):
    from planar_deform.scene.sequence import pose_state

    obj, shapes = keyed_bar()
    before = shown_at(obj, frame)
    unkeyed = write(obj, 7)
    assert pose_state.unkeyed(obj)
    assert not same(unkeyed, before)
    go_to(frame + 1)
    assert not pose_state.unkeyed(obj)
    assert same(shown_at(obj, frame), before)
    assert all(same(shown_at(obj, at), shape) for at, shape in shapes.items())
    go_to(frame)
    again = write(obj, 8)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert same(evaluated(obj), again)
    assert not pose_state.unkeyed(obj)
    assert same(shown_at(obj, frame), again)
    assert all(same(shown_at(obj, at), shape) for at, shape in shapes.items())


def test_several_unkeyed_poses_in_a_row_build_on_each_other():
    obj, _ = keyed_bar()
    go_to(13)
    first = write(obj, 7)
    second = write(obj, 8)
    assert np.abs(second - first).max() < 0.04
    assert np.abs(second - first).max() > 0.01
    assert len(obj.data.shape_keys.key_blocks) == 2 + 3 + 2


@pytest.mark.parametrize("easing", ["BACK", "ELASTIC", "BEZIER"])
def test_no_easing_reaches_an_unkeyed_pose(easing):
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    for point in curve.keyframe_points:
        point.interpolation = easing
        point.back = 9.0
        point.handle_left_type = point.handle_right_type = "FREE"
        point.handle_left[1], point.handle_right[1] = point.co[1] - 4000.0, point.co[1] + 4000.0
    curve.update()
    go_to(30)
    write(obj, 7)
    from planar_deform.scene.objects.cutout_object import begin

    drawing = begin(bpy.context)
    drawing.write(drawing.positions + 100.0)  # to be seen at once if it were blended in
    for frame in np.arange(0.0, 52.0, 0.25):
        assert np.abs(shown_at(obj, frame)).max() < 3.0
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_a_curve_that_leaves_the_poses_holds_the_first_and_the_last():
    obj, shapes = keyed_bar()
    go_to(60)
    write(obj, 9)  # the scratch is there
    curve = curve_of(obj)
    curve.keyframe_points[0].co[1] -= 3.0
    curve.keyframe_points[2].co[1] += 300.0
    curve.update()
    assert np.abs(shown_at(obj, 1) - shapes[1]).max() < 0.01
    assert np.abs(shown_at(obj, 49) - shapes[49]).max() < 1e-6


def test_moving_keys_of_the_curve_times_the_poses_again():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    for point, frame in zip(curve.keyframe_points, (5, 11, 80), strict=True):
        point.co[0] = frame
    curve.update()
    for before, after in ((1, 5), (25, 11), (49, 80)):
        assert same(shown_at(obj, after), shapes[before])
    assert frames(obj) == [[5], [11], [80]]


def test_easing_survives_keying_again_and_keying_between():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points[0].interpolation = "SINE"
    curve.keyframe_points[1].interpolation = "BEZIER"
    for point in curve.keyframe_points:
        point.handle_left_type = point.handle_right_type = "FREE"
    curve.keyframe_points[1].handle_right = (30.0, curve.keyframe_points[1].co[1] + 7.0)
    curve.keyframe_points[2].handle_left = (40.0, curve.keyframe_points[2].co[1] - 5.0)
    curve.update()
    between = shown_at(obj, 37).astype(float)
    key(obj, 25)  # as it is
    assert np.abs(shown_at(obj, 37) - between).max() < 1e-6
    key(obj, 13, 5)
    assert [interpolation for *_, interpolation in timing(obj)] == ["SINE", "LINEAR", "BEZIER", "LINEAR"]
    assert np.abs(shown_at(obj, 37) - between).max() < 1e-6
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_a_key_duplicated_in_the_dope_sheet_holds_its_pose_and_a_pose_keyed_on_it_is_one_of_its_own():
    obj, shapes = keyed_bar()
    value = curve_of(obj).keyframe_points[1].co[1]
    curve_of(obj).keyframe_points.insert(35, value)
    assert same(shown_at(obj, 30), shapes[25])
    assert same(shown_at(obj, 35), shapes[25])
    assert frames(obj) == [[1], [25, 35], [49]]
    go_to(35)
    from planar_deform.scene.objects.any_object import key_poses
    from planar_deform.scene.objects.cutout_object import begin

    drawing = begin(bpy.context)
    key_poses(drawing, {35: drawing.positions + 0.25})
    assert same(shown_at(obj, 25), shapes[25])
    assert np.abs(shown_at(obj, 35) - shapes[25]).max() == pytest.approx(0.25, abs=1e-6)
    assert frames(obj) == [[1], [25], [35], [49]]


def test_a_key_of_the_users_own_value_is_retiming_and_is_no_pose():
    obj, shapes = keyed_bar()
    curve = curve_of(obj)
    point = curve.keyframe_points.insert(13, curve.keyframe_points[0].co[1] + 2.0)
    point.interpolation = "LINEAR"
    curve.update()
    blended = shown_at(obj, 13)
    assert np.abs(blended - (0.75 * shapes[1] + 0.25 * shapes[25])).max() < 1e-6
    assert frames(obj) == [[1], [25], [49]]
    shape = key(obj, 5, 6)  # poses behind it move along the curve, and it with them
    assert same(shown_at(obj, 5), shape)
    after = shown_at(obj, 13)
    assert all(same(shown_at(obj, frame), shapes[frame]) for frame in shapes)
    assert np.isfinite(after).all()
    unkeyed = write(obj, 8)
    go_to(13)
    assert not same(shown_at(obj, 13), unkeyed)


def test_poses_at_fractions_of_frames():
    obj, shapes = keyed_bar((1, 1.5, 2.25))
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_many_poses_at_once_by_frame_step():
    from planar_deform.scene.objects.any_object import key_poses
    from planar_deform.scene.objects.cutout_object import begin

    obj, shapes = keyed_bar((1, 200))
    activate(obj)
    go_to(1)
    drawing = begin(bpy.context)
    put = {frame: drawing.positions + 0.001 * frame for frame in range(10, 101, 3)}
    expected = {frame: drawing.coordinates(positions) for frame, positions in put.items()}
    key_poses(drawing, put)
    assert len(obj.planar.poses) == 2 + len(put)
    for frame, shape in {**shapes, **expected}.items():
        assert same(shown_at(obj, frame), shape)
    # once more over a part of it, between and over what is there
    drawing = begin(bpy.context)
    over = {frame: drawing.positions - 0.001 * frame for frame in range(50, 60)}
    expected |= {frame: drawing.coordinates(positions) for frame, positions in over.items()}
    key_poses(drawing, over)
    assert len(obj.planar.poses) == 2 + len(expected)
    for frame, shape in {**shapes, **expected}.items():
        assert same(shown_at(obj, frame), shape)


def test_poses_put_throughout_replace_what_is_keyed_between_them():
    from planar_deform.scene.objects.any_object import key_poses
    from planar_deform.scene.objects.cutout_object import begin

    obj, shapes = keyed_bar((1, 10, 13, 16, 25, 40))
    curve = curve_of(obj)
    curve.keyframe_points.insert(35, curve.keyframe_points[2].co[1])  # 13 is shown at 35, too
    curve.keyframe_points.insert(12, curve.keyframe_points[2].co[1] - 3.0)  # retiming
    activate(obj)
    go_to(1)
    drawing = begin(bpy.context)
    put = {frame: drawing.positions + 0.01 * frame for frame in (10, 14, 18, 22)}
    expected = {frame: drawing.coordinates(positions) for frame, positions in put.items()}
    key_poses(drawing, put, throughout=True)
    assert [frame for frame, *_ in timing(obj)] == [1, 10, 14, 18, 22, 25, 35, 40]
    assert sorted(frames(obj)) == [[1], [10], [14], [18], [22], [25], [35], [40]]
    for frame, shape in {1: shapes[1], **expected, 25: shapes[25], 35: shapes[13], 40: shapes[40]}.items():
        assert same(shown_at(obj, frame), shape)
    # and where that is all there was
    drawing = begin(bpy.context)
    key_poses(drawing, {0: drawing.positions, 50: drawing.positions + 0.1}, throughout=True)
    assert frames(obj) == [[0], [50]]
    assert same(shown_at(obj, 0), shapes[40])


def test_two_hundred_poses_of_five_thousand_vertices(tmp_path):
    from planar_deform.scene.objects.any_object import key_poses
    from planar_deform.scene.objects.cutout_object import begin

    vertices, faces = grid(99, 49)
    obj = make_object(vertices, faces.tolist())
    drawing = begin(bpy.context)
    waves = {
        frame: drawing.positions + 0.1 * np.sin(frame * 0.1 + drawing.positions[:, ::-1] * 3.0)
        for frame in range(1, 201)
    }
    expected = {frame: drawing.coordinates(positions) for frame, positions in waves.items()}
    key_poses(drawing, waves)
    path = str(tmp_path / "long.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    assert len(obj.planar.poses) == 200
    assert all(same(shown_at(obj, frame), shape) for frame, shape in expected.items())
    activate(obj)
    go_to(77)
    shape = write(obj, 1)
    assert same(shown_at(obj, 77), shape)
    assert same(shown_at(obj, 78), expected[78])


def test_cancelling_restores_to_the_bit():
    from planar_deform.scene.objects.cutout_object import begin

    obj, _ = keyed_bar()
    for frame in (13, 25, 60):
        go_to(frame)
        before, shown = stored(obj), evaluated(obj)
        drawing = begin(bpy.context)
        drawing.write(drawing.positions + 0.3)
        drawing.write(drawing.positions + 0.1)
        drawing.restore()
        assert stored(obj) == before
        assert same(evaluated(obj), shown)
    go_to(13)
    unkeyed = write(obj, 4)
    before = stored(obj)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions + 0.3)
    drawing.restore()
    assert stored(obj) == before
    assert same(evaluated(obj), unkeyed)


def test_an_unkeyed_action_leaves_the_keyed_pose_alone():
    from planar_deform.scene.objects.any_object import key_poses
    from planar_deform.scene.objects.cutout_object import begin

    obj, shapes = keyed_bar()
    go_to(25)
    before = stored(obj)
    drawing = begin(bpy.context, unkeyed=True)
    for frame in (25, 26, 27, 49):
        go_to(frame)
        drawing.write(drawing.positions + 0.01 * frame)
        assert np.abs(evaluated(obj) - shapes[25]).max() == pytest.approx(0.01 * frame, abs=1e-6)
    go_to(25)
    drawing.restore()
    assert stored(obj) == before
    key_poses(drawing, {frame: drawing.positions + 0.01 * frame for frame in (26, 28)})
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert frames(obj) == [[1], [25], [26], [28], [49]]


def test_reset_to_rest_and_the_poses_own_rest():
    obj, shapes = keyed_bar()
    rest = coordinates(obj.data.shape_keys.reference_key.data)
    go_to(25)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert same(evaluated(obj), rest)
    assert same(shown_at(obj, 1), shapes[1])
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}
    assert same(evaluated(obj), shapes[1])
    assert same(coordinates(obj.data.shape_keys.reference_key.data), shapes[1])
    assert same(shown_at(obj, 49), shapes[49])


def test_dragging_pins_at_keyed_and_other_frames():
    from planar_deform.scene.sequence import pose_state

    obj, shapes = keyed_bar()
    go_to(25)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.3)) == {"FINISHED"}
    dragged = evaluated(obj)
    assert np.abs(dragged - shapes[25]).max() > 0.2
    go_to(13)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.3)) == {"FINISHED"}
    assert pose_state.unkeyed(obj)
    assert same(shown_at(obj, 25), dragged)
    assert same(shown_at(obj, 1), shapes[1])


@pytest.mark.parametrize("begun", [False, True])
def test_auto_key_keys_what_was_posed(begun):
    obj = bar()
    add_end_pins(obj)
    if begun:
        key(obj, 1)
    tools = bpy.context.scene.tool_settings
    tools.use_keyframe_insert_auto = True
    bpy.context.preferences.edit.use_keyframe_insert_available = False  # on in 5.2
    go_to(25)
    bpy.ops.planar.drag_pins(offset=(0.0, 0.3))
    posed = evaluated(obj)
    assert same(shown_at(obj, 25), posed)
    assert [25] in frames(obj)
    count = len(frames(obj))
    tools.auto_keying_mode = "REPLACE_KEYS"
    go_to(40)
    bpy.ops.planar.drag_pins(offset=(0.0, 0.3))
    assert len(frames(obj)) == count
    tools.auto_keying_mode = "ADD_REPLACE_KEYS"
