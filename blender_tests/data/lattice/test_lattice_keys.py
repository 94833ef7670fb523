# SPDX-License-Identifier: GPL-3.0-or-later
"""A lattice's poses over time: keyed, listed, filled in and baked as those of a drawing."""

import bpy
import numpy as np
import pytest
from filling import stale
from sequences import curve_of, go_to, same
from support import TRANSFORMS, activate, coordinates, evaluated, grid, make_object
from test_lattice_posing import TURNED, deform, lattice, layered, pin_at, points, solid, world


def bend(cage, amount, turn=0.0):
    """Show the lattice bent and turned in its plane."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(cage)
    drawing = begin_shape(bpy.context)
    rotation = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    drawing.write(bent(drawing.rest, amount) @ np.array(rotation))


def bent(rest, amount):
    """n x 2 positions of a bar bent about its middle by an angle that grows to `amount` from end to end."""
    middle, width = rest.mean(axis=0), np.ptp(rest[:, 0])
    along, across = (rest - middle).T
    angle = amount * along / width
    radius = width / amount
    return middle + np.stack(
        [(radius - across) * np.sin(angle), radius - (radius - across) * np.cos(angle)], axis=1
    )


def shown(*objects):
    return [evaluated(obj) for obj in objects]


def keyed(cage, objects, amounts):
    """Poses bent, or bent and turned, by each amount (by frame), and what the meshes show there."""
    result = {}
    for frame, amount in amounts.items():
        activate(cage)
        go_to(frame)
        bend(cage, *np.atleast_1d(amount))
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
        result[frame] = shown(*objects)
    return result


def shown_at(objects, frame):
    go_to(frame)
    return shown(*objects)


def two_layers(matrix=TURNED):
    """A flat lattice of two equal layers about one drawing."""
    drawing = make_object(*grid(12, 6), name="Drawing")
    cage = lattice((9, 8, 2), (3.6, 2.2, 1.0), (1.0, 0.55, 0.0), matrix=matrix)
    drawing.matrix_world = matrix.copy()
    deform(drawing, cage)
    activate(cage)
    return cage, drawing


@pytest.mark.parametrize("build", [layered, solid, two_layers])
@pytest.mark.parametrize("transform", ["none", "rotated", "stretched", "mirrored", "sheared"])
def test_keyed_poses_are_shown_again_at_their_frames(build, transform):
    cage, *objects = build(matrix=TRANSFORMS[transform])
    if transform == "sheared":
        for obj in (cage, *objects):
            shear(obj)
    poses = keyed(cage, objects, {1: 0.3, 9: -1.2, 20: 2.0})
    assert [pose.frame for pose in cage.planar.poses] == [1, 9, 20]
    assert {block.interpolation for block in cage.data.shape_keys.key_blocks[2:]} == {"KEY_LINEAR"}
    for frame in (20, 1, 9):
        for now, then in zip(shown_at(objects, frame), poses[frame], strict=True):
            np.testing.assert_allclose(now, then, atol=1e-6 * max(1.0, np.abs(then).max()))
    assert cage.planar.active_pose == 1


def test_a_keyed_pose_is_what_was_dragged_and_a_drag_at_a_key_changes_it():
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 3)
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    rest = shown(back, front)
    go_to(10)
    assert bpy.ops.planar.drag_pins(offset=(0.3, 0.2)) == {"FINISHED"}
    posed = shown(back, front)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    for now, then in zip(shown(back, front), posed, strict=True):
        np.testing.assert_array_equal(now, then)
    for now, then in zip(shown_at((back, front), 1), rest, strict=True):
        np.testing.assert_array_equal(now, then)
    go_to(10)
    assert bpy.ops.planar.drag_pins(offset=(-0.1, 0.0)) == {"FINISHED"}
    changed = shown(back, front)
    go_to(1)
    for now, then in zip(shown_at((back, front), 10), changed, strict=True):
        np.testing.assert_array_equal(now, then)
    assert len(cage.planar.poses) == 2


def test_what_is_posed_between_keys_goes_with_the_frame_until_it_is_keyed():
    cage, back, front = layered()
    pin_at(front, 3)
    keyed(cage, (back, front), {1: 0.3, 9: -0.6})
    go_to(5)
    between = shown(back, front)
    assert bpy.ops.planar.drag_pins(offset=(0.3, 0.2)) == {"FINISHED"}
    assert not np.array_equal(evaluated(front), between[1])
    go_to(6)
    for now, then in zip(shown_at((back, front), 5), between, strict=True):
        np.testing.assert_array_equal(now, then)


def test_auto_key_keys_every_drag():
    cage, _, front = layered()
    pin_at(front, 3)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    bpy.context.preferences.edit.use_keyframe_insert_available = False
    for frame in (1, 7):
        go_to(frame)
        assert bpy.ops.planar.drag_pins(offset=(0.1, 0.0)) == {"FINISHED"}
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = False
    assert [pose.frame for pose in cage.planar.poses] == [1, 7]


def test_poses_are_deleted_duplicated_moved_updated_and_cleared_to_the_bit():
    cage, back, front = layered()
    bend(cage, 0.4)
    before = points(cage)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    poses = {1: shown(back, front), **keyed(cage, (back, front), {9: -1.2})}
    go_to(15)
    assert bpy.ops.planar.duplicate_pose(pose=0) == {"FINISHED"}
    for now, then in zip(shown(back, front), poses[1], strict=True):
        np.testing.assert_allclose(now, then, atol=1e-6)
    assert bpy.ops.planar.retime_pose(pose=1, frame=21.0) == {"FINISHED"}
    for now, then in zip(shown_at((back, front), 21), poses[9], strict=True):
        np.testing.assert_allclose(now, then, atol=1e-6)
    bend(cage, 0.9)
    assert bpy.ops.planar.update_pose(pose=0) == {"FINISHED"}
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert cage.data.shape_keys is None
    assert same(points(cage), before)
    assert not cage.planar.poses


def test_the_pose_key_of_a_lattice_is_taken_over_and_given_back():
    cage, back, front = layered()
    cage.shape_key_add(name="Basis")
    bend(cage, 0.4)
    before = coordinates(cage.data.shape_keys.key_blocks["Pose"].data)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    keyed(cage, (back, front), {9: -1.2})
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert cage.data.shape_keys.use_relative
    assert same(coordinates(cage.data.shape_keys.key_blocks["Pose"].data), before)


@pytest.mark.parametrize("build", [layered, two_layers])
@pytest.mark.parametrize("transform", ["none", "rotated", "stretched", "mirrored"])
def test_in_betweens_swing_and_what_is_keyed_stays(build, transform):
    cage, *objects = build(matrix=TRANSFORMS[transform])
    poses = keyed(cage, objects, {1: 0.01, 13: (0.5, 2.2)})
    activate(cage)
    lengths = {}
    for way in ("blended", "generated"):
        if way == "generated":
            assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
        go_to(7)
        lengths[way] = length(cage)
    straight = length_of(rest_of(cage))
    assert lengths["blended"] < 0.6 * straight
    assert abs(lengths["generated"] - straight) < 0.02 * straight
    for frame, pose in poses.items():
        for now, then in zip(shown_at(objects, frame), pose, strict=True):
            np.testing.assert_allclose(now, then, atol=2e-6 * max(1.0, np.abs(then).max()))
    generated = shown_at(objects, 7)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert not np.allclose(shown_at(objects, 7)[0], generated[0], atol=1e-2)


def shear(obj):
    """As a parent with unequal scales does it."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    obj.parent, obj.matrix_parent_inverse = parent, TRANSFORMS["sheared"]


