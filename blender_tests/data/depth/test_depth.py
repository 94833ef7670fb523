# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths of pins: where a drawing lies on itself, and nothing else of it changes."""

import bpy
import numpy as np
import pytest
from drawings import DRAWINGS, extremes
from sequences import go_to, key
from support import TRANSFORMS, activate, add_end_pins, add_pins, bar, coordinates, evaluated, pose, world


def drawing_of(obj):
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    return begin(bpy.context)


def give(obj, depth, *, relative=False):
    activate(obj)
    assert bpy.ops.planar.set_depth(depth=depth, relative=relative) == {"FINISHED"}


def heights(obj):
    """In object-local lengths along Z, in depths."""
    size = np.linalg.norm(np.ptp(coordinates(obj.data.vertices)[:, :2], axis=0))
    return evaluated(obj)[:, 2] / (5e-4 * size)


def test_a_depth_raises_the_drawing_evenly_from_pin_to_pin():
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    give(obj, 2.0)
    after = coordinates(obj.data.vertices)
    assert np.array_equal(after[:, :2], before[:, :2])
    # A pin holds the triangle that it is in.
    expected = heights(obj)
    assert expected.max() == pytest.approx(2.0, rel=1e-5)
    assert expected.min() == pytest.approx(0.0, abs=1e-6)
    along = expected.reshape(5, 13).mean(axis=0)
    assert (np.diff(along) > -1e-6).all()
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 2.0], abs=1e-4)


def test_the_field_gives_it_to_all_selected_pins():
    obj = bar()
    add_end_pins(obj)
    for pin in obj.planar.pins:
        pin.select = True
    obj.planar.pins[1].depth = -1.5
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([-1.5, -1.5], abs=1e-4)
    assert heights(obj) == pytest.approx(np.full(65, -1.5), abs=1e-4)


def test_forward_and_backward_stop_at_the_limits_and_say_so(capfd):
    obj = bar()
    add_end_pins(obj)
    give(obj, 9.5)
    give(obj, 1.0, relative=True)
    assert obj.planar.pins[1].depth == pytest.approx(10.0, abs=1e-3)
    capfd.readouterr()
    give(obj, 1.0, relative=True)
    assert "10 is the largest depth" in capfd.readouterr().out
    give(obj, -1.0, relative=True)
    assert obj.planar.pins[1].depth == pytest.approx(9.0, abs=1e-3)


def test_pins_that_are_off_hold_no_depth_and_get_none():
    obj = bar()
    add_end_pins(obj)
    obj.planar.pins[0].enabled = False
    give(obj, 3.0)
    assert heights(obj) == pytest.approx(np.full(65, 3.0), abs=1e-3)
    obj.planar.pins[1].enabled = False
    before = coordinates(obj.data.vertices)
    with pytest.raises(RuntimeError, match="No pins that hold"):
        bpy.ops.planar.set_depth(depth=1.0)
    assert np.array_equal(coordinates(obj.data.vertices), before)


@pytest.mark.parametrize("transform", TRANSFORMS)
def test_in_front_is_where_blender_shows_the_faces_fronts(transform):
    obj = bar(triangles=True)
    obj.matrix_world = TRANSFORMS[transform]
    add_end_pins(obj)
    give(obj, 4.0)
    assert coordinates(obj.data.vertices)[:, 2].max() > 0.0  # the faces' normals are +Z in the mesh
    assert abs(coordinates(obj.data.vertices)[:, 2].min()) < 1e-6
    assert obj.planar.pins[1].depth == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize("method", ["HOLD", "AKVF", "ARAP"])
