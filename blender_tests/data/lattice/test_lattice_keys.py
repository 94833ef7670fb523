# SPDX-License-Identifier: GPL-3.0-or-later
"""A lattice's poses over time: keyed, listed, baked, carried as those of a drawing."""

import base64

import bpy
import numpy as np
import pytest
from lattice_poses import (
    bend,
    keyed,
    length,
    length_of,
    place_of,
    rest_of,
    shear,
    shown,
    shown_at,
    two_layers,
)
from lattice_scenes import lattice, layered, pin_at, points, solid
from sequences import curve_of, go_to, same
from support import TRANSFORMS, activate, coordinates, evaluated, grid, make_object


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


MOVED = [(0.0, 0.0, 0.0), (0.1, 0.05, 0.0), (0.2, 0.2, 0.0), (0.2, 0.4, 0.0), (0.1, 0.5, 0.0)]
PATH = base64.b64encode(np.array(MOVED, "<f4").tobytes()).decode()


@pytest.mark.parametrize("build", [layered, two_layers])
@pytest.mark.parametrize("transform", ["none", "rotated", "mirrored"])
def test_the_motion_of_a_pin_is_recorded_and_what_is_pinned_elsewhere_stays(build, transform):
    cage, *objects = build(matrix=TRANSFORMS[transform])
    pin_at(objects[0], 0)
    pin_at(objects[0], 90)
    held, start = place_of(objects[0], [0]), place_of(objects[0], [90])
    assert bpy.ops.planar.record_pins(path=PATH, frame=3, smoothing=0.0) == {"FINISHED"}
    assert [pose.frame for pose in cage.planar.poses] == [3, 4, 5, 6, 7]
    for frame, (du, dv, _) in enumerate(MOVED, 3):
        go_to(frame)
        np.testing.assert_allclose(place_of(objects[0], [0]), held, atol=8e-3)
        moved = place_of(objects[0], [90]) - start
        np.testing.assert_allclose(np.linalg.norm(moved), np.hypot(du, dv), atol=8e-3)


def test_a_second_recording_lets_the_first_one_go_on():
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 20)
    first = place_of(front, [20])
    assert bpy.ops.planar.record_pins(path=PATH, frame=1, smoothing=0.0) == {"FINISHED"}
    go_to(3)
    recorded = place_of(front, [20])
    go_to(1)
    assert bpy.ops.planar.record_pins(pin=0, path=PATH, frame=1, smoothing=0.0) == {"FINISHED"}
    assert len(cage.planar.poses) == 5
    go_to(3)
    np.testing.assert_allclose(place_of(front, [20]), recorded, atol=2e-2)
    assert np.linalg.norm(recorded - first) > 0.2


def test_in_space_nothing_is_recorded_and_the_reason_is_told():
    solid()
    with pytest.raises(RuntimeError, match="is a lattice in space, and motion is recorded in a plane"):
        bpy.ops.planar.record_pins()


def test_a_pose_goes_from_a_lattice_of_one_layer_to_one_of_two():
    cage, *_ = layered()
    bend(cage, 1.1)
    pose = points(cage)
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    twin = lattice((9, 8, 2), (1, 1, 1), (0, 0, 0), "Twin")
    twin.matrix_world = cage.matrix_world.copy()
    activate(twin)
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    for layer, depth in zip(points(twin).reshape(2, -1, 3), (-0.5, 0.5), strict=True):
        np.testing.assert_allclose(layer[:, :2], pose[:, :2], atol=1e-6)
        np.testing.assert_allclose(layer[:, 2], depth, atol=1e-6)


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
