# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses are copied, pasted, mirrored and reset, into the mesh, a shape key or a keyed pose alike."""

import bpy
import numpy as np
import pytest
from drawings import character
from sequences import go_to, key, same, shown_at, stored
from support import (
    PLANES,
    activate,
    add_end_pins,
    add_pins,
    bar,
    coordinates,
    evaluated,
    grid,
    make_object,
    measured,
    pose,
    world,
)


def posed(**options):
    obj = bar(**options)
    add_end_pins(obj)
    pose(obj, offset=(0.1, 0.4))
    return obj


def copy(obj):
    activate(obj)
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}


def paste(obj):
    activate(obj)
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}


def target_and_reached(obj, index=1):
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    found = {pin.key: pin for pin in pin_list.model_pins(obj, begin(bpy.context))}[index]
    return found.target, np.array(obj.planar.pins[index].reached)


@pytest.mark.parametrize("plane", PLANES)
def test_a_pose_comes_back_to_the_bit_with_its_pins(plane):
    obj = posed(plane=plane)
    shape, targets = evaluated(obj), target_and_reached(obj)
    copy(obj)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert not same(evaluated(obj), shape)
    paste(obj)
    assert np.abs(evaluated(obj) - shape).max() < 2e-7
    again = target_and_reached(obj)
    assert again[0] == pytest.approx(targets[0], abs=1e-6)
    assert again[1] == pytest.approx(targets[1], abs=1e-6)