def test_posing_does_not_see_depths(transform, method):
    found = []
    for depth in (0.0, 7.0):
        obj = bar()
        obj.matrix_world = TRANSFORMS[transform]
        obj.planar.method = method
        add_end_pins(obj, kind="PATCH")
        if depth:
            give(obj, depth)
        size = drawing_of(obj).cutout.diagonal
        pose(obj, offset=(-0.2 * size, 0.3 * size), angle=1.0)
        shown = drawing_of(obj)
        pins = [(*shown.from_local(np.array([pin.target]))[0], pin.angle) for pin in obj.planar.pins]
        found.append((shown.positions / size, np.array(pins) / size, shown.frame))
        if depth:
            assert obj.planar.pins[1].depth == pytest.approx(depth, abs=0.01)
            assert obj.planar.pins[0].depth == pytest.approx(0.0, abs=0.01)
    (flat, pins, frame), (raised, raised_pins, raised_frame) = found
    far = 1.0 + np.abs(flat).max()
    assert np.abs(raised - flat).max() <= 2e-6 * far
    assert np.abs(raised_pins - pins).max() <= 2e-5 * far
    assert frame.n @ raised_frame.n == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("name", DRAWINGS)
def test_imported_drawings_keep_their_plane(name):
    obj = DRAWINGS[name]()
    ends = extremes(obj)
    add_pins(obj, *[[row] for row in ends])
    before = drawing_of(obj)
    give(obj, 10.0)
    give(obj, -10.0, relative=True)
    give(obj, 10.0)
    after = drawing_of(obj)
    assert np.abs(after.positions - before.positions).max() <= 1e-6 * before.diagonal
    assert [pin.depth for pin in obj.planar.pins][-1] == pytest.approx(10.0, abs=0.01)
    assert after.depths.min() >= -0.01
    front = obj.matrix_world.to_3x3() @ obj.data.polygons[0].normal
    moved = (world(obj) - before.to_world(before.positions, before.parts)) @ np.array(front)
    assert moved.max() > 0.0


def test_a_mesh_bent_by_hand_is_still_refused():
    obj = bar()
    add_end_pins(obj)
    bent = coordinates(obj.data.vertices)
    bent[:, 2] = 0.05 * (bent[:, 0] - 1.0) ** 2
    obj.data.vertices.foreach_set("co", bent.ravel())
    with pytest.raises(RuntimeError, match="parallel planes"):
        bpy.ops.planar.set_depth(depth=1.0)


def test_reset_to_rest_takes_depths_away_to_the_bit():
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    give(obj, 5.0)
    pose(obj, offset=(0.1, 0.3))
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert np.array_equal(coordinates(obj.data.vertices), before)
    assert obj.planar.pins[1].depth == 0.0


def keyed_crossing():
    """A bar with a pose of depth 3 at frame 1, and one of -1 at frame 11, moved."""
    obj = bar()
    add_end_pins(obj)
    bpy.context.scene.frame_set(1)
    give(obj, 3.0)
    key(obj, 1)
    bpy.context.scene.frame_set(11)
    pose(obj, offset=(-0.3, 0.5))
    give(obj, -1.0)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    return obj


def shown_depth(obj, frame):
    bpy.context.scene.frame_set(frame)
    return obj.planar.pins[1].depth


def test_keyed_poses_have_their_depths():
    obj = keyed_crossing()
    assert shown_depth(obj, 1) == pytest.approx(3.0, abs=1e-3)
    assert shown_depth(obj, 11) == pytest.approx(-1.0, abs=1e-3)
    assert shown_depth(obj, 6) == pytest.approx(1.0, abs=1e-3)  # Blender blends them
    bpy.context.scene.frame_set(1)
    give(obj, 1.0, relative=True)  # goes into the keyed pose
    assert shown_depth(obj, 11) == pytest.approx(-1.0, abs=1e-3)
    assert shown_depth(obj, 1) == pytest.approx(4.0, abs=1e-3)