def rest_of(cage):
    from planar_deform.scene.objects.any_object import read_shape

    return read_shape(cage).rest


def length(cage):
    from planar_deform.scene.objects.any_object import read_shape

    return length_of(read_shape(cage).positions)


def length_of(positions):
    """From left to right through the middle of the first layer (9 points along u, 8 along v)."""
    row = (positions[27:36] + positions[36:45]) / 2.0
    return np.linalg.norm(np.diff(row, axis=0), axis=1).sum()


def place_of(obj, vertices):
    return world(obj, evaluated(obj)[vertices]).mean(axis=0)


@pytest.mark.parametrize("path", ["STRAIGHT", "ARC"])
@pytest.mark.parametrize("smooth", [False, True])
def test_a_pin_that_stands_in_both_poses_stands_between_them(path, smooth):
    cage, back, front = layered()
    pin_at(back, 14)
    pin_at(front, 20)
    held = place_of(back, [14])
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(13)
    bpy.ops.planar.rotate_pins(angle=1.2, pivot=held.tolist())
    bpy.ops.planar.drag_pins(offset=(-0.5, 0.9))
    size = np.linalg.norm(np.ptp(world(back, evaluated(back)), axis=0))
    start = np.linalg.norm(place_of(back, [14]) - held)
    assert start < 6e-3
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    poses = {frame: shown_at((back, front), frame) for frame in (1, 13)}
    assert bpy.ops.planar.generate_inbetweens(path=path, smooth=smooth) == {"FINISHED"}
    for frame in range(2, 13):
        go_to(frame)
        assert np.linalg.norm(place_of(back, [14]) - held) < start + 1e-4 * size
    for frame, pose in poses.items():
        for now, then in zip(shown_at((back, front), frame), pose, strict=True):
            np.testing.assert_allclose(now, then, atol=2e-6)
    assert len(cage.planar.pins) == 2


