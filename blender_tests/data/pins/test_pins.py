# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins: made from the mesh, from selected vertices and from groups; they follow their groups."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector
from support import activate, add_end_pins, add_pins, bar, coordinates, evaluated, grid, make_object, pose


def pin_names(obj):
    return [(pin.name, pin.group, pin.group_index) for pin in obj.planar.pins]


def places(obj):
    """Where each usable pin is (by its index), in the object's plane."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    drawing = begin(bpy.context)
    holders = [Holder(pin, drawing.cutout) for pin in pin_list.model_pins(obj, drawing)]
    return {holder.pin.key: holder.place(drawing.positions) for holder in holders}


def weights(obj, group):
    index = obj.vertex_groups[group].index
    return {v.index: g.weight for v in obj.data.vertices for g in v.groups if g.group == index}


def test_a_pin_goes_where_it_was_asked_for_inside_a_face_of_the_posed_mesh():
    obj = bar()
    obj.matrix_world = ((0, -2, 0, 1), (2, 0, 0, 5), (0, 0, 2, -3), (0, 0, 0, 1))
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.7))
    points = coordinates(obj.data.vertices)
    inside = points[[27, 28, 41]].mean(axis=0)  # in a face, though in none of its corners
    bpy.context.view_layer.update()
    place = obj.matrix_world @ Vector(inside)
    assert bpy.ops.planar.add_pin(location=place) == {"FINISHED"}
    pin = obj.planar.pins[2]
    assert (pin.kind, pin.select, pin.owns_group) == ("POINT", True, True)
    assert [other.select for other in obj.planar.pins] == [False, False, True]
    found = weights(obj, pin.group)
    assert len(found) == 3
    assert sum(found.values()) == pytest.approx(1.0)
    from planar_deform.scene.objects.cutout_object import begin

    world = begin(bpy.context).to_world(places(obj)[2][None, :])[0]
    assert world == pytest.approx(np.array(place), abs=1e-6)


def test_a_pin_just_outside_goes_to_the_nearest_point_and_one_far_outside_is_refused():
    obj = bar()
    bpy.ops.planar.add_pin(location=(1.0, 1.015, 0.0))
    assert places(obj)[0] == pytest.approx([1.0, 1.0], abs=1e-6)
    with pytest.raises(RuntimeError, match="No mesh there"):
        bpy.ops.planar.add_pin(location=(1.0, 1.1, 0.0))
    assert len(obj.planar.pins) == 1


def test_of_several_layers_the_one_at_the_depth_asked_for_gets_the_pin():
    vertices, faces = grid(4, 4)
    above = vertices + np.array([0, 0, 0.5])
    obj = make_object(np.concatenate([vertices, above]), faces.tolist() + (faces + 25).tolist())
    bpy.ops.planar.add_pin(location=(1.1, 0.6, 0.5))
    bpy.ops.planar.add_pin(location=(1.1, 0.6, -0.2))
    assert min(weights(obj, "Pin")) >= 25
    assert max(weights(obj, "Pin.001")) < 25


def test_extend_keeps_the_selection_of_the_other_pins():
    obj = bar()
    bpy.ops.planar.add_pin(location=(0.3, 0.3, 0))
    bpy.ops.planar.add_pin(location=(0.9, 0.3, 0), extend=True)
    assert [pin.select for pin in obj.planar.pins] == [True, True]


def test_pins_from_selected_vertices():
    obj = bar()
    for vertex in obj.data.vertices:
        vertex.select = vertex.index in (3, 17, 40)
    assert bpy.ops.planar.add_pins_from_selected(kind="POINT") == {"FINISHED"}
    assert [set(weights(obj, pin.group)) for pin in obj.planar.pins] == [{3}, {17}, {40}]
    assert bpy.ops.planar.add_pins_from_selected(kind="PATCH") == {"FINISHED"}
    assert set(weights(obj, obj.planar.pins[3].group)) == {3, 17, 40}
    assert [pin.select for pin in obj.planar.pins] == [False, False, False, True]
    for vertex in obj.data.vertices:
        vertex.select = False
    with pytest.raises(RuntimeError, match="Edit Mode"):
        bpy.ops.planar.add_pins_from_selected()


def test_as_many_pins_as_vertices_are_made_in_one_go():
    obj = bar(nx=20, ny=12)
    for vertex in obj.data.vertices:
        vertex.select = True
    assert bpy.ops.planar.add_pins_from_selected(kind="POINT") == {"FINISHED"}
    assert len(obj.planar.pins) == len(obj.data.vertices) == 273
    assert [pin.group_index for pin in obj.planar.pins] == list(range(273))
    bpy.ops.planar.remove_pins()
    assert len(obj.vertex_groups) == 0


def test_pins_from_groups():
    obj = bar()
    for name in ("Hand", "Foot", "Head"):
        obj.vertex_groups.new(name=name).add([5], 1.0, "REPLACE")
    assert bpy.ops.planar.add_pin_from_group(group="Foot", kind="PATCH") == {"FINISHED"}
    assert pin_names(obj) == [("Foot", "Foot", 1)]
    with pytest.raises(RuntimeError, match="already"):
        bpy.ops.planar.add_pin_from_group(group="Foot")
    with pytest.raises(RuntimeError, match="No vertex group 'Tail'"):
        bpy.ops.planar.add_pin_from_group(group="Tail")
    assert bpy.ops.planar.add_pins_from_all_groups() == {"FINISHED"}
    assert [pin.group for pin in obj.planar.pins] == ["Foot", "Hand", "Head"]
    with pytest.raises(RuntimeError, match="already"):
        bpy.ops.planar.add_pins_from_all_groups()


def test_a_point_pin_is_the_weighted_centre_on_the_rest_shape():
    obj = bar()
    group = obj.vertex_groups.new(name="Centre")
    group.add([0], 0.25, "REPLACE")
    group.add([12, 64], 0.5, "REPLACE")
    group.add([30], 0.0, "REPLACE")  # weight 0: not a member
    bpy.ops.planar.add_pin_from_group(group="Centre")
    rest = coordinates(obj.data.vertices)[:, :2].astype(float)
    expected = (0.25 * rest[0] + 0.5 * rest[12] + 0.5 * rest[64]) / 1.25
    assert places(obj)[0] == pytest.approx(expected, abs=1e-6)
    # Posed, it stays on its point of the mesh, which is no longer the vertices' centre.
    add_pins(obj, [52], [12])
    pose(obj, offset=(-0.6, 0.6))
    posed = coordinates(obj.data.vertices)[:, :2].astype(float)
    centre = (0.25 * posed[0] + 0.5 * posed[12] + 0.5 * posed[64]) / 1.25
    assert np.linalg.norm(places(obj)[0] - centre) > 0.01


def test_a_point_pin_of_one_vertex_is_that_vertex_to_the_bit():
    obj = bar(plane="XY")
    add_pins(obj, [0], [33])
    pose(obj, offset=(0.3, 0.2))
    assert np.array_equal(places(obj)[1].astype(np.float32), coordinates(obj.data.vertices)[33, :2])


def test_a_centre_outside_of_the_mesh_goes_to_the_nearest_point_of_its_own_part():
    # A ring whose hole holds another part: the centre of the ring's vertices lies in that.
    vertices, faces = grid(3, 3, 3, 3)
    faces = [face for i, face in enumerate(faces.tolist()) if i != 4]
    inner, inner_faces = grid(1, 1, 0.5, 0.5, origin=(1.25, 1.25))
    obj = make_object(np.concatenate([vertices, inner]), faces + (inner_faces + 16).tolist())
    add_pins(obj, range(16))
    place = places(obj)[0]
    assert np.abs(place - 1.5).max() == pytest.approx(0.5)  # on the hole's edge


@pytest.mark.parametrize("turn", [0.5, 2.0, -2.5])
def test_a_patch_is_turned_rigidly_about_its_centre_and_remembers_its_angle(turn):
    obj = bar(nx=24, ny=8)
    patch = [row * 25 + column for row in range(3, 6) for column in range(11, 14)]
    add_pins(obj, patch, kind="PATCH")
    obj.planar.pins[0].weight = 50.0
    before = coordinates(obj.data.vertices)[patch].astype(float)
    pose(obj, angle=turn)
    after = coordinates(obj.data.vertices)[patch].astype(float)
    c, s = math.cos(turn), math.sin(turn)
    arms = before[:, :2] - before[:, :2].mean(axis=0)
    turned = arms @ np.array([[c, s], [-s, c]])
    assert after[:, :2] - after[:, :2].mean(axis=0) == pytest.approx(turned, abs=0.01)
    assert obj.planar.pins[0].angle == pytest.approx(turn)
    pose(obj, angle=turn)
    assert obj.planar.pins[0].angle == pytest.approx(2 * turn)  # not wrapped into one turn


def test_a_point_pin_leaves_the_drawing_free_to_turn_and_a_patch_does_not():
    turned = {}
    for kind in ("POINT", "PATCH"):
        obj = bar(name=kind)
        add_pins(obj, [13, 14, 26, 27], kind=kind)
        add_pins(obj, [12])
        pose(obj, offset=(-0.5, 1.0))
        points = coordinates(obj.data.vertices).astype(float)
        edge = points[27] - points[26]
        turned[kind] = math.degrees(math.atan2(edge[1], edge[0]))
    assert turned["POINT"] > 15
    assert abs(turned["PATCH"]) < turned["POINT"] / 3


def test_disabled_pins_do_not_hold():
    obj = bar()
    add_end_pins(obj)
    obj.planar.pins[0].enabled = False
    before = coordinates(obj.data.vertices)
    pose(obj, offset=(0.25, 0.5))
    # Held by one pin only, the drawing moves as a whole.
    assert coordinates(obj.data.vertices) - before == pytest.approx(
        np.tile([0.25, 0.5, 0.0], (65, 1)), abs=1e-5
    )


def pulled_apart(obj, by):
    """Two pins on one vertex, the second dragged away: neither can reach its target."""
    from planar_deform.scene.view import snapshot

    add_pins(obj, [0], [33], [33])
    pose(obj, offset=(0.0, by))
    seen = snapshot.of_active(bpy.context)
    return [float(np.linalg.norm(seen.pin(key).target - seen.pin(key).place)) for key in (1, 2)]


def test_pins_that_cannot_both_be_reached_tell_how_far_they_are_off():
    first, second = pulled_apart(bar(), 0.2)
    assert first == pytest.approx(0.1, rel=0.01)
    assert second == pytest.approx(0.1, rel=0.01)


def test_a_held_pin_keeps_its_target_until_the_mesh_is_changed_under_it():
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    obj = bar()
    assert pulled_apart(obj, 0.2)[0] > 0.05
    assert obj.planar.pins[1].has_target
    rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")[33, :2]
    kept = pin_list.model_pins(obj, begin(bpy.context))[1]
    assert kept.target == pytest.approx(rest, abs=1e-6)
    obj.data.vertices[33].co.x -= 0.01
    moved = pin_list.model_pins(obj, begin(bpy.context))[1]
    assert moved.target is None


def test_targets_are_kept_far_from_the_origin_too():
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    vertices, faces = grid(12, 4)
    obj = make_object(vertices + np.array([3000.0, -2000.0, 0.0]), faces.tolist())
    pulled_apart(obj, 0.2)
    assert [pin.target is None for pin in pin_list.model_pins(obj, begin(bpy.context))] == [False] * 3


def test_unreached_pins_are_measured_in_world_lengths():
    gaps = []
    for scale in (1.0, 10.0):
        obj = bar(name=str(scale))
        obj.scale = (scale, scale, scale)
        gaps.append(pulled_apart(obj, 0.2 * scale)[0])
    assert gaps[1] == pytest.approx(10 * gaps[0], rel=1e-3)


def test_pins_follow_renamed_groups():
    obj = bar()
    add_end_pins(obj)
    obj.planar.pins[1].name = "My label"
    obj.vertex_groups["Pin"].name = "Left"
    bpy.context.view_layer.update()
    obj.vertex_groups["Pin.001"].name = "Right"
    bpy.context.view_layer.update()
    assert pin_names(obj) == [("Left", "Left", 0), ("My label", "Right", 1)]


def test_pins_follow_groups_that_are_reordered_or_added():
    obj = bar()
    add_end_pins(obj)
    obj.vertex_groups.active_index = 1
    bpy.ops.object.vertex_group_move(direction="UP")
    obj.vertex_groups.new(name="Another")
    bpy.context.view_layer.update()
    assert pin_names(obj) == [("Pin", "Pin", 1), ("Pin.001", "Pin.001", 0)]
    obj.vertex_groups["Pin"].name = "Left"
    bpy.context.view_layer.update()
    assert pin_names(obj)[0] == ("Left", "Left", 1)


def test_a_removed_group_leaves_its_pin_missing_and_the_others_working():
    obj = bar()
    add_pins(obj, [0], [26], [12])
    obj.vertex_groups.remove(obj.vertex_groups["Pin"])
    bpy.context.view_layer.update()
    assert pin_names(obj) == [("Pin", "Pin", -1), ("Pin.001", "Pin.001", 0), ("Pin.002", "Pin.002", 1)]
    assert sorted(places(obj)) == [1, 2]
    pose(obj, offset=(0.0, 0.3))
    # A group of that name makes the pin whole again.
    obj.vertex_groups.new(name="Pin").add([1], 1.0, "REPLACE")
    bpy.context.view_layer.update()
    assert sorted(places(obj)) == [0, 1, 2]


def test_removing_one_group_and_adding_another_does_not_pass_for_a_rename_of_a_used_one():
    obj = bar()
    add_pins(obj, [0], [26])
    obj.vertex_groups.remove(obj.vertex_groups["Pin"])
    obj.vertex_groups.new(name="Other")
    bpy.context.view_layer.update()
    # Index 0 is now the second pin's own group: the first pin must not take it over.
    assert obj.planar.pins[0].group == "Pin"
    assert obj.planar.pins[1].group == "Pin.001"


def test_empty_groups_and_groups_off_the_faces_are_no_error():
    vertices, faces = grid(4, 4)
    obj = make_object([*vertices.tolist(), (9, 9, 9)], faces.tolist())
    add_pins(obj, [0], [24])
    for name, rows, weight in (("Empty", [], 1.0), ("Zero", [3], 0.0), ("Loose", [25], 1.0)):
        obj.vertex_groups.new(name=name).add(rows, weight, "REPLACE")
        bpy.ops.planar.add_pin_from_group(group=name)
    assert sorted(places(obj)) == [0, 1]
    pose(obj, offset=(0.1, 0.1), moving=[1])


def test_removing_pins_keeps_groups_that_were_there_before():
    obj = bar()
    obj.vertex_groups.new(name="Mine").add([3], 1.0, "REPLACE")
    bpy.ops.planar.add_pin_from_group(group="Mine")
    bpy.ops.planar.add_pin(location=(0.5, 0.5, 0))
    bpy.ops.planar.add_pin(location=(1.5, 0.5, 0))
    shown = evaluated(obj)
    bpy.ops.planar.select_pins(action="ALL")
    obj.planar.pins[2].select = False
    assert bpy.ops.planar.remove_pins() == {"FINISHED"}
    assert pin_names(obj) == [("Pin.001", "Pin.001", 1)]
    assert [group.name for group in obj.vertex_groups] == ["Mine", "Pin.001"]
    assert obj.planar.active_pin == 0
    assert np.array_equal(evaluated(obj), shown)


def test_removing_with_nothing_selected_is_cancelled_and_never_passes_through():
    obj = bar()
    bpy.ops.planar.add_pin(location=(0.5, 0.5, 0))
    bpy.ops.planar.select_pins(action="NONE")
    assert bpy.ops.planar.remove_pins() == {"CANCELLED"}
    assert len(obj.planar.pins) == 1
    assert obj.name in bpy.data.objects


def test_selecting_pins():
    obj = bar()
    add_pins(obj, [0], [5], [9])

    def select(**arguments):
        assert bpy.ops.planar.select_pins(**arguments) == {"FINISHED"}
        return [index for index, pin in enumerate(obj.planar.pins) if pin.select]

    assert select(action="SELECT", pin=0) == [0]
    assert obj.planar.active_pin == 0
    assert select(action="SELECT", pin=2, extend=True) == [0, 2]
    assert select(action="TOGGLE", pin=0, extend=True) == [2]
    assert select(action="TOGGLE", pin=1, extend=True) == [1, 2]
    assert select(action="DESELECT", pin=1, extend=True) == [2]
    assert select(action="INVERT") == [0, 1]
    assert select(action="SELECT", pin=2, extend=False) == [2]
    assert select(action="NONE") == []
    assert select(action="ALL") == [0, 1, 2]
    assert select(action="SELECT", pin=-1) == [2]
    with pytest.raises(RuntimeError, match="no pin 7"):
        bpy.ops.planar.select_pins(action="SELECT", pin=7)


@pytest.mark.parametrize("how", ["kind", "group"])
def test_a_pin_changed_in_the_panel_holds_the_drawing_as_it_lies(how):
    obj = bar()
    add_end_pins(obj, kind="PATCH")
    obj.vertex_groups.new(name="Other").add([63, 64], 1.0, "REPLACE")
    pose(obj, angle=0.7)
    pin = obj.planar.pins[1]
    assert pin.angle == pytest.approx(0.7)
    if how == "kind":
        pin.kind = "POINT"
        pin.kind = "PATCH"
    else:
        pin.group = "Other"
    assert not pin.has_target
    before = coordinates(obj.data.vertices)
    pose(obj, offset=(0.0, 0.0))
    held = slice(None) if how == "kind" else [63, 64]  # what another group lets go of finds its own shape
    assert np.abs(coordinates(obj.data.vertices) - before)[held].max() < 0.05
    obj.vertex_groups[pin.group].name = "Renamed"
    bpy.context.view_layer.update()
    assert (pin.group, pin.has_target) == ("Renamed", True)


def test_changing_the_kind_of_a_pin():
    obj = bar()
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.3))
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    assert bpy.ops.planar.set_pin_kind(kind="PATCH") == {"FINISHED"}
    assert [pin.kind for pin in obj.planar.pins] == ["POINT", "PATCH"]
    assert bpy.ops.planar.set_pin_kind(kind="PATCH") == {"CANCELLED"}
    # The patch is held as it lies now, turned by the pose, not turned back to rest.
    before = coordinates(obj.data.vertices)
    pose(obj, offset=(0.0, 0.0))
    assert np.abs(coordinates(obj.data.vertices) - before).max() < 0.05