@pytest.mark.parametrize("between", ["BLENDED", "HELD"])
def test_depths_of_in_betweens(between):
    obj = keyed_crossing()
    obj.planar.depth_between = between
    activate(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    found = [shown_depth(obj, frame) for frame in range(1, 12)]
    expected = np.linspace(3.0, -1.0, 11) if between == "BLENDED" else [3.0] * 10 + [-1.0]
    assert found == pytest.approx(expected, abs=0.01)


def test_in_betweens_are_out_of_date_when_the_choice_changes():
    from planar_deform.scene.sequence import stretches

    obj = keyed_crossing()
    activate(obj)
    bpy.ops.planar.generate_inbetweens()
    assert stretches.stale(obj) == []
    obj.planar.depth_between = "HELD"
    assert stretches.stale(obj) == [(0, 1)]
    bpy.ops.planar.generate_inbetweens()
    assert stretches.stale(obj) == []


def test_a_breakdown_has_the_depth_of_its_share():
    obj = keyed_crossing()
    bpy.context.scene.frame_set(6)
    activate(obj)
    assert bpy.ops.planar.breakdown(percent=25.0) == {"FINISHED"}
    assert obj.planar.pins[1].depth == pytest.approx(2.0, abs=0.01)


def test_copy_and_paste_carry_depths_to_another_size():
    obj = bar()
    add_end_pins(obj)
    give(obj, 3.0)
    pose(obj, offset=(0.0, 0.4))
    activate(obj)
    bpy.ops.planar.copy_pose()
    other = bar()
    other.scale = (3.0, 3.0, 3.0)
    add_end_pins(other)
    activate(other)
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    assert [pin.depth for pin in other.planar.pins] == pytest.approx([0.0, 3.0], abs=0.01)


def test_mirror_swaps_the_depths():
    obj = bar()
    add_end_pins(obj)
    give(obj, 3.0)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([3.0, 0.0], abs=0.01)


def test_an_asymmetric_drawing_is_mirrored_by_pins_with_their_depths():
    obj = bar()
    add_end_pins(obj)
    obj.planar.pins[0].name, obj.planar.pins[1].name = "Hand.L", "Hand.R"
    obj.data.vertices[30].co.y += 0.07
    activate(obj)
    bpy.ops.planar.set_rest_to_current()
    give(obj, 3.0)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([3.0, 0.0], abs=0.01)


def test_auto_key_keys_a_depth():
    obj = bar()
    add_end_pins(obj)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    bpy.context.preferences.edit.use_keyframe_insert_available = False
    give(obj, 2.0)
    assert len(obj.planar.poses) == 1
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = False


def test_transferred_motion_carries_depths():
    obj = keyed_crossing()
    other = bar(name="Other")
    other.scale = (2.0, 2.0, 2.0)
    add_end_pins(other)
    activate(obj)
    other.select_set(True)
    assert bpy.ops.planar.transfer_motion() == {"FINISHED"}
    activate(other)
    assert shown_depth(other, 1) == pytest.approx(3.0, abs=0.01)
    assert shown_depth(other, 11) == pytest.approx(-1.0, abs=0.01)


def test_saved_and_opened(tmp_path):
    obj = keyed_crossing()
    obj.planar.depth_between = "HELD"
    path = str(tmp_path / "depth.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    activate(obj)
    assert obj.planar.depth_between == "HELD"
    assert shown_depth(obj, 1) == pytest.approx(3.0, abs=1e-3)


def test_applied_transforms_keep_depths():
    obj = bar()
    obj.rotation_euler, obj.scale = (np.pi / 2, 0.0, 0.3), (2.0, 2.0, 2.0)
    add_end_pins(obj)
    give(obj, 3.0)
    activate(obj)
    bpy.ops.object.transform_apply()
    activate(obj)
    drawing_of(obj)
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 3.0], abs=0.01)


def test_parts_without_pins_keep_their_depths():
    obj = bar()
    other = bar(name="Other")
    for vertex in other.data.vertices:
        vertex.co.y += 2.0
    activate(obj)
    other.select_set(True)
    bpy.ops.object.join()
    add_end_pins(obj)
    give(obj, 3.0)
    assert drawing_of(obj).depths[65:] == pytest.approx(np.zeros(65), abs=1e-5)


