# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a drawing that hang together: found by a click, and posed as one character."""

import bpy
import numpy as np
import pytest
from drawings import character
from figures import (
    BODY,
    EYE,
    HEAD,
    NECK,
    SHOULDER,
    SIZE,
    WRIST,
    drag,
    figure,
    gaps,
    joint_places,
    pin_at,
    pinned,
    shown,
)
from mathutils import Vector
from support import TRANSFORMS, activate, coordinates, evaluated, in_edit_mode, make_object, measured

from planar_deform.scene.pins import pin_list

HELD = 1e-3  # of the diagonal


def kinds(obj):
    return [pin.kind for pin in obj.planar.pins if pin.kind in {"HINGE", "WELD"}]


def turned_by(obj, part, rest=None):
    """How far a part is turned from rest, in radians, and how far from rigid, of the diagonal."""
    positions, drawing = shown(obj)
    rows = drawing.parts == part
    before, now = (shape[rows] - shape[rows].mean(axis=0) for shape in (drawing.rest, positions))
    across = (before[:, 0] * now[:, 1] - before[:, 1] * now[:, 0]).sum()
    angle = np.arctan2(across, (before * now).sum())
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return angle, np.abs(now - before @ turn.T).max() / drawing.cutout.diagonal


def place_of(obj, name):
    """Where a pin is (2,), in the plane of the drawing."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.pins import pin_list

    positions, drawing = shown(obj)
    pins = {obj.planar.pins[pin.key].name: pin for pin in pin_list.model_pins(obj, drawing)}
    return Holder(pins[name], drawing.cutout).place(positions)


def test_attach_finds_shoulder_wrist_and_neck():
    obj = figure()
    before = evaluated(obj)
    assert bpy.ops.planar.attach() == {"FINISHED"}
    assert kinds(obj) == ["HINGE"] * 3
    assert all(pin.select for pin in obj.planar.pins)
    np.testing.assert_allclose(joint_places(obj), sorted([NECK, SHOULDER, WRIST]), atol=0.12)
    assert np.array_equal(evaluated(obj), before)  # nothing moves


def test_pins_and_joints_have_groups_of_their_own_names():
    obj = figure()
    assert bpy.ops.planar.attach() == {"FINISHED"}
    bpy.ops.planar.add_pin(location=obj.matrix_world @ Vector((1.0, 1.0, 0.0)))
    assert [pin.group for pin in obj.planar.pins] == [pin.name for pin in obj.planar.pins]
    assert {pin.name for pin in obj.planar.pins} == {"Hinge", "Hinge.001", "Hinge.002", "Pin"}


def test_attach_again_adds_only_what_is_missing():
    obj = figure()
    bpy.ops.planar.attach()
    with pytest.raises(RuntimeError, match="hang together already"):
        bpy.ops.planar.attach()
    for pin in obj.planar.pins:
        pin.select = False
    obj.planar.pins[1].select = True
    assert bpy.ops.planar.remove_pins() == {"FINISHED"}
    assert bpy.ops.planar.attach() == {"FINISHED"}
    assert kinds(obj) == ["HINGE"] * 3
    np.testing.assert_allclose(joint_places(obj), sorted([NECK, SHOULDER, WRIST]), atol=0.12)


def test_a_leaning_chest_takes_head_and_arms_along():
    obj = pinned()
    drag(obj, "Chest", (0.05, 0.02), angle=0.4)
    assert max(gaps(obj).values()) < HELD
    for part in range(4):
        angle, bent = turned_by(obj, part)
        assert angle == pytest.approx(0.4, abs=0.01)
        assert bent < 1e-3
    drag(obj, "Chest", (-0.05, -0.02), angle=-0.4)
    positions, drawing = shown(obj)
    assert np.abs(positions - drawing.rest).max() < 2e-3 * drawing.cutout.diagonal


def test_a_hand_takes_its_sleeve_along_and_turns_about_its_wrist():
    obj = pinned()
    pin_at(obj, (4.68, 3.2), "Hand", kind="PATCH", radius=0.2)
    drag(obj, "Hand", (-0.1, 0.15))
    assert max(gaps(obj).values()) < HELD
    assert turned_by(obj, 1)[0] > 0.3  # up, about the shoulder
    drag(obj, "Hand", (0.0, 0.0), angle=1.0)
    assert max(gaps(obj).values()) < HELD
    assert turned_by(obj, 2)[0] == pytest.approx(1.0, abs=0.05)


def test_welded_parts_lie_as_they_did():
    obj = figure(HEAD, EYE)
    bpy.ops.planar.attach()
    assert kinds(obj) == ["WELD"]
    pin_at(obj, (1.0, 4.8), "Head", kind="PATCH", radius=0.25)
    drag(obj, "Head", (0.03, 0.0), angle=0.7)
    assert max(gaps(obj).values()) < HELD
    assert turned_by(obj, 1)[0] == pytest.approx(0.7, abs=0.01)


def test_two_hundred_drags_there_and_back_leave_nothing_behind():
    obj = pinned(cell=0.4)
    pin_at(obj, (4.6, 3.2), "Hand")
    random = np.random.default_rng(5)
    worst = 0.0
    for _ in range(100):
        offset = random.uniform(-0.15, 0.15, 2)
        for way in (offset, -offset):
            drag(obj, "Hand", way.tolist())
        worst = max(worst, *gaps(obj).values())
    bpy.ops.planar.settle_pose()
    positions, drawing = shown(obj)
    assert worst < HELD
    assert np.abs(positions - drawing.rest).max() < 1e-3 * drawing.cutout.diagonal


def test_what_no_pin_decides_stays_with_the_part_it_hangs_on():
    obj = pinned()
    pin_at(obj, (4.6, 3.2), "Hand")
    for turn in (0.5, -0.9, 0.7):  # about the shoulder, within reach
        place = np.array(SHOULDER) + 2.95 * np.array([np.cos(turn), np.sin(turn)])
        now = place_of(obj, "Hand")
        drag(obj, "Hand", (SIZE * place - now).tolist())
        bpy.ops.planar.settle_pose()
        arm, bent = turned_by(obj, 1)
        assert arm == pytest.approx(turn, abs=0.1)
        assert bent < 1e-3
        assert abs(turned_by(obj, 3)[0]) < 0.02  # the head
        assert max(gaps(obj).values()) < HELD


def test_a_joint_that_is_off_lets_go():
    obj = pinned()
    obj.planar.pins[0].enabled = False
    assert len(gaps(obj)) == 3  # it is there
    drag(obj, "Chest", (0.1, 0.1))
    apart = gaps(obj)
    assert apart[obj.planar.pins[0].name] > 0.05
    assert sum(gap < HELD for gap in apart.values()) == 2
    obj.planar.pins[0].enabled = True
    bpy.ops.planar.settle_pose()
    assert max(gaps(obj).values()) < HELD


@pytest.mark.parametrize("transform", TRANSFORMS)
def test_it_holds_wherever_the_drawing_stands(transform):
    obj = figure(cell=0.2, parented=False)
    obj.matrix_world = TRANSFORMS[transform]
    assert bpy.ops.planar.attach() == {"FINISHED"}
    np.testing.assert_allclose(joint_places(obj), sorted([NECK, SHOULDER, WRIST]), atol=0.15)
    pin_at(obj, (1.0, 2.0), "Chest", kind="PATCH")
    size = shown(obj)[1].cutout.diagonal
    drag(obj, "Chest", (0.1 * size, 0.05 * size), angle=0.3)
    assert max(gaps(obj).values()) < HELD
    assert turned_by(obj, 3)[0] == pytest.approx(0.3, abs=0.02)


@pytest.mark.parametrize("name", ["horse", "giraffe"])
def test_a_real_drawing_cut_into_layers_hangs_together_again(name):
    whole = character(name)
    places = coordinates(whole.data.vertices)
    faces = [list(face.vertices) for face in whole.data.polygons]
    middles = np.array([places[face].mean(axis=0)[1] for face in faces])
    low, high = np.quantile(middles, (0.45, 0.6))
    upper = [face for face, middle in zip(faces, middles, strict=True) if middle > low]
    lower = [face for face, middle in zip(faces, middles, strict=True) if middle < high]
    layers = [make_object(places, part, name=name) for part in (upper, lower)]
    for number, layer in enumerate(layers):
        layer.matrix_world = whole.matrix_world
        layer.location.y -= 0.01 * number
    activate(layers[0])
    layers[1].select_set(True)
    bpy.ops.object.join()
    obj = bpy.context.object
    in_edit_mode(obj, lambda: bpy.ops.mesh.delete_loose())
    bpy.context.view_layer.update()
    assert bpy.ops.planar.attach() == {"FINISHED"}
    top = int(np.argmax(coordinates(obj.data.vertices)[:, 1]))
    near = np.argsort(
        np.linalg.norm(coordinates(obj.data.vertices) - coordinates(obj.data.vertices)[top], axis=1)
    )
    pin_list.add_on_vertices(obj, near[:12].tolist(), "PATCH").name = "Top"
    size = shown(obj)[1].cutout.diagonal
    drag(obj, "Top", (0.1 * size, -0.1 * size), angle=0.4)
    assert max(gaps(obj).values()) < HELD
    assert measured(obj).triangle_area.max() < 2.5  # it goes along, instead of being torn


def test_joints_are_no_handles():
    obj = pinned()
    targets = [(pin.has_target, pin.angle) for pin in obj.planar.pins if pin.kind == "HINGE"]
    drag(obj, "Chest", (0.1, 0.0))
    assert [(pin.has_target, pin.angle) for pin in obj.planar.pins if pin.kind == "HINGE"] == targets
    before = evaluated(obj)
    bpy.ops.planar.select_pins(action="SELECT", pin=0)
    with pytest.raises(RuntimeError, match="select a pin"):
        bpy.ops.planar.drag_pins(offset=(0.1, 0.0))
    assert np.array_equal(evaluated(obj), before)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    bpy.ops.planar.select_pins(action="ALL")
    assert bpy.ops.planar.set_pin_kind(kind="POINT") == {"FINISHED"}
    assert kinds(obj) == ["HINGE"] * 3


@pytest.mark.parametrize("method", ["AKVF", "ARAP"])
def test_other_methods_say_that_they_do_not_hold_joints(method):
    obj = pinned()
    obj.planar.method = method
    before = coordinates(obj.data.vertices)
    bpy.ops.planar.select_pins(action="SELECT", pin=3)
    with pytest.raises(RuntimeError, match="choose Hold Shape, or switch the joints off"):
        bpy.ops.planar.drag_pins(offset=(0.1, 0.0))
    assert np.array_equal(coordinates(obj.data.vertices), before)
    for pin in obj.planar.pins:
        pin.enabled = pin.kind != "HINGE"
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.0)) == {"FINISHED"}


def test_joints_are_known_by_the_layers_that_they_carry(capfd):
    obj = figure()
    _, drawing = shown(obj)
    for slot in range(drawing.parts.max() + 1):
        obj.data.materials.append(bpy.data.materials.new(f"{slot} Layer"))
    part = dict(zip(drawing.vertex_indices.tolist(), drawing.parts.tolist(), strict=True))
    for face in obj.data.polygons:
        face.material_index = part[face.vertices[0]]
    activate(obj)
    assert bpy.ops.planar.attach() == {"FINISHED"}
    carried = {f"{slot} Layer" for slot in range(4)} - {f"{part[0]} Layer"}  # all but the body's
    assert {pin.name for pin in obj.planar.pins} == carried
    assert "Attached by 3 hinges\n" in capfd.readouterr().out


def test_a_part_that_lies_on_no_other_is_told(capfd):
    figure((0.0, 0.0, 1.0, 1.0, 0.0), (0.8, 0.2, 1.0, 0.4, 0.01), (3.0, 0.0, 1.0, 0.4, 0.02))
    assert bpy.ops.planar.attach() == {"FINISHED"}
    assert "Attached by 1 hinge; not attached: 1 part, on which no other lies" in capfd.readouterr().out


def test_a_joint_by_hand_holds_what_lies_under_it():
    obj = figure()
    place = obj.matrix_world @ Vector((1.5, 3.2, 0.1))
    assert bpy.ops.planar.add_joint(location=place) == {"FINISHED"}
    np.testing.assert_allclose(joint_places(obj), [(1.5, 3.2)], atol=1e-4)
    assert [pin.name for pin in obj.planar.pins] == ["Hinge"]
    assert bpy.ops.planar.add_joint(location=place, kind="WELD", radius=0.4 * SIZE) == {"FINISHED"}
    assert [pin.kind for pin in obj.planar.pins] == ["HINGE", "WELD"]
    nowhere = obj.matrix_world @ Vector((3.5, 3.2, 0.1))
    with pytest.raises(RuntimeError, match="No other part lies there"):
        bpy.ops.planar.add_joint(location=nowhere)


def test_a_hinge_becomes_a_weld_and_a_hinge_again():
    obj = pinned()
    pin_at(obj, (4.68, 3.2), "Hand", kind="PATCH", radius=0.2)
    wrist = obj.matrix_world @ Vector((*WRIST, 0.2))
    bent = []
    for kind in ("WELD", "HINGE"):
        for pin in obj.planar.pins:
            pin.kind = pin.kind if pin.kind == "PATCH" else kind
        bpy.ops.planar.select_pins(action="SELECT", pin=obj.planar.pins.find("Hand"))
        assert bpy.ops.planar.rotate_pins(angle=0.8, pivot=wrist) == {"FINISHED"}
        assert len(gaps(obj)) == 3
        assert max(gaps(obj).values()) < HELD
        bent.append(turned_by(obj, 1)[1])
        bpy.ops.planar.reset_to_rest()
    assert bent[1] < 0.1 * bent[0]  # the wrist gives, not the arm


def test_a_weld_has_a_radius():
    obj = pinned()
    bpy.ops.planar.select_pins(action="SELECT", pin=0)
    before = joint_places(obj)
    counts = []
    for radius in (0.2, 0.35):
        assert bpy.ops.planar.set_weld_radius(radius=radius * SIZE) == {"FINISHED"}
        group = obj.vertex_groups[obj.planar.pins[0].group].index
        counts.append(sum(group in {one.group for one in vertex.groups} for vertex in obj.data.vertices))
    assert kinds(obj).count("WELD") == 1
    assert 6 < counts[0] < counts[1]
    np.testing.assert_allclose(joint_places(obj), before, atol=0.1)
    drag(obj, "Chest", (0.05, 0.0), angle=0.3)
    assert max(gaps(obj).values()) < HELD
    bpy.ops.planar.select_pins(action="SELECT", pin=3)  # the chest
    with pytest.raises(RuntimeError, match="click one first"):
        bpy.ops.planar.set_weld_radius(radius=0.01)


def test_attach_and_detach_say_why_nothing_happens():
    figure(BODY)
    with pytest.raises(RuntimeError, match="all one part"):
        bpy.ops.planar.attach()
    apart = figure(BODY, (5.0, 0.0, 1.0, 1.0, 0.0))
    with pytest.raises(RuntimeError, match="lie on each other at rest"):
        bpy.ops.planar.attach()
    assert len(apart.planar.pins) == 0
    assert len(apart.vertex_groups) == 0


def test_detach_removes_joints_and_their_groups():
    obj = pinned()
    drag(obj, "Chest", (0.05, 0.05))
    before = evaluated(obj)
    bpy.ops.planar.select_pins(action="NONE")
    assert bpy.ops.planar.detach() == {"FINISHED"}
    assert [pin.name for pin in obj.planar.pins] == ["Chest"]
    assert len(obj.vertex_groups) == 1
    assert np.array_equal(evaluated(obj), before)


def test_drags_cost_no_new_analysis(monkeypatch):
    from planar_deform import native

    obj = pinned()
    pin_at(obj, (4.6, 3.2), "Hand")
    made, poser = [], native.Poser
    monkeypatch.setattr(native, "Poser", lambda *args, **options: made.append(1) or poser(*args, **options))
    for pin, offset in (("Chest", (0.02, 0.0)), ("Hand", (0.0, 0.05)), ("Chest", (0.0, -0.02))):
        drag(obj, pin, offset)
    assert len(made) == 1
    obj.planar.pins[0].enabled = False  # other joints
    drag(obj, "Chest", (0.02, 0.0))
    drag(obj, "Hand", (0.02, 0.0))
    assert len(made) == 2