def test_on_a_moved_turned_and_scaled_duplicate():
    obj = posed()
    before = obj.matrix_world.copy()
    local = coordinates(obj.data.vertices)
    copy(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    bpy.ops.planar.reset_to_rest()
    twin.location, twin.rotation_euler, twin.scale = (3, 2, 1), (0.4, 0.2, 1.0), (2.0, 2.0, 2.0)
    paste(twin)
    assert coordinates(twin.data.vertices) == pytest.approx(local, abs=1e-6)
    assert target_and_reached(twin)[0] is not None
    assert obj.matrix_world == before


def test_on_the_same_drawing_in_another_plane_and_size():
    obj = posed()
    offsets = coordinates(obj.data.vertices) - coordinates(obj.data.attributes["planar_rest"].data, "vector")
    vertices, faces = grid(12, 4, 6.0, 3.0)
    other = make_object(vertices @ PLANES["XZ"].T, faces.tolist(), name="Other")
    rest = coordinates(other.data.vertices)
    copy(obj)
    paste(other)
    expected = rest + 3.0 * offsets @ PLANES["XZ"].T
    assert coordinates(other.data.vertices) == pytest.approx(expected, abs=1e-5)


def test_in_another_file(tmp_path):
    obj = posed()
    shape = coordinates(obj.data.vertices)
    copy(obj)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    other = bar()
    paste(other)
    assert coordinates(other.data.vertices) == pytest.approx(shape, abs=2e-7)


def test_another_mesh_is_refused_and_told_what_differs():
    copy(posed())
    other = bar(nx=11, name="Other")
    before = stored(other)
    with pytest.raises(RuntimeError, match="60 vertices, not 65"):
        bpy.ops.planar.paste_pose()
    assert stored(other) == before
    triangles = bar(triangles=True, name="Triangles")
    with pytest.raises(RuntimeError, match="96 faces, not 48"):
        bpy.ops.planar.paste_pose()
    assert "planar_rest" not in triangles.data.attributes


def test_nothing_copied(monkeypatch):
    from planar_deform.operators import pose_travel

    monkeypatch.setattr(pose_travel, "_clipboard", None)
    bar()
    with pytest.raises(RuntimeError, match="Copy Pose first"):
        bpy.ops.planar.paste_pose()


def test_pasted_into_a_pose_key_and_into_keyed_and_unkeyed_poses():
    from planar_deform.scene.sequence import pose_state

    source = posed(name="Source")
    shape = coordinates(source.data.vertices)
    copy(source)
    relative = bar(name="Relative")
    relative.shape_key_add(name="Basis")
    paste(relative)
    assert relative.active_shape_key.name == "Pose"
    assert evaluated(relative) == pytest.approx(shape, abs=1e-6)
    keyed = bar(name="Keyed")
    first = key(keyed, 1, 1)
    key(keyed, 25, 2)
    paste(keyed)
    assert shown_at(keyed, 25) == pytest.approx(shape, abs=1e-6)
    go_to(13)
    paste(keyed)
    assert pose_state.unkeyed(keyed)
    assert evaluated(keyed) == pytest.approx(shape, abs=1e-6)
    assert same(shown_at(keyed, 1), first)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    go_to(13)
    paste(keyed)
    assert not pose_state.unkeyed(keyed)
    assert shown_at(keyed, 13) == pytest.approx(shape, abs=1e-6)


@pytest.mark.parametrize("plane", PLANES)
def test_mirrored_left_and_right(plane):
    obj = posed(plane=plane)
    before = coordinates(obj.data.vertices) @ PLANES[plane]  # as it lies in XY
    left, right = target_and_reached(obj, 0)[0], target_and_reached(obj, 1)[0]
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    after = coordinates(obj.data.vertices) @ PLANES[plane]
    expected = before.reshape(5, 13, 3)[:, ::-1].reshape(-1, 3) * [-1, 1, 1] + [2, 0, 0]
    assert after == pytest.approx(expected, abs=1e-6)
    # What the pins were asked for has changed sides with them.
    assert target_and_reached(obj, 0)[0] == pytest.approx(right * [-1, 1] + [2, 0], abs=1e-5)
    assert target_and_reached(obj, 1)[0] == pytest.approx(left * [-1, 1] + [2, 0], abs=1e-5)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert coordinates(obj.data.vertices) @ PLANES[plane] == pytest.approx(before, abs=1e-6)


def test_mirrored_top_and_bottom_with_patches_on_a_scaled_object():
    obj = bar()
    add_end_pins(obj, kind="PATCH")
    obj.scale = (1.5, 0.5, 1.0)
    pose(obj, offset=(0.1, 0.2), angle=0.5)
    before = coordinates(obj.data.vertices)
    assert bpy.ops.planar.mirror_pose(axis="VERTICAL") == {"FINISHED"}
    expected = before.reshape(5, 13, 3)[::-1].reshape(-1, 3) * [1, -1, 1] + [0, 1, 0]
    assert coordinates(obj.data.vertices) == pytest.approx(expected, abs=1e-6)
    assert obj.planar.pins[1].angle == pytest.approx(-0.5, abs=1e-6)
    assert target_and_reached(obj, 1)[0] is not None


def test_what_is_not_symmetric_is_refused_and_told_why():
    obj = bar()
    obj.data.vertices[16].co.x += 0.05
    before = stored(obj)
    with pytest.raises(RuntimeError, match="2 of 65 vertices have no partner within .*the worst is 0.05"):
        bpy.ops.planar.mirror_pose()
    assert stored(obj) == before
    assert bpy.ops.planar.mirror_pose(tolerance=0.05) == {"FINISHED"}
    bar(triangles=True, name="Triangles")
    with pytest.raises(RuntimeError, match="edges have no partner"):
        bpy.ops.planar.mirror_pose()


def pinned_character(names):
    """Woody with pins on both hands, both feet and the head, as far as they tell their sides."""
    obj = character("woody")
    shape = world(obj)[:, [0, 2]]
    low, high = shape.min(axis=0), shape.max(axis=0)
    for name, place in zip(names, ((0, 0.55), (1, 0.55), (0.35, 0), (0.65, 0), (0.5, 1)), strict=True):
        goal = low + (high - low) * place
        add_pins(obj, [int(np.argmin(np.linalg.norm(shape - goal, axis=1)))])
        obj.planar.pins[len(obj.planar.pins) - 1].name = name
    return obj


@pytest.mark.parametrize(
    "names",
    [
        ["Hand.L", "Hand.R", "Foot.L", "Foot.R", "Head"],
        ["LeftHand", "RightHand", "l_foot", "r_foot", "Head"],
        ["Pin", "Pin.001", "Pin.002", "Pin.003", "Pin.004"],
    ],
)
def test_a_character_that_is_not_symmetric_is_mirrored_by_its_pins(names, capfd):
    obj = pinned_character(names)
    size = np.ptp(world(obj), axis=0).max()
    rest = pins_in_world(obj)
    pose(obj, offset=(-0.1 * size, 0.3 * size), moving=[1])
    before, area = pins_in_world(obj), measured(obj).area
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    after = pins_in_world(obj)
    swapped = (before - rest)[[1, 0, 3, 2, 4]] * [-1, 1, 1]
    assert after - rest == pytest.approx(swapped, abs=0.02 * size)
    assert measured(obj).flipped == 0
    assert measured(obj).area == pytest.approx(area, rel=0.1)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert pins_in_world(obj) == pytest.approx(before, abs=0.02 * size)
    assert "Mirrored by 2 pairs of pins, as the rest shape is not symmetric" in capfd.readouterr().out


def test_pins_of_which_none_has_a_partner_mirror_what_the_drawing_does(capfd):
    obj = character("woody")
    add_pins(obj, [int(np.argmax(world(obj)[:, 2]))])
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert "Mirrored with no pairs of pins; the rest shape is not symmetric" in capfd.readouterr().out


def test_a_character_is_mirrored_at_its_frame_in_one_undo_step():
    obj = pinned_character(["Hand.L", "Hand.R", "Foot.L", "Foot.R", "Head"])
    size = np.ptp(world(obj), axis=0).max()
    first = key(obj, 1)
    go_to(25)
    pose(obj, offset=(-0.1 * size, 0.3 * size), moving=[1])
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Start")
    before = stored(obj)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Mirror")
    assert same(shown_at(obj, 1), first)
    go_to(25)
    bpy.ops.ed.undo()
    assert stored(bpy.data.objects["Woody"]) == before


def test_without_pins_that_are_on_nothing_can_be_mirrored_by():
    obj = pinned_character(["Hand.L", "Hand.R", "Foot.L", "Foot.R", "Head"])
    for pin in obj.planar.pins:
        pin.enabled = False
    before = stored(obj)
    with pytest.raises(RuntimeError, match="of 694 vertices have no partner .* pins that are on"):
        bpy.ops.planar.mirror_pose()
    assert stored(obj) == before


def pins_in_world(obj):
    from planar_deform.scene.view import snapshot

    activate(obj)
    snapshot.forget()
    return np.array([pin.place for pin in snapshot.of_active(bpy.context).pins])


def test_a_mirrored_pose_of_a_sequence_stays_at_its_frame():
    obj = bar()
    first = key(obj, 1, 1)
    second = key(obj, 25, 2)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    expected = second.reshape(5, 13, 3)[:, ::-1].reshape(-1, 3) * [-1, 1, 1] + [2, 0, 0]
    assert shown_at(obj, 25) == pytest.approx(expected, abs=1e-6)
    assert same(shown_at(obj, 1), first)


def test_selected_pins_are_reset_and_the_others_hold():
    obj = bar()
    add_end_pins(obj)
    add_pins(obj, [32])
    pose(obj, offset=(0.0, 0.4), moving={1})
    pose(obj, offset=(0.0, -0.2), moving={0})
    for index, pin in enumerate(obj.planar.pins):
        pin.select = index == 1
    held = coordinates(obj.data.vertices)[26]  # in the middle of the column, where the pin is
    assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
    shape = coordinates(obj.data.vertices)
    assert shape[38] == pytest.approx([2.0, 0.5, 0.0], abs=0.01)
    assert shape[26] == pytest.approx(held, abs=0.01)
    for pin in obj.planar.pins:
        pin.select = True
    assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
    assert obj.planar.pins[1].target[:] == pytest.approx((2.0, 0.5, 0.0), abs=1e-5)


def test_a_turned_patch_is_turned_back():
    obj = bar()
    add_end_pins(obj, kind="PATCH")
    pose(obj, angle=1.0)
    assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
    assert obj.planar.pins[1].angle == pytest.approx(0.0, abs=1e-6)
    rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    assert coordinates(obj.data.vertices)[12::13] == pytest.approx(rest[12::13], abs=0.02)


def test_resetting_nothing_is_refused():
    obj = posed()
    for pin in obj.planar.pins:
        pin.select = False
    before = stored(obj)
    with pytest.raises(RuntimeError, match="selected"):
        bpy.ops.planar.reset_selected_pins()
    obj.planar.pins[0].select, obj.planar.pins[0].enabled = True, False
    with pytest.raises(RuntimeError, match="selected"):
        bpy.ops.planar.reset_selected_pins()
    assert stored(obj) == before


def test_one_undo_step_each():
    obj = posed()
    copy(obj)
    bpy.ops.ed.undo_push(message="Start")
    ops = bpy.ops.planar
    for operator in (ops.mirror_pose, ops.paste_pose, ops.reset_selected_pins):
        before = stored(bpy.data.objects["Cutout"])
        assert operator() == {"FINISHED"}
        bpy.ops.ed.undo_push(message="Step")
        after = stored(bpy.data.objects["Cutout"])
        bpy.ops.ed.undo()
        assert stored(bpy.data.objects["Cutout"]) == before
        bpy.ops.ed.redo()
        assert stored(bpy.data.objects["Cutout"]) == after
