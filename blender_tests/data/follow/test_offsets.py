# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow something from where they were beside it, whatever becomes of the drawing meanwhile."""

import bpy
import numpy as np
import pytest
from follow_scenes import HAND, LEFT, TIP, angle, axes, empty, held, imported, moved, turned, with_control
from support import activate, add_pins, coordinates

CLOSE = 4e-3  # pins are soft; the drawing is 1.3 long


def follow_now(obj):
    activate(obj)
    assert bpy.ops.planar.follow_now() == {"FINISHED"}


def assert_follows(obj, control, vertices=HAND, pin=1):
    """The pin goes with its control, and nothing has moved before."""
    start, others = held(obj, vertices), held(obj, [LEFT[2]])
    follow_now(obj)
    np.testing.assert_allclose(held(obj, vertices), start, atol=CLOSE)
    u, v, normal = axes(obj)
    moved(control, 0.2 * u - 0.15 * v + 0.5 * normal)
    follow_now(obj)
    np.testing.assert_allclose(held(obj, vertices), start + 0.2 * u - 0.15 * v, atol=CLOSE)
    np.testing.assert_allclose(held(obj, [LEFT[2]]), others, atol=CLOSE)


@pytest.mark.parametrize("parented", [False, True])
@pytest.mark.parametrize("kind", ["POINT", "PATCH"])
def test_a_pin_stays_where_it_is_when_it_begins_to_follow_and_moves_as_its_control_does(kind, parented):
    vertices = HAND if kind == "PATCH" else TIP
    assert_follows(*with_control(kind=kind, vertices=vertices, parented=parented), vertices)


def test_a_control_that_is_turned_turns_patches_and_leads_points_round():
    for kind, vertices in (("POINT", TIP), ("PATCH", HAND)):
        obj, control = with_control(kind=kind, vertices=vertices, offset=(0.0, -0.3, 0.0))
        start = held(obj, vertices)
        turned(control, axes(obj)[2], 35.0)
        follow_now(obj)
        np.testing.assert_allclose(held(obj, vertices), start, atol=CLOSE)  # it turns about itself
        assert angle(obj) == pytest.approx(35.0 if kind == "PATCH" else 0.0, abs=1.5)
        bpy.data.objects.remove(obj)
    obj, control = with_control(kind="PATCH", parented=True, offset=(0.4, 0.0, 0.0))
    normal = axes(obj)[2]
    arm = np.array(control.matrix_world.translation) - held(obj, HAND)
    before, flat = held(obj, HAND), arm - normal * (normal @ arm)
    turned(control, normal, -20.0)
    follow_now(obj)
    turn = np.radians(-20.0)
    led = flat - (np.cos(turn) * flat + np.sin(turn) * np.cross(normal, flat))
    np.testing.assert_allclose(held(obj, HAND), before + led, atol=2 * CLOSE)
    assert angle(obj) == pytest.approx(-20.0, abs=1.5)
    assert np.degrees(obj.planar.pins[1].angle) == pytest.approx(-20.0, abs=0.1)


def test_a_turn_out_of_the_plane_does_not_turn_the_patch():
    obj, control = with_control(kind="PATCH", offset=(0.0, -0.5, 0.0))
    turned(control, axes(obj)[0], 30.0)
    follow_now(obj)
    assert angle(obj) == pytest.approx(0.0, abs=1.0)


def test_the_offset_is_cleared_and_set():
    obj, control = with_control(kind="PATCH")
    obj.planar.pins[0].select = False
    assert bpy.ops.planar.clear_follow_offset() == {"FINISHED"}
    u, v, _ = axes(obj)
    gap = held(obj, HAND) - np.array(control.matrix_world.translation)
    np.testing.assert_allclose((gap @ u, gap @ v), 0.0, atol=CLOSE)
    assert angle(obj) == pytest.approx(0.0, abs=1.5)
    bpy.ops.planar.drag_pins(pin=1, offset=(0.1, 0.1))
    there = held(obj, HAND)
    assert bpy.ops.planar.set_follow_offset() == {"FINISHED"}
    follow_now(obj)
    np.testing.assert_allclose(held(obj, HAND), there, atol=CLOSE)


def test_a_pose_is_kept_when_the_pin_begins_to_follow():
    obj = imported()
    add_pins(obj, LEFT, HAND, kind="PATCH")
    bpy.ops.planar.drag_pins(pin=1, offset=(-0.2, 0.2))
    bpy.ops.planar.rotate_pins(pin=1, angle=0.5)
    before = coordinates(obj.data.vertices)
    obj.planar.pins[1].follow = empty((1.0, 2.0, 3.0))
    follow_now(obj)
    np.testing.assert_allclose(coordinates(obj.data.vertices), before, atol=5e-3)


def test_it_is_right_after_saving_and_loading(tmp_path):
    obj, control = with_control(kind="PATCH", parented=True)
    path = str(tmp_path / "follow.blend")
    names = obj.name, control.name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert_follows(*(bpy.data.objects[name] for name in names))


def test_what_is_appended_brings_its_control(tmp_path):
    obj, control = with_control(kind="PATCH")
    path, name = str(tmp_path / "follow.blend"), obj.name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert bpy.ops.wm.append(directory=f"{path}/Object/", filename=name) == {"FINISHED"}
    obj = bpy.data.objects[name]
    control = obj.planar.pins[1].follow
    if control.name not in bpy.context.scene.objects:
        bpy.context.scene.collection.objects.link(control)
    bpy.context.view_layer.update()
    assert_follows(obj, control)