def test_a_lattice_is_refused():
    lattice = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.context.scene.collection.objects.link(lattice)
    activate(lattice)
    assert not bpy.ops.planar.set_depth.poll()


def test_blended_materials_are_dithered_by_one_click():
    obj = bar()
    material = bpy.data.materials.new("Ink")
    obj.data.materials.append(material)
    material.surface_render_method = "BLENDED"
    activate(obj)
    assert bpy.ops.planar.dither_materials() == {"FINISHED"}
    assert material.surface_render_method == "DITHERED"
    assert not bpy.ops.planar.dither_materials.poll()


def test_joined_drawings_keep_their_depths():
    obj, other = bar(), bar(name="Other")
    other.location = (0.0, 3.0, 0.0)
    other.rotation_euler = (0.0, 0.0, 0.5)
    for one, depth in ((obj, 3.0), (other, -8.0)):
        add_end_pins(one)
        give(one, depth)
    activate(obj)
    other.select_set(True)
    bpy.ops.object.join()
    size = np.linalg.norm((2.0, 1.0)) / drawing_of(obj).diagonal  # a depth is a share of the whole drawing
    depths = np.array([pin.depth for pin in obj.planar.pins]) / size
    assert depths[:2] == pytest.approx([0.0, 3.0], abs=0.05)
    assert depths[3] - depths[2] == pytest.approx(-8.0, abs=0.1)  # the rest of what came is where it lies now


def test_subdivided_drawings_keep_their_depths():
    from support import in_edit_mode

    obj = bar()
    add_end_pins(obj)
    give(obj, 4.0)
    in_edit_mode(obj, bpy.ops.mesh.subdivide)
    activate(obj)
    drawing_of(obj)
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 4.0], abs=0.05)
    pose(obj, offset=(0.1, 0.3))
    assert obj.planar.pins[1].depth == pytest.approx(4.0, abs=0.1)


def test_a_duplicate_has_the_depths_and_goes_its_own_way():
    obj = bar()
    add_end_pins(obj)
    give(obj, 4.0)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy != obj
    give(copy, -4.0)
    assert obj.planar.pins[1].depth == pytest.approx(4.0, abs=1e-3)
    assert copy.planar.pins[1].depth == pytest.approx(-4.0, abs=1e-3)


def test_a_relative_key_holds_a_depth():
    obj = bar()
    add_end_pins(obj)
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Pose")
    obj.active_shape_key_index = 1
    obj.data.shape_keys.key_blocks["Pose"].value = 0.5
    give(obj, 3.0)
    assert heights(obj).max() == pytest.approx(3.0, abs=1e-3)
    assert obj.planar.pins[1].depth == pytest.approx(3.0, abs=1e-2)


def test_other_operators_keep_depths():
    obj = bar()
    add_end_pins(obj)
    give(obj, 3.0)
    pose(obj, offset=(-0.2, 0.4))
    activate(obj)
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}
    assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
    assert obj.planar.pins[1].depth == pytest.approx(3.0, abs=0.01)


def test_remeshing_keeps_depths():
    obj = bar(nx=24, ny=8)
    add_end_pins(obj, 24, 225)
    key(obj, 1)
    go_to(9)
    give(obj, 3.0)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.remesh(source="OUTLINE", vertices=500) == {"FINISHED"}
    assert len(obj.data.vertices) > 300
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 3.0], abs=0.01)
    along = np.sort(heights(obj))
    assert along[0] > -0.05
    assert along[-1] < 3.05
    go_to(1)
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 0.0], abs=1e-4)
    give(obj, 2.0)  # the new mesh has pins that hold other vertices
    assert [pin.depth for pin in obj.planar.pins] == pytest.approx([0.0, 2.0], abs=1e-3)
