# SPDX-License-Identifier: GPL-3.0-or-later
"""The pins of a lattice: whose they are, what they follow, and what is refused."""

from functools import partial

import bpy
import numpy as np
import pytest
from lattice_scenes import deform, lattice, layered, pin_at, points, seen, shown
from support import activate, coordinates, evaluated, grid, make_object

from planar_deform.scene.view import snapshot


def test_pins_on_two_objects_are_vertex_groups_there_in_the_lattices_own_list():
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 3)
    assert [pin.object for pin in cage.planar.pins] == [back, front]
    assert [pin.select for pin in cage.planar.pins] == [False, True]
    assert [pin.name for pin in cage.planar.pins] == ["Pin", "Pin.001"]
    assert len(back.vertex_groups) == len(front.vertex_groups) == 1
    assert not back.planar.pins
    names = {pin.group for pin in cage.planar.pins}
    assert len(names) == 2
    np.testing.assert_allclose(seen().pin(1).place, shown(front, 3), atol=1e-5)


def test_points_selected_in_edit_mode_are_pinned():
    cage, *_ = layered()
    for index, point in enumerate(cage.data.points):
        point.select = index in {3, 17}
    assert bpy.ops.planar.add_pins_from_selected() == {"FINISHED"}
    assert [pin.lattice_point for pin in cage.planar.pins] == [3, 17]
    assert all(pin.select for pin in cage.planar.pins)


def test_removing_a_pin_removes_its_group_from_its_object():
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 3)
    assert bpy.ops.planar.remove_pins() == {"FINISHED"}
    assert len(cage.planar.pins) == 1
    assert (len(back.vertex_groups), len(front.vertex_groups)) == (1, 0)


def test_pins_follow_renamed_groups_and_renamed_objects():
    cage, back, _ = layered()
    pin_at(back, 0)
    back.vertex_groups[0].name = "Nose"
    back.name = "Face"
    bpy.context.view_layer.update()
    bpy.ops.planar.drag_pins(offset=(0.1, 0.0))
    assert (cage.planar.pins[0].group, cage.planar.pins[0].name) == ("Nose", "Nose")


def test_a_lattice_and_its_meshes_that_are_duplicated_are_posed_apart_from_them():
    cage, back, front = layered()
    pin_at(back, 0)
    for obj in (back, front):
        obj.select_set(True)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    twin = bpy.context.object
    assert twin != cage
    pinned = twin.planar.pins[0].object
    assert pinned not in {back, front}
    before = points(cage)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.0)) == {"FINISHED"}
    np.testing.assert_array_equal(points(cage), before)
    assert not np.array_equal(points(twin), before)


def test_what_can_not_be_posed_says_why():
    cage = lattice((3, 3, 1), (1, 1, 1), (0, 0, 0))
    activate(cage)
    with pytest.raises(RuntimeError, match="deforms no mesh that is shown"):
        bpy.ops.planar.add_pin(location=(0, 0, 0))
    back = make_object(*grid(4, 4), name="Back")
    deform(back, cage)
    activate(cage)
    with pytest.raises(RuntimeError, match="No mesh there"):
        bpy.ops.planar.add_pin(location=(50, 0, 0))
    with pytest.raises(RuntimeError, match="no point 9"):
        bpy.ops.planar.add_pin(lattice_point=9)
    activate(back)
    with pytest.raises(RuntimeError, match="no lattice"):
        bpy.ops.planar.add_pin(lattice_point=1)


@pytest.mark.parametrize("name", ["paint_stiffness", "refine_mesh", "set_rest_to_current"])
def test_what_only_drawings_have_is_refused_to_a_lattice_with_the_reason(name):
    cage, back, _ = layered()
    pin_at(back, 0)
    with pytest.raises(RuntimeError, match="is a lattice: select one of the meshes"):
        getattr(bpy.ops.planar, name)()
    activate(cage)