def test_a_point_of_the_lattice_that_is_pinned_stands_too():
    cage, back, _ = layered()
    assert bpy.ops.planar.add_pin(lattice_point=31) == {"FINISHED"}
    pin_at(back, 12)
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    held = points(cage)[31]
    go_to(13)
    bpy.ops.planar.drag_pins(offset=(-0.9, 1.2))
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    block = cage.data.shape_keys.key_blocks[cage.planar.poses[1].name]
    end = np.array(block.data[31].co)
    for inbetween in cage.data.shape_keys.key_blocks[3:-1]:
        gap = np.abs(np.array(inbetween.data[31].co) - held).max()
        assert gap <= np.abs(end - held).max() + 1e-4


def test_in_betweens_are_stale_when_other_pins_hold_the_lattice():
    cage, back, front = layered()
    pin_at(back, 14)
    pin_at(front, 20)
    keyed(cage, (back, front), {1: 0.3, 13: (0.5, 1.0)})
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert stale(cage) == []
    cage.planar.pins[0].enabled = False
    bpy.context.view_layer.update()
    assert stale(cage) == [(0, 1)]
    cage.planar.pins[0].enabled = True
    assert stale(cage) == []
    assert bpy.ops.planar.add_pin(lattice_point=0) == {"FINISHED"}
    assert stale(cage) == [(0, 1)]


def test_the_onion_skin_is_the_border_of_the_lattice():
    from planar_deform.scene.view.onion import of_active

    cage, *objects = layered()
    keyed(cage, objects, {1: 0.3, 13: 1.0})
    cage.planar.show_onion = True
    go_to(5)
    onion = of_active(bpy.context)
    assert len(onion.edges) == 2 * (8 + 7)
    for shape, pose in ((onion.before, 0), (onion.behind, 1)):
        block = cage.data.shape_keys.key_blocks[cage.planar.poses[pose].name]
        np.testing.assert_array_equal(shape, coordinates(block.data))


def test_equal_layers_stay_equal_in_between():
    cage, drawing = two_layers()
    keyed(cage, [drawing], {1: 0.01, 13: 2.5})
    activate(cage)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    from planar_deform.scene.objects.any_object import read_shape

    for frame in (4, 7, 10):
        go_to(frame)
        first, second = read_shape(cage).positions.reshape(2, -1, 2)
        np.testing.assert_allclose(first, second, atol=2e-4)


def test_a_key_with_cells_turned_over_does_not_hinder_in_betweens():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.3, 9: -1.2})
    for block in cage.data.shape_keys.key_blocks:
        if block.name == cage.planar.poses[1].name:
            block.data[40].co.x += 0.4
            block.data[41].co = block.data[42].co
    go_to(9)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert np.isfinite(shown_at(objects, 5)[0]).all()


def test_depth_between_poses_goes_in_proportion():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.3, 9: -1.2})
    for point in cage.data.shape_keys.key_blocks[cage.planar.poses[1].name].data:
        point.co.z += 0.8
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    go_to(1)
    start = shown(*objects)[0][:, 2]
    heights = [np.median(shown_at(objects, frame)[0][:, 2] - start) for frame in (3, 5, 9)]
    scale = heights[2]
    np.testing.assert_allclose(heights, scale * np.array([0.25, 0.5, 1.0]), atol=1e-5)