@pytest.mark.parametrize("together", [False, True])
def test_of_a_duplicate(together):
    _, control = with_control(kind="PATCH")
    control.select_set(together)
    bpy.ops.object.duplicate()
    twin = bpy.context.view_layer.objects.active
    follows = twin.planar.pins[1].follow
    assert (follows != control) == together, "an Empty that is duplicated with the drawing is its own"
    assert_follows(twin, follows)


@pytest.mark.parametrize("parented", [False, True])
def test_of_a_drawing_whose_transforms_are_applied(parented):
    obj, _ = with_control(kind="PATCH", parented=parented)
    obj.rotation_euler = (np.pi / 2, 0.3, 0.2)
    bpy.context.view_layer.update()
    bpy.ops.planar.set_follow_offset()
    activate(obj)
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    bpy.context.view_layer.update()
    from planar_deform.scene import follow

    follow.match(obj)
    before = held(obj, HAND)
    follow_now(obj)
    np.testing.assert_allclose(held(obj, HAND), before, atol=CLOSE)
    start = coordinates(obj.data.vertices)
    follow_now(obj)
    np.testing.assert_allclose(coordinates(obj.data.vertices), start, atol=CLOSE)
    assert obj.planar.pins[1].angle == pytest.approx(0.0, abs=1e-3)


def test_of_drawings_that_are_joined():
    obj, control = with_control(kind="PATCH")
    other = imported()
    other.location.z += 2.0
    add_pins(other, LEFT, HAND)
    bpy.context.view_layer.update()
    from planar_deform.scene import follow

    for each in (obj, other):
        follow.match(each)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = other
    bpy.ops.object.join()
    bpy.context.view_layer.update()
    follow.match(other)
    pins = [pin for pin in other.planar.pins if pin.follow == control]
    assert len(pins) == 1
    count = len(other.data.vertices)
    hand = [count - 65 + vertex for vertex in HAND]
    start = held(other, hand)
    follow_now(other)
    np.testing.assert_allclose(held(other, hand), start, atol=CLOSE)
    turned(control, axes(other)[2], 25.0)
    follow_now(other)
    assert np.degrees(pins[0].angle) == pytest.approx(25.0, abs=0.2)


def refused(obj, control, message, capsys):
    obj.planar.pins[1].follow = control
    assert obj.planar.pins[1].follow is None
    assert message in capsys.readouterr().out


def test_what_would_follow_itself_is_refused(capsys):
    obj, control = with_control(vertices=TIP)
    refused(obj, obj, "cannot follow itself: choose another object", capsys)
    control.parent, control.parent_type, control.parent_vertices = obj, "VERTEX", (12, 0, 0)
    refused(
        obj, control, "hangs on vertices of 'Cutout', which its pins move: parent it to the object", capsys
    )
    control.parent = None
    constraint = control.constraints.new("COPY_LOCATION")
    constraint.target, constraint.subtarget = obj, obj.vertex_groups[0].name
    refused(obj, control, "remove it, or choose another object", capsys)
    control.constraints.clear()
    control.parent, control.parent_type = obj, "OBJECT"  # that moves with the object, not with its shape
    bpy.context.view_layer.update()
    obj.planar.pins[1].follow = control
    assert_follows(obj, control, TIP)


def test_what_is_nowhere_is_refused_with_the_remedy(capsys):
    obj, control = with_control()
    flat = empty((0.0, 0.0, 0.0), "Flat")
    flat.scale = (1.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    refused(obj, flat, "'Flat' has a scale of zero: give it a scale in every axis", capsys)
    obj.planar.pins[1].follow = control
    before = coordinates(obj.data.vertices)
    activate(control)
    bpy.ops.object.delete()
    activate(obj)
    with pytest.raises(
        RuntimeError, match="'Control', which pin 'Pin.001' follows, is not in the scene: bring"
    ):
        bpy.ops.planar.follow_now()
    assert np.array_equal(coordinates(obj.data.vertices), before)


def test_what_is_hidden_is_followed_and_what_is_disabled_refused():
    obj, control = with_control(kind="PATCH")
    control.hide_set(True)
    assert_follows(obj, control)
    group = bpy.data.collections.new("Controls")
    bpy.context.scene.collection.children.link(group)
    bpy.context.scene.collection.objects.unlink(control)
    group.objects.link(control)
    layer = bpy.context.view_layer.layer_collection.children["Controls"]
    before = coordinates(obj.data.vertices)
    for owner, name in ((control, "hide_viewport"), (group, "hide_viewport"), (layer, "exclude")):
        setattr(owner, name, True)
        activate(obj)
        with pytest.raises(RuntimeError, match="is disabled in the viewport, or its collection is: enable"):
            bpy.ops.planar.follow_now()
        setattr(owner, name, False)
    np.testing.assert_array_equal(coordinates(obj.data.vertices), before)
    follow_now(obj)


def test_one_that_is_chosen_in_edit_mode_is_refused(capsys):
    obj, control = with_control()
    bpy.ops.object.mode_set(mode="EDIT")
    refused(obj, control, "leave the current mode first", capsys)


def test_undo_takes_back_what_is_followed_with_its_offset():
    obj, _ = with_control(vertices=TIP)
    obj.planar.pins[1].follow = None
    bpy.ops.ed.undo_push(message="Nothing")
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Controls")
    offset = tuple(bpy.data.objects["Cutout"].planar.pins[1].follow_offset)
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Cutout"]
    assert obj.planar.pins[1].follow is None
    assert not obj.planar.live
    assert len(bpy.data.objects) == 2
    bpy.ops.ed.redo()
    pin = bpy.data.objects["Cutout"].planar.pins[1]
    assert pin.follow is not None
    assert tuple(pin.follow_offset) == offset
