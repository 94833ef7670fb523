# SPDX-License-Identifier: GPL-3.0-or-later
"""Several objects posed, keyed and filled as one: each keeps its own data, all of them change, or none."""

import math

import bpy
import numpy as np
import pytest
from several import choose, drag, figure, go_to, limb, named, select, state, target_of, tip, two_poses
from support import evaluated

ALL = ("Body", "Arm.L", "Arm.R")


# ---- who takes part


def test_the_active_one_comes_first_then_the_others_by_name():
    from planar_deform.scene.pins.taking_part import taking_part

    body, left, right = figure()
    plain = limb("Plain", 6.0)
    plain.planar.pins.clear()
    hidden = limb("Hidden", 9.0)
    hidden.hide_set(True)
    choose(right, body, left, plain)
    assert taking_part(bpy.context).objects == [right, left, body]
    assert taking_part(bpy.context).left_out == {}
    left.select_set(False)
    assert taking_part(bpy.context).objects == [right, body]


def test_meshes_that_share_their_data_are_left_out_and_told_so(capfd):
    body, left, right = figure()
    twin = bpy.data.objects.new("Twin", left.data)
    bpy.context.scene.collection.objects.link(twin)
    twin.planar.pins.add().group = left.planar.pins[0].group
    twin.select_set(True)
    bpy.context.view_layer.update()
    before = state(left)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert (len(body.planar.poses), len(right.planar.poses), len(left.planar.poses)) == (1, 1, 0)
    assert state(left) == before
    told = capfd.readouterr().out
    assert "'Arm.L' is left out: The mesh is shared" in told
    assert "'Twin' is left out: The mesh is shared" in told


def test_what_hangs_in_a_lattice_that_takes_part_is_posed_by_that():
    from planar_deform.scene.pins.taking_part import taking_part

    body, left, _ = figure()
    data = bpy.data.lattices.new("Cage")
    data.points_u, data.points_v, data.points_w = 3, 1, 3
    cage = bpy.data.objects.new("Cage", data)
    bpy.context.scene.collection.objects.link(cage)
    left.modifiers.new("Cage", "LATTICE").object = cage
    pin = cage.planar.pins.add()
    pin.name, pin.lattice_point = "Corner", 0
    choose(body, left, cage)
    assert taking_part(bpy.context).objects == [body, cage]
    cage.select_set(False)
    assert taking_part(bpy.context).objects == [body, left]


def test_a_renamed_object_keeps_its_pins_under_the_mouse():
    from planar_deform.scene.view import snapshot

    objects = figure()
    assert len(snapshot.pins_in_view(bpy.context)) == 6
    objects[1].name = "Wing"
    assert {pin.owner for pin in snapshot.pins_in_view(bpy.context)} == {"Body", "Wing", "Arm.R"}


# ---- drags


def test_a_drag_moves_the_selected_pins_of_all_the_same_way():
    objects = figure()
    before = [tip(obj) for obj in objects]
    drag((0.2, 0.5))
    for obj, start in zip(objects, before, strict=True):
        assert tip(obj) - start == pytest.approx([0.2, 0.0, 0.5], abs=5e-3)
        assert obj.planar.pins["Root"].has_target, "it holds"


def test_objects_without_selected_pins_are_not_solved():
    objects = figure()
    select(objects=[objects[0], objects[2]])
    others = [state(obj) for obj in (objects[0], objects[2])]
    drag((0.2, 0.5))
    assert [state(obj) for obj in (objects[0], objects[2])] == others
    assert objects[1].planar.pins["Tip"].has_target


def test_objects_turned_scaled_and_mirrored_go_the_same_way_in_the_world():
    objects = figure()
    objects[1].rotation_euler.y = 0.8
    objects[1].scale = (2.0, 1.0, 0.5)
    objects[2].scale.x = -1.0
    bpy.context.view_layer.update()
    before = [tip(obj) for obj in objects]
    drag((0.1, 0.25))
    for obj, start in zip(objects, before, strict=True):
        assert tip(obj) - start == pytest.approx([0.1, 0.0, 0.25], abs=0.01), obj.name


