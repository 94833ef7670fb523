# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on what a lattice deforms, and on its points, pose it as they pose a drawing: as Blender shows it."""

import bpy
import numpy as np
import pytest
from lattice_scenes import deform, lattice, layered, moved_by, pin_at, points, seen, shown, solid
from mathutils import Matrix
from support import TRANSFORMS, activate, coordinates, evaluated, grid, make_object, world

from planar_deform.scene.pins.pose_holding import unheld


@pytest.mark.parametrize("build", [layered, solid])
def test_what_blender_shows_is_what_was_solved(build):
    cage, *objects = build()
    obj = objects[-1]
    pin_at(objects[0], 0)
    pin_at(obj, len(obj.data.vertices) - 1)
    before = shown(obj, len(obj.data.vertices) - 1)
    held = shown(objects[0], 0)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.15)) == {"FINISHED"}
    after = shown(obj, len(obj.data.vertices) - 1)
    np.testing.assert_allclose(after - before, moved_by(cage, 0.2, 0.15), atol=6e-3)
    np.testing.assert_allclose(shown(objects[0], 0), held, atol=6e-3)
    marks = seen()
    np.testing.assert_allclose(marks.pin(1).place, after, atol=1e-5)
    drawing, positions = marks.shape
    count = 0
    for one in objects:
        rows = slice(count, count + len(one.data.vertices))
        np.testing.assert_allclose(drawing.to_world(positions)[rows], world(one, evaluated(one)), atol=3e-6)
        count = rows.stop


def test_a_flat_lattice_moves_nothing_out_of_its_plane():
    cage, _back, front = layered()
    pin_at(front, 0)
    pin_at(front, 48)
    depth = evaluated(front)[:, 2]
    bpy.ops.planar.drag_pins(offset=(0.3, -0.2))
    bpy.ops.planar.rotate_pins(angle=0.4)
    np.testing.assert_allclose(evaluated(front)[:, 2], depth, atol=4e-7)
    np.testing.assert_array_equal(points(cage)[:, 2], coordinates(cage.data.points)[:, 2])


def test_a_point_of_the_lattice_is_dragged_in_turn_with_a_pin():
    cage, back, _ = layered()
    pin_at(back, 0)
    assert bpy.ops.planar.add_pin(lattice_point=40) == {"FINISHED"}
    assert cage.planar.pins[1].lattice_point == 40
    start = world(cage, points(cage)[[40]])[0]
    np.testing.assert_allclose(seen().pin(1).place, start, atol=1e-6)
    bpy.ops.planar.drag_pins(offset=(0.1, 0.2))
    np.testing.assert_allclose(
        world(cage, points(cage)[[40]])[0] - start, moved_by(cage, 0.1, 0.2), atol=6e-3
    )
    held = world(cage, points(cage)[[40]])[0]
    assert bpy.ops.planar.drag_pins(pin=0, offset=(-0.1, 0.0)) == {"FINISHED"}
    np.testing.assert_allclose(world(cage, points(cage)[[40]])[0], held, atol=6e-3)
    assert bpy.ops.planar.add_pin(lattice_point=40) == {"FINISHED"}  # it has one
    assert len(cage.planar.pins) == 2


def test_a_patch_is_turned_and_its_angle_is_kept():
    cage, back, _ = layered()
    group = back.vertex_groups.new(name="Hand")
    group.add([vertex for vertex in range(91) if vertex % 13 > 7], 1.0, "REPLACE")
    assert bpy.ops.planar.add_pin_from_group(object="Back", group="Hand", kind="PATCH") == {"FINISHED"}
    pin_at(back, 0)
    bpy.ops.planar.select_pins(action="SELECT", pin=0)
    before = world(back, evaluated(back))
    bpy.ops.planar.rotate_pins(angle=0.5)
    after = world(back, evaluated(back))
    arm, turned = before[12] - before[8], after[12] - after[8]
    cosine = arm @ turned / np.linalg.norm(arm) / np.linalg.norm(turned)
    assert np.arccos(cosine) == pytest.approx(0.5, abs=0.03)
    assert cage.planar.pins[0].angle == pytest.approx(0.5)
    assert seen().pin(0).angle == pytest.approx(0.5, abs=5e-3)
    bpy.ops.planar.reset_selected_pins()
    assert cage.planar.pins[0].angle == pytest.approx(0.0)
    np.testing.assert_allclose(world(back, evaluated(back)), before, atol=6e-3)


def test_spreading_and_switching_off():
    cage, back, _ = layered()
    for vertex in (0, 12, 78, 90):
        pin_at(back, vertex, extend=True)
    centre = world(back, evaluated(back)[[0, 12, 78, 90]])
    bpy.ops.planar.spread_pins(factor=0.8)
    after = world(back, evaluated(back)[[0, 12, 78, 90]])
    middle = centre.mean(axis=0)
    np.testing.assert_allclose(after, middle + 0.8 * (centre - middle), atol=2e-2)
    bpy.ops.planar.disable_pins()
    assert not any(pin.enabled for pin in cage.planar.pins)
    bpy.ops.planar.enable_pins()
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}