def test_a_linked_lattice_or_one_in_edit_mode_is_refused():
    cage, back, _ = layered()
    pin_at(back, 0)
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Object Mode"):
        bpy.ops.planar.add_pin(lattice_point=1)
    bpy.ops.object.mode_set(mode="OBJECT")
    twin = cage.copy()
    bpy.context.scene.collection.objects.link(twin)
    with pytest.raises(RuntimeError, match="shared"):
        bpy.ops.planar.add_pin(lattice_point=1)


def test_a_pin_whose_object_is_no_longer_deformed_holds_nothing_and_the_others_go_on():
    _, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 3)
    front.modifiers.clear()
    bpy.context.view_layer.update()
    marks = seen()
    assert marks.pin(0) is not None
    assert marks.pin(1) is None
    assert bpy.ops.planar.drag_pins(pin=0, offset=(0.1, 0.0)) == {"FINISHED"}
    bpy.data.objects.remove(front)
    assert seen().pin(0) is not None
    assert bpy.ops.planar.drag_pins(pin=0, offset=(0.1, 0.0)) == {"FINISHED"}


def test_the_radius_of_a_patch_stays_on_its_object():
    cage, back, front = layered()
    pin_at(front, 24)
    assert bpy.ops.planar.set_pin_radius(radius=0.3) == {"FINISHED"}
    assert cage.planar.pins[0].kind == "PATCH"
    held = [vertex.index for vertex in front.data.vertices if vertex.groups]
    assert 4 < len(held) < 49
    assert not back.vertex_groups


def test_what_is_shown_follows_what_is_done_to_the_meshes_and_the_lattice():
    cage, back, _ = layered()
    pin_at(back, 12)

    def check():
        bpy.context.view_layer.update()
        np.testing.assert_allclose(snapshot.of_active(bpy.context).pin(0).place, shown(back, 12), atol=1e-5)

    check()
    back.location.x += 0.3
    check()
    cage.location.z += 0.2
    check()
    cage.data.points[0].co_deform.x += 0.4
    cage.data.update_tag()
    check()
    back.modifiers[0].strength = 0.5
    check()
    back.data.vertices[12].co.y += 0.1
    back.data.update()
    check()
    cage.data.interpolation_type_u = "KEY_LINEAR"
    check()


def test_layers_that_are_joined_keep_their_pins():
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 48)
    bpy.ops.planar.drag_pins(offset=(0.1, 0.2))
    placed = [seen().pin(key).place for key in (0, 1)]
    activate(back)
    front.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    activate(cage)
    marks = seen()
    for key in (0, 1):
        np.testing.assert_allclose(marks.pin(key).place, placed[key], atol=1e-5)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.1, 0.0)) == {"FINISHED"}
    assert [pin.object for pin in cage.planar.pins] == [back, back]


def test_an_object_that_is_deleted_is_let_go_by_its_pins():
    cage, back, front = layered()
    pin_at(front, 48)
    pin_at(back, 0)
    activate(front)
    assert bpy.ops.object.delete() == {"FINISHED"}
    activate(cage)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.1, 0.0)) == {"FINISHED"}
    assert [pin.object for pin in cage.planar.pins] == [None, back]


def test_a_frame_change_is_followed_by_what_is_shown_without_being_told():
    cage, back, _ = layered()
    pin_at(back, 12)
    scene = bpy.context.scene
    for frame, offset in ((1, 0.0), (11, 0.3)):
        scene.frame_set(frame)
        bpy.ops.planar.drag_pins(offset=(0.0, offset))
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    for frame in (1, 6, 11, 3):
        scene.frame_set(frame)
        np.testing.assert_allclose(snapshot.of_active(bpy.context).pin(0).place, shown(back, 12), atol=1e-5)
    assert cage.planar.poses[1].frame == 11


def into_collection(obj, name, parent=None):
    """Move an object into a new collection."""
    collection = bpy.data.collections.new(name)
    (parent or bpy.context.scene.collection).children.link(collection)
    for old in obj.users_collection:
        old.objects.unlink(obj)
    collection.objects.link(obj)
    bpy.context.view_layer.update()
    return collection