def test_of_a_lattice_in_space_blenders_blend_is_told_and_a_breakdown_lies_on_it():
    cage, sheet = solid()
    keyed(cage, [sheet], {1: 0.3, 9: -1.2})
    activate(cage)
    with pytest.raises(RuntimeError, match="is a lattice in space, between whose poses Blender blends"):
        bpy.ops.planar.generate_inbetweens()
    go_to(5)
    start, end = shown_at([sheet], 1)[0], shown_at([sheet], 9)[0]
    go_to(5)
    assert bpy.ops.planar.breakdown(percent=25.0) == {"FINISHED"}
    np.testing.assert_allclose(evaluated(sheet), 0.75 * start + 0.25 * end, atol=2e-6)
    assert [pose.frame for pose in cage.planar.poses] == [1, 5, 9]


def test_a_breakdown_of_a_flat_lattice_swings():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.01, 13: (0.5, 2.2)})
    activate(cage)
    go_to(7)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    straight = length_of(rest_of(cage))
    assert abs(length(cage) - straight) < 0.02 * straight


def test_shapes_are_baked_to_every_frame():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: 2.2})
    activate(cage)
    bpy.ops.planar.generate_inbetweens()
    before = {frame: shown_at(objects, frame) for frame in range(1, 10)}
    activate(cage)
    assert bpy.ops.planar.bake(to="SHAPES", frame_start=1, frame_end=9) == {"FINISHED"}
    assert [pose.frame for pose in cage.planar.poses] == list(range(1, 10))
    assert {point.interpolation for point in list(curve_of(cage).keyframe_points)[:-1]} == {"LINEAR"}
    for frame, then in before.items():
        for now, was in zip(shown_at(objects, frame), then, strict=True):
            np.testing.assert_allclose(now, was, atol=2e-6)


def test_relative_keys_are_baked_and_the_basis_is_the_regular_lattice():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: 2.2})
    before = {frame: shown_at(objects, frame) for frame in range(1, 10)}
    activate(cage)
    assert bpy.ops.planar.bake(to="RELATIVE_KEYS", frame_start=1, frame_end=9) == {"FINISHED"}
    keys = cage.data.shape_keys
    assert keys.use_relative
    np.testing.assert_array_equal(coordinates(keys.reference_key.data), coordinates(cage.data.points))
    for frame, then in before.items():
        for now, was in zip(shown_at(objects, frame), then, strict=True):
            np.testing.assert_allclose(now, was, atol=2e-6)


def test_no_point_cache_is_baked_of_a_lattice_and_the_reason_is_told(tmp_path):
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: 2.2})
    activate(cage)
    with pytest.raises(RuntimeError, match="is not a mesh: bake to Shapes or Relative Keys"):
        bpy.ops.planar.bake(to="POINT_CACHE", filepath=str(tmp_path / "a.pc2"), frame_start=1, frame_end=9)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("build", [layered, two_layers])
@pytest.mark.parametrize("transform", ["none", "rotated", "stretched", "mirrored"])
def test_a_pose_is_copied_to_another_frame_and_to_a_lattice_alike(build, transform):
    cage, *objects = build(matrix=TRANSFORMS[transform])
    bend(cage, 1.1, 0.4)
    pose, posed = points(cage), shown(*objects)
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert not np.allclose(evaluated(objects[0]), posed[0], atol=0.1)
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    for now, then in zip(shown(*objects), posed, strict=True):
        np.testing.assert_allclose(now, then, atol=2e-6)
    activate(lattice(tuple(getattr(cage.data, f"points_{axis}") for axis in "uvw"), (1, 1, 1), (9, 0, 0)))
    twin = bpy.context.object
    assert twin != cage
    twin.matrix_world = cage.matrix_world.copy()
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    np.testing.assert_allclose(points(twin), pose, atol=1e-6)