def test_reset_to_rest_is_rest_to_the_bit():
    cage, back, _ = layered()
    pin_at(back, 0)
    before = points(cage)
    bpy.ops.planar.drag_pins(offset=(0.4, 0.0))
    assert not np.array_equal(points(cage), before)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    np.testing.assert_array_equal(points(cage), coordinates(cage.data.points))


def test_what_is_told_of_a_pose_that_no_pin_has_made_is_possible_for_a_lattice():
    cage, back, _ = layered()
    pin_at(back, 0)
    shape = points(cage)
    shape[:, 0] += 0.3 * shape[:, 1] ** 2
    cage.data.points.foreach_set("co_deform", shape.ravel())
    activate(cage)
    told = unheld(cage, lambda: seen().distortion)
    assert told is not None
    assert "Pin all that is to stay" in told
    assert "Set Rest" not in told


def test_in_space_pins_are_moved_across_the_view_at_their_own_depth():
    cage, sheet = solid()
    pin_at(sheet, 0)
    last = len(sheet.data.vertices) - 1
    pin_at(sheet, last)
    facing = np.array([0.3, -0.8, 0.52])
    facing /= np.linalg.norm(facing)
    before = shown(sheet, last)
    assert bpy.ops.planar.drag_pins(offset=(0.15, 0.1), facing=facing.tolist()) == {"FINISHED"}
    moved = shown(sheet, last) - before
    assert abs(moved @ facing) < 5e-3
    assert np.linalg.norm(moved) == pytest.approx(np.hypot(0.15, 0.1), abs=1e-2)
    assert cage.planar.pins[1].has_target


def test_equal_drags_give_equal_bits():
    def posed():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        cage, back, front = layered()
        pin_at(back, 0)
        pin_at(front, 20)
        bpy.ops.planar.drag_pins(offset=(0.3, 0.2))
        bpy.ops.planar.rotate_pins(angle=0.3, pivot=(0, 0, 0))
        return points(cage)

    np.testing.assert_array_equal(posed(), posed())


def test_saved_and_loaded_it_is_posed_on(tmp_path):
    _, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 20)
    bpy.ops.planar.drag_pins(offset=(0.3, 0.2))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    cage = bpy.data.objects["Lattice"]
    assert [pin.object.name for pin in cage.planar.pins] == ["Back", "Front"]
    held = shown(bpy.data.objects["Front"], 20)
    np.testing.assert_allclose(seen().pin(1).place, held, atol=1e-5)
    assert bpy.ops.planar.drag_pins(pin=0, offset=(0.1, 0.0)) == {"FINISHED"}
    np.testing.assert_allclose(shown(bpy.data.objects["Front"], 20), held, atol=1e-2)


def test_the_active_shape_key_of_a_lattice_is_posed():
    cage, back, _ = layered()
    pin_at(back, 0)
    pin_at(back, 12)
    cage.shape_key_add(name="Basis")
    cage.shape_key_add(name="Bent", from_mix=False).value = 0.8
    cage.active_shape_key_index = 1
    bpy.context.view_layer.update()
    held, before = shown(back, 0), shown(back, 12)
    basis = coordinates(cage.data.shape_keys.key_blocks[0].data)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    np.testing.assert_allclose(shown(back, 12) - before, moved_by(cage, 0.2, 0.1), atol=6e-3)
    np.testing.assert_allclose(shown(back, 0), held, atol=6e-3)
    np.testing.assert_array_equal(coordinates(cage.data.shape_keys.key_blocks[0].data), basis)
    np.testing.assert_allclose(seen().pin(1).place, shown(back, 12), atol=1e-5)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    np.testing.assert_array_equal(coordinates(cage.data.shape_keys.key_blocks[1].data), basis)


def test_with_the_basis_active_a_pose_key_is_made():
    cage, back, _ = layered()
    pin_at(back, 12)
    pin_at(back, 0)
    cage.shape_key_add(name="Basis")
    bpy.context.view_layer.update()
    before = shown(back, 0)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    assert [key.name for key in cage.data.shape_keys.key_blocks] == ["Basis", "Pose"]
    np.testing.assert_allclose(shown(back, 0) - before, moved_by(cage, 0.2, 0.1), atol=6e-3)


@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize("build", [layered, solid])
def test_any_transform(build, transform):
    cage, *objects = build(TRANSFORMS[transform])
    obj = objects[-1]
    last = len(obj.data.vertices) - 1
    pin_at(objects[0], 0)
    pin_at(obj, last)
    size = max(np.ptp(world(cage, points(cage)), axis=0))
    before, held = shown(obj, last), shown(objects[0], 0)
    assert bpy.ops.planar.drag_pins(offset=(0.05 * size, -0.04 * size)) == {"FINISHED"}
    moved = shown(obj, last) - before
    assert np.linalg.norm(moved) == pytest.approx(np.hypot(0.05, 0.04) * size, abs=5e-3 * size)
    np.testing.assert_allclose(shown(objects[0], 0), held, atol=5e-3 * size)
    marks = seen()
    np.testing.assert_allclose(marks.pin(1).place, shown(obj, last), atol=2e-5 * size)