def eye_closed(front):
    into_collection(front, "Layer")
    bpy.context.view_layer.layer_collection.children["Layer"].hide_viewport = True


def eye_of_the_collection_above_closed(front):
    into_collection(front, "Layer")
    above = bpy.data.collections.new("Above")
    bpy.context.scene.collection.children.link(above)
    above.children.link(bpy.data.collections["Layer"])
    bpy.context.scene.collection.children.unlink(bpy.data.collections["Layer"])
    bpy.context.view_layer.layer_collection.children["Above"].hide_viewport = True


def off_in_viewports(front):
    into_collection(front, "Layer").hide_viewport = True


def hidden_itself(front):
    front.hide_set(True)


HIDINGS = (eye_closed, eye_of_the_collection_above_closed, off_in_viewports, hidden_itself)


@pytest.mark.parametrize("hide", HIDINGS)
def test_what_is_hidden_by_its_collection_is_not_posed_but_deformed(hide):
    cage, back, front = layered()
    pin_at(back, 0)
    pin_at(back, 12)
    pin_at(front, 3)
    start = shown(front, 3)
    hide(front)
    activate(cage)
    assert seen().pin(2) is None, "its pin waits"
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.2, 0.3)) == {"FINISHED"}
    alone = points(cage)
    for modifier in list(front.modifiers):
        front.modifiers.remove(modifier)
    bpy.ops.planar.reset_to_rest()
    for pin in cage.planar.pins:
        pin.has_target = False
    bpy.ops.planar.drag_pins(pin=1, offset=(0.2, 0.3))
    np.testing.assert_allclose(points(cage), alone, atol=1e-6, err_msg="it had no say in the pose")
    deform(front, cage)
    front.hide_set(False)
    for collection in bpy.context.view_layer.layer_collection.children:
        collection.hide_viewport = collection.collection.hide_viewport = False
    activate(cage)
    assert seen().pin(2) is not None
    assert np.linalg.norm(shown(front, 3) - start) > 0.01


@pytest.mark.parametrize("hide", HIDINGS)
def test_pins_on_what_is_hidden_say_so(hide):
    cage, back, front = layered()
    pin_at(back, 20)
    pin_at(front, 24)
    empty = bpy.data.objects.new("Target", None)
    bpy.context.scene.collection.objects.link(empty)
    cage.planar.pins[1].follow = empty
    hide(front)
    activate(cage)
    before = points(cage)
    for pose in (partial(bpy.ops.planar.drag_pins, offset=(0.1, 0.0)), bpy.ops.planar.follow_now):
        bpy.ops.planar.select_pins(action="SELECT", pin=1)
        with pytest.raises(RuntimeError, match="'Front' is hidden, and its pins wait until it is shown"):
            pose()
    assert np.array_equal(points(cage), before)


@pytest.mark.parametrize("hide", HIDINGS)
def test_what_is_hidden_is_applied_as_well(hide):
    cage, back, front = layered()
    pin_at(back, 20)
    pin_at(front, 24)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.3)) == {"FINISHED"}
    before = [evaluated(obj) for obj in (back, front)]
    hide(front)
    activate(cage)
    assert bpy.ops.planar.apply_lattice() == {"FINISHED"}
    for obj, shape in zip((back, front), before, strict=True):
        assert not obj.modifiers
        key = obj.data.shape_keys.key_blocks["Lattice"]
        np.testing.assert_allclose(coordinates(key.data), shape, atol=2e-6)


def test_what_another_collection_shows_is_posed():
    cage, _back, front = layered()
    pin_at(front, 3)
    into_collection(front, "Layer")
    bpy.context.scene.collection.objects.link(front)
    bpy.context.view_layer.layer_collection.children["Layer"].hide_viewport = True
    activate(cage)
    assert seen().pin(0) is not None