def test_turning_is_about_the_common_middle():
    objects = figure()
    objects[2].scale.x = -1.0  # seen from behind
    bpy.context.view_layer.update()
    before = [tip(obj) for obj in objects]
    middle = np.mean(before, axis=0)
    assert bpy.ops.planar.rotate_pins(angle=math.radians(20)) == {"FINISHED"}
    c, s = math.cos(math.radians(20)), math.sin(math.radians(20))
    sign = 1.0 if (tip(objects[0]) - before[0])[2] * (before[0] - middle)[0] > 0.0 else -1.0
    for obj, start in zip(objects, before, strict=True):
        x, _, z = start - middle
        turned = middle + np.array([c * x - sign * s * z, 0.0, sign * s * x + c * z])
        assert obj.planar.pins["Tip"].has_target
        target = target_of(obj)
        assert target == pytest.approx(turned, abs=1e-4), obj.name


def test_spreading_is_from_the_common_middle_and_a_pivot_can_be_told():
    for pivot in (None, (0.0, 0.0, 1.0)):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        objects = figure()
        before = [tip(obj) for obj in objects]
        middle = np.mean(before, axis=0) if pivot is None else np.array(pivot)
        told = {} if pivot is None else {"pivot": pivot}
        assert bpy.ops.planar.spread_pins(factor=1.1, **told) == {"FINISHED"}
        for obj, start in zip(objects, before, strict=True):
            target = target_of(obj)
            assert target == pytest.approx(middle + 1.1 * (start - middle), abs=1e-5)


def test_patches_selected_in_two_objects_are_spread_and_not_scaled():
    objects = figure()
    for obj in objects:
        obj.planar.pins["Tip"].kind = "PATCH"
    assert bpy.ops.planar.spread_pins(factor=1.2) == {"FINISHED"}
    assert [obj.planar.pins["Tip"].scale for obj in objects] == [1.0, 1.0, 1.0]


def test_a_press_on_a_pin_of_another_object_makes_that_active_and_the_rest_lets_go():
    objects = figure()
    others = [state(obj)[0] for obj in (objects[0], objects[2])]
    drag((0.1, 0.3), object="Arm.L", pin=0)
    assert bpy.context.object == objects[1]
    assert all(obj.select_get() for obj in objects)
    assert [[pin.select for pin in obj.planar.pins] for obj in objects] == [
        [False, False],
        [True, False],
        [False, False],
    ]
    assert [state(obj)[0] for obj in (objects[0], objects[2])] == others
    drag((0.1, 0.1), object="Body", pin=1, extend=True)
    assert bpy.context.object == objects[0]
    assert objects[1].planar.pins[0].select
    assert objects[0].planar.pins[1].select


def test_a_pin_of_what_does_not_take_part_is_refused():
    figure()
    limb("Alone", 9.0).select_set(False)
    choose(*named(*ALL))
    with pytest.raises(RuntimeError, match="'Alone' takes no part: select it"):
        bpy.ops.planar.drag_pins(object="Alone", pin=0, offset=(0.1, 0.1))
    with pytest.raises(RuntimeError, match="There is no pin 7"):
        bpy.ops.planar.drag_pins(object="Arm.L", pin=7, offset=(0.1, 0.1))


def test_objects_whose_selected_pins_are_off_stay_where_they_are():
    objects = figure()
    objects[1].planar.pins["Tip"].enabled = False
    before = state(objects[1])
    drag((0.2, 0.2))
    assert state(objects[1]) == before
    for obj in objects:
        obj.planar.pins["Tip"].enabled = False
    with pytest.raises(RuntimeError, match="'Body': The selected pins are off"):
        bpy.ops.planar.drag_pins(offset=(0.1, 0.1))


def _no_number(obj):
    obj.data.vertices[3].co.x = math.nan


def _no_group(obj):
    obj.vertex_groups.remove(obj.vertex_groups[obj.planar.pins["Tip"].group])
    obj.vertex_groups.new(name="Other")
    obj.vertex_groups.new(name="Another")


def _not_flat(obj):
    obj.data.vertices[3].co.y += 0.5