def test_a_mesh_that_a_flat_lattice_sees_edge_on():
    cage, back, _ = layered(Matrix())
    back.rotation_euler.x = np.pi / 2
    bpy.context.view_layer.update()
    pin_at(back, 0)
    pin_at(back, 12)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    bpy.data.objects.remove(bpy.data.objects["Front"])
    activate(cage)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    assert np.isfinite(points(cage)).all()


def test_a_flat_lattice_bends_a_solid_thing_without_moving_it_in_depth():
    cage, sheet = solid(Matrix())
    cage.data.points_w = 1
    bpy.context.view_layer.update()
    last = len(sheet.data.vertices) - 1
    pin_at(sheet, 0)
    pin_at(sheet, last)
    depth, before = evaluated(sheet)[:, 2], shown(sheet, last)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.3)) == {"FINISHED"}
    np.testing.assert_allclose(evaluated(sheet)[:, 2], depth, atol=4e-7)
    np.testing.assert_allclose(shown(sheet, last) - before, [0.2, 0.3, 0.0], atol=1e-2)
    assert seen().distortion.flipped == 0


def test_poses_by_pins_are_keyed_and_played():
    cage, back, _ = layered()
    pin_at(back, 0)
    pin_at(back, 12)
    scene = bpy.context.scene
    scene.tool_settings.use_keyframe_insert_auto = True
    bpy.context.preferences.edit.use_keyframe_insert_available = False  # on in Blender 5.2
    keyed = {}
    for frame, offset in ((1, (0.0, 0.1)), (11, (0.2, 0.1)), (21, (-0.1, 0.3))):
        scene.frame_set(frame)
        assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}
        keyed[frame] = shown(back, 12)
    assert [pose.frame for pose in cage.planar.poses] == [1, 11, 21]
    for frame, place in keyed.items():
        scene.frame_set(frame)
        np.testing.assert_allclose(shown(back, 12), place, atol=1e-5)
        np.testing.assert_allclose(seen().pin(1).place, place, atol=1e-5)
    scene.frame_set(11)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.1)) == {"FINISHED"}  # it goes into the pose that is keyed
    again = shown(back, 12)
    assert not np.allclose(again, keyed[11], atol=1e-3)
    scene.frame_set(1)
    scene.frame_set(11)
    np.testing.assert_allclose(shown(back, 12), again, atol=1e-5)
    assert len(cage.planar.poses) == 3


@pytest.mark.parametrize("turn", [(9, 8, 2), (2, 9, 8), (8, 2, 9)])
def test_two_equal_layers_are_posed_as_one(turn):
    axis = turn.index(2)
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    columns = np.eye(4)[:, [*(order.index(i) for i in range(3)), 3]]
    upright = Matrix(columns.tolist())  # the lattice's axes are those of the drawing in another order
    obj = make_object(*grid(12, 6), name="Back")
    size = [3.0] * 3
    size[order[0]], size[order[1]] = 3.6, 2.2
    cage = lattice(turn, size, (0.0, 0.0, 0.0), matrix=Matrix.Translation((1.0, 0.55, 0.1)) @ upright)
    deform(obj, cage)
    activate(cage)
    pin_at(obj, 0)
    pin_at(obj, 90)
    depth, before = evaluated(obj)[:, 2], shown(obj, 90)
    for _ in range(3):  # small ones too leave the layers equal
        assert bpy.ops.planar.drag_pins(offset=(1e-4, 0.0)) == {"FINISHED"}
    assert bpy.ops.planar.rotate_pins(angle=0.3, pivot=(1.0, 0.5, 0.0)) == {"FINISHED"}
    assert np.linalg.norm(shown(obj, 90) - before) > 0.2
    np.testing.assert_allclose(evaluated(obj)[:, 2], depth, atol=4e-7)
    marks = seen()
    assert marks.distortion.flipped == 0
    np.testing.assert_allclose(marks.pin(1).place, shown(obj, 90), atol=1e-5)
    last = len(cage.data.points) - 1
    assert bpy.ops.planar.add_pin(lattice_point=last) == {"FINISHED"}
    place = world(cage, points(cage)[[last]])[0]
    np.testing.assert_allclose(seen().pin(2).place[:2], place[:2], atol=1e-6)
    moved = points(cage) - coordinates(cage.data.points)
    by_layer = np.moveaxis(moved.reshape(*reversed(turn), 3), 2 - axis, 0)
    np.testing.assert_allclose(by_layer[0], by_layer[1], atol=1e-6)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    np.testing.assert_array_equal(points(cage), coordinates(cage.data.points))