@pytest.mark.parametrize("build", [layered, two_layers])
@pytest.mark.parametrize(("axis", "column"), [("HORIZONTAL", 0), ("VERTICAL", 1)])
def test_a_pose_is_mirrored_point_by_point(build, axis, column):
    cage, *_ = build()
    bend(cage, 1.1, 0.4)
    u, v, w = cage.data.points_u, cage.data.points_v, cage.data.points_w
    pose = points(cage).reshape(w, v, u, 3)
    assert bpy.ops.planar.mirror_pose(axis=axis) == {"FINISHED"}
    expected = np.flip(pose, axis=2 - column).copy()
    expected[..., column] *= -1.0
    np.testing.assert_allclose(points(cage).reshape(w, v, u, 3), expected, atol=2e-6)


def test_a_pose_is_not_carried_where_it_does_not_fit_and_the_reason_is_told():
    cage, *_ = layered()
    bend(cage, 1.1)
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    activate(lattice((5, 8, 1), (1, 1, 1), (9, 0, 0), "Other"))
    with pytest.raises(RuntimeError, match="of another lattice: this one has 40 vertices, not 72"):
        bpy.ops.planar.paste_pose()
    activate(make_object(*grid(4, 4)))
    with pytest.raises(RuntimeError, match="of another mesh: this one has faces, not cells"):
        bpy.ops.planar.paste_pose()
    sheared = lattice((9, 8, 1), (1, 1, 1), (9, 0, 0), "Sheared")
    shear(sheared)
    activate(sheared)
    before = points(sheared)
    with pytest.raises(RuntimeError, match="not symmetric at rest"):
        bpy.ops.planar.mirror_pose()
    assert same(points(sheared), before)


@pytest.mark.parametrize("name", ["copy_pose", "paste_pose", "mirror_pose"])
def test_poses_in_space_are_not_carried_and_the_reason_is_told(name):
    solid()
    with pytest.raises(RuntimeError, match="is a lattice in space, whose poses lie in no plane"):
        getattr(bpy.ops.planar, name)()


def test_the_motion_of_pins_of_a_lattice_is_not_recorded_and_the_reason_is_told():
    layered()
    with pytest.raises(RuntimeError, match="is a lattice"):
        bpy.ops.planar.record_pins()


def test_a_motion_is_transferred_to_a_lattice_alike_and_refused_to_another():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: 2.2})
    twin = lattice((9, 8, 1), (1.8, 1.1, 1.0), (5.0, 0.0, 0.0), "Twin")
    other = lattice((5, 8, 1), (1.8, 1.1, 1.0), (5.0, 0.0, 0.0), "Other")
    activate(cage)
    other.select_set(True)
    with pytest.raises(RuntimeError, match="built differently"):
        bpy.ops.planar.transfer_motion()
    other.select_set(False)
    twin.select_set(True)
    assert bpy.ops.planar.transfer_motion() == {"FINISHED"}
    assert [pose.frame for pose in twin.planar.poses] == [1, 9]
    go_to(9)
    np.testing.assert_allclose(
        length(twin) / length_of(rest_of(twin)), length(cage) / length_of(rest_of(cage)), rtol=0.02
    )


def test_foreign_keys_of_a_lattice_are_refused():
    cage, *_ = layered()
    cage.shape_key_add(name="Basis")
    cage.shape_key_add(name="Mine")
    with pytest.raises(RuntimeError, match="shape keys of its own .Mine."):
        bpy.ops.planar.key_pose()


def test_undo_and_saving_keep_the_poses(tmp_path):
    cage, *objects = layered()
    bpy.ops.ed.undo_push(message="Start")
    poses = keyed(cage, objects, {1: 0.1, 9: 2.2})
    bpy.ops.ed.undo_push(message="Keyed")
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Generated")
    filled = shown_at(objects, 5)
    bpy.ops.ed.undo()
    cage, *objects = (bpy.data.objects[name] for name in ("Lattice", "Back", "Front"))
    assert len(cage.data.shape_keys.key_blocks) == 4
    bpy.ops.ed.redo()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    cage, *objects = (bpy.data.objects[name] for name in ("Lattice", "Back", "Front"))
    for now, then in zip(shown_at(objects, 5), filled, strict=True):
        np.testing.assert_array_equal(now, then)
    for now, then in zip(shown_at(objects, 9), poses[9], strict=True):
        np.testing.assert_allclose(now, then, atol=2e-6)