@pytest.mark.parametrize("spoil", [_no_number, _no_group, _not_flat])
@pytest.mark.parametrize("verb", ["drag_pins", "rotate_pins", "spread_pins", "reset_selected_pins"])
def test_what_cannot_be_posed_refuses_the_whole_drag_and_tells_whose_it_is(spoil, verb):
    objects = figure()
    spoil(objects[2])
    objects[2].data.update()
    before = [state(obj) for obj in objects]
    with pytest.raises(RuntimeError, match=r"'Arm\.R'"):
        getattr(bpy.ops.planar, verb)()
    assert [state(obj) for obj in objects] == before


def test_too_far_for_one_is_too_far_for_all():
    objects = figure()
    objects[2].scale = (1e-30, 1e-30, 1e-30)
    bpy.context.view_layer.update()
    before = [state(obj) for obj in objects]
    with pytest.raises(RuntimeError, match=r"'Arm\.R'"):
        bpy.ops.planar.drag_pins(offset=(1e12, 0.0))
    assert [state(obj) for obj in objects] == before


@pytest.mark.parametrize("auto", [False, True])
def test_an_error_at_the_end_of_the_third_takes_all_back_to_the_bit(monkeypatch, auto):
    from planar_deform.errors import Refusal
    from planar_deform.scene.pins import pin_list

    objects = two_poses()
    go_to(5)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = auto
    stored = pin_list.store_results

    def store(obj, *told):
        if obj.name == "Arm.R":
            raise Refusal("it broke")
        stored(obj, *told)

    before = [state(obj) for obj in objects]
    with monkeypatch.context() as patched:
        patched.setattr(pin_list, "store_results", store)
        with pytest.raises(RuntimeError, match=r"'Arm\.R': it broke"):
            bpy.ops.planar.drag_pins(offset=(0.3, 0.2))
    assert [state(obj) for obj in objects] == before
    drag((0.3, 0.2))
    assert [len(obj.planar.poses) for obj in objects] == [2 + auto] * 3


def test_settling_is_of_all_that_have_pins():
    objects = figure()
    drag((0.1, 0.3))
    for obj in objects:
        obj.planar.pins["Tip"].weight = 0.01
    before = [evaluated(obj) for obj in objects]
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}
    for obj, shape in zip(objects, before, strict=True):
        assert np.abs(evaluated(obj) - shape).max() > 1e-6


def test_undo_and_redo_are_one_step_for_all():
    objects = figure()
    names = [obj.name for obj in objects]
    bpy.ops.ed.undo_push(message="Before")
    before = [state(obj) for obj in objects]
    drag((0.2, 0.4))
    bpy.ops.ed.undo_push(message="Drag")
    after = [state(obj) for obj in named(*names)]
    bpy.ops.ed.undo()
    assert [state(obj) for obj in named(*names)] == before
    bpy.ops.ed.redo()
    assert [state(obj) for obj in named(*names)] == after


# ---- lists of pins


def test_pins_of_all_are_selected_switched_and_removed():
    objects = figure()
    assert bpy.ops.planar.select_pins(action="ALL") == {"FINISHED"}
    assert all(pin.select for obj in objects for pin in obj.planar.pins)
    assert bpy.ops.planar.select_pins(action="SELECT", pin=0) == {"FINISHED"}
    assert [pin.select for obj in objects for pin in obj.planar.pins] == [True, *[False] * 5]
    assert bpy.ops.planar.select_pins(action="INVERT") == {"FINISHED"}
    assert bpy.ops.planar.disable_pins() == {"FINISHED"}
    assert [pin.enabled for obj in objects for pin in obj.planar.pins] == [True, *[False] * 5]
    assert bpy.ops.planar.enable_pins() == {"FINISHED"}
    assert bpy.ops.planar.set_pin_kind(kind="PATCH") == {"FINISHED"}
    assert [pin.kind for obj in objects for pin in obj.planar.pins] == ["POINT", *["PATCH"] * 5]
    assert bpy.ops.planar.remove_pins() == {"FINISHED"}
    assert [len(obj.planar.pins) for obj in objects] == [1, 0, 0]


def test_an_active_object_without_pins_leaves_those_of_others_to_be_used():
    objects = figure()
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    choose(empty, *objects)
    assert bpy.ops.planar.select_pins(action="ALL") == {"FINISHED"}
    before = tip(objects[1])
    drag((0.1, 0.2))
    assert tip(objects[1]) - before == pytest.approx([0.1, 0.0, 0.2], abs=5e-3)
