# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of drawings that are carried when their carrier, or they, become something else."""

import bpy
import numpy as np
import pytest
from carry_scenes import attach, body, choose, drag, lantern, seen, strip
from follow_scenes import empty
from support import activate, coordinates, evaluated, from_library, in_edit_mode, world

CLOSE = 6e-3


@pytest.fixture
def pair():
    carrier, obj = body(), lantern()
    choose(obj, 0, 1)
    attach(obj, to=carrier)
    return carrier, obj


def handle_gap(carrier, obj, vertex=66):
    """Of the lantern's upper end from a vertex of the carrier near it, seen from there."""
    return seen(obj)[38:43].mean(axis=0) - seen(carrier)[vertex]


def goes_along(carrier, obj, offset=(-0.2, 0.3)):
    """It is carried, on a straight way, by what its carrier's right end does."""
    before = seen(obj).mean(axis=0), seen(carrier)[[15, 32, 49, 66]].mean(axis=0)
    drag(carrier, 1, offset)
    moved = seen(obj).mean(axis=0) - before[0]
    led = seen(carrier)[[15, 32, 49, 66]].mean(axis=0) - before[1]
    assert np.linalg.norm(led) > 0.5 * np.linalg.norm(offset)
    assert np.linalg.norm(moved - led) < 0.4 * np.linalg.norm(led)


def stays(obj, *, atol=CLOSE):
    """A check, for later, that an object is where it is now."""
    before = seen(obj)

    def check(now=None):
        np.testing.assert_allclose(seen(now or obj), before, atol=atol)

    return check


def test_set_as_rest_and_reset(pair):
    carrier, obj = pair
    drag(carrier, 1, (-0.3, 0.4), angle=0.6)
    check = stays(obj)
    activate(carrier)
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}
    check()
    goes_along(carrier, obj)
    activate(carrier)
    bpy.ops.planar.reset_to_rest()
    check()


def test_applied_transforms_and_an_origin_that_is_set(pair):
    carrier, obj = pair
    carrier.location, carrier.rotation_euler, carrier.scale = (
        (0.2, 0.0, 0.1),
        (0.0, 0.3, 0.0),
        (1.3, 1.3, 1.3),
    )
    bpy.context.view_layer.update()
    drag(carrier, 1, (-0.2, 0.3), angle=0.5)
    check = stays(obj)
    activate(carrier)
    assert bpy.ops.object.transform_apply() == {"FINISHED"}
    bpy.context.view_layer.update()
    check()
    assert bpy.ops.object.origin_set(type="ORIGIN_GEOMETRY") == {"FINISHED"}
    bpy.context.view_layer.update()
    check()
    goes_along(carrier, obj)


def test_a_subdivided_and_a_remeshed_carrier(pair):
    carrier, obj = pair
    drag(carrier, 1, (-0.2, 0.3), angle=0.5)
    check = stays(obj)
    in_edit_mode(carrier, bpy.ops.mesh.subdivide)
    bpy.context.view_layer.update()
    check()
    activate(carrier)
    assert bpy.ops.planar.remesh(vertices=400) == {"FINISHED"}
    bpy.context.view_layer.update()
    check()
    before = seen(obj).mean(axis=0)
    drag(carrier, 1, (-0.2, 0.3))
    assert np.linalg.norm(seen(obj).mean(axis=0) - before) > 0.15


def test_a_carrier_joined_to_another_drawing(pair):
    carrier, obj = pair
    drag(carrier, 1, (-0.2, 0.3), angle=0.5)
    other = strip("Other", -3.0, 0.0, pins="PATCH")
    other.location, other.rotation_euler = (0.1, 0.0, 0.3), (0.0, 0.4, 0.0)
    activate(other)
    carrier.select_set(True)
    check = stays(obj)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    check()
    key = next(key for key, pin in enumerate(other.planar.pins) if pin.kind == "PATCH" and key >= 3)
    before = seen(obj).mean(axis=0)
    drag(other, key, (-0.2, 0.3))
    assert {pin.follow for pin in obj.planar.pins} == {other}
    assert np.linalg.norm(seen(obj).mean(axis=0) - before) > 0.15


def test_joined_to_its_carrier_it_follows_nothing(pair):
    carrier, obj = pair
    activate(carrier)
    obj.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert len(carrier.planar.pins) == 4
    assert all(pin.follow is None for pin in carrier.planar.pins)


def test_a_renamed_carrier(pair):
    carrier, obj = pair
    carrier.name = carrier.data.name = "Renamed"
    goes_along(carrier, obj)


def test_a_deleted_carrier_is_told_and_live_goes_off(pair, capsys):
    carrier, obj = pair
    check = stays(obj)
    activate(carrier)
    bpy.ops.object.delete()
    bpy.context.scene.frame_set(2)
    check()
    assert not obj.planar.live
    assert "'Body', which pin 'Pin' follows, is not in the scene: bring it back" in capsys.readouterr().out


def test_a_place_that_is_gone_is_told(pair, capsys):
    carrier, obj = pair
    carrier.vertex_groups.remove(carrier.vertex_groups[obj.planar.pins[0].follow_group])
    drag(carrier, 1, (-0.2, 0.3))
    assert not obj.planar.live
    assert "'Body' has no vertex group 'Place': choose another one to follow" in capsys.readouterr().out


def test_duplicates_of_both_follow_each_other(pair):
    carrier, obj = pair
    activate(carrier)
    obj.select_set(True)
    bpy.ops.object.duplicate()
    copies = bpy.context.selected_objects
    second = next(one for one in copies if one.name.startswith("Body"))
    carried = next(one for one in copies if one != second)
    assert {pin.follow for pin in carried.planar.pins} == {second}
    check = stays(obj, atol=0.0)
    goes_along(second, carried)
    check()


def test_saved_and_appended(pair, tmp_path):
    carrier, obj = pair
    drag(carrier, 1, (-0.2, 0.3), angle=0.5)
    shapes = {one.name: seen(one) for one in pair}
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    for name, shape in shapes.items():
        np.testing.assert_array_equal(seen(bpy.data.objects[name]), shape)
    goes_along(bpy.data.objects["Body"], bpy.data.objects["Lantern"])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in ("Body", "Lantern"):
        bpy.ops.wm.append(directory=f"{path}/Object/", filename=name)
    obj = bpy.data.objects["Lantern"]
    carrier = obj.planar.pins[0].follow
    if carrier.name not in bpy.context.scene.objects:
        bpy.context.scene.collection.objects.link(carrier)
    bpy.context.view_layer.update()
    goes_along(carrier, obj)


def test_a_linked_carrier_carries_wholes_alone(tmp_path):
    body()
    carrier, obj = from_library(tmp_path, "Body"), lantern()
    activate(carrier)
    obj.select_set(True)
    assert not bpy.ops.planar.attach_to.poll()
    activate(obj)
    obj.planar.pins[0].follow = carrier
    assert obj.planar.pins[0].follow_group == "", "it follows the object"


def test_following_a_drawing_is_following_its_mesh():
    carrier, obj = body(), lantern()
    obj.planar.pins[0].follow = carrier
    assert obj.planar.pins[0].follow_group in carrier.vertex_groups
    obj.planar.live = True
    before = seen(obj)[38:43].mean(axis=0)
    drag(carrier, 1, (-0.2, 0.3))
    assert np.linalg.norm(seen(obj)[38:43].mean(axis=0) - before) > 0.15
    obj.planar.pins[0].follow_group = ""
    before = seen(obj)
    drag(carrier, 1, (0.1, -0.2))
    np.testing.assert_array_equal(seen(obj), before)
    plain = strip("Plain", 0.0, 0.0, pins=None)
    obj.planar.pins[1].follow = plain
    assert obj.planar.pins[1].follow_group == "", "what is no drawing is followed itself"
    assert not plain.vertex_groups


def test_detached_it_stays_and_its_place_goes(pair):
    carrier, obj = pair
    groups = len(carrier.vertex_groups)
    drag(carrier, 1, (-0.2, 0.3))
    activate(obj)
    check = stays(obj, atol=0.0)
    choose(obj, 0)
    assert bpy.ops.planar.detach_from() == {"FINISHED"}
    assert [pin.follow for pin in obj.planar.pins] == [None, carrier]
    assert len(carrier.vertex_groups) == groups
    choose(obj)
    assert bpy.ops.planar.detach_from() == {"FINISHED"}
    assert len(carrier.vertex_groups) == groups - 1
    drag(carrier, 1, (0.2, -0.3))
    check()
    activate(obj)
    assert bpy.ops.planar.detach_from() == {"CANCELLED"}


def whole(kind):
    if kind == "EMPTY":
        return empty((1.9, 0.0, 0.2), "Whole")
    if kind == "LIGHT":
        obj = bpy.data.objects.new("Whole", bpy.data.lights.new("Whole", "POINT"))
        bpy.context.scene.collection.objects.link(obj)
        obj.location, obj.rotation_euler = (1.9, 0.5, 0.2), (0.1, 0.2, 0.3)
        return obj
    if kind == "PARENTED":
        holder = empty((1.0, 2.0, 3.0), "Holder")
        holder.rotation_euler = (0.1, 0.5, 0.3)
        obj = empty((0.3, 0.1, 0.2), "Whole")
        obj.parent = holder
        return obj
    return strip("Whole", 1.7, -0.6, width=0.3, height=0.8, nx=4, ny=8, depth=-0.01, pins=None)


@pytest.mark.parametrize("kind", ["EMPTY", "LIGHT", "PARENTED", "DRAWING"])
def test_what_has_no_pins_is_carried_as_a_whole(kind):
    carrier, obj = body(), whole(kind)
    bpy.context.view_layer.update()
    start = np.array(obj.matrix_world)
    attach(obj, to=carrier)
    np.testing.assert_allclose(np.array(obj.matrix_world), start, atol=2e-6)
    assert (obj.parent, obj.parent_type) == (carrier, "VERTEX_3")
    rows = list(obj.parent_vertices)
    before = seen(carrier)[rows]
    drag(carrier, 1, (-0.3, 0.5), angle=0.8)
    after = seen(carrier)[rows]
    bpy.context.view_layer.update()
    now = np.array(obj.matrix_world)
    line, moved = ((ends[1] - ends[0]) @ [1, 1j] for ends in (before, after))  # about which Blender turns it
    turn = np.conj(moved / line / abs(moved / line))
    assert abs(np.angle(turn)) > 0.2
    linear = np.eye(3)
    linear[np.ix_([0, 2], [0, 2])] = [[turn.real, turn.imag], [-turn.imag, turn.real]]
    np.testing.assert_allclose(now[:3, :3], linear @ start[:3, :3], atol=1e-4)
    arm = start[:3, 3] - np.insert(before.mean(axis=0), 1, 0.0)
    led = np.insert(after.mean(axis=0), 1, 0.0) + linear @ arm
    np.testing.assert_allclose(now[:3, 3], led, atol=1e-4)
    activate(obj)
    assert bpy.ops.planar.detach_from() == {"FINISHED"}
    np.testing.assert_allclose(np.array(obj.matrix_world), now, atol=2e-6)
    assert obj.parent is None


@pytest.mark.parametrize("behind", [0.0, -0.03])
def test_of_layers_on_each_other_the_nearest_carries_a_whole(behind):
    """An arm across the body, behind the prop or between both."""
    chest, arm = body(), strip("Arm", 1.0, -0.2, width=0.4, height=0.9, depth=-0.02 - behind, pins=None)
    activate(chest)
    arm.select_set(True)
    bpy.ops.object.join()
    obj = strip("Whole", 1.1, -0.1, width=0.2, height=0.6, nx=4, ny=4, depth=-0.03, pins=None)
    attach(obj, to=chest)
    on_arm = {row >= 85 for row in obj.parent_vertices}
    assert on_arm == {behind == 0.0}


def test_as_a_whole_a_drawing_keeps_its_pins():
    carrier, obj = body(), lantern()
    attach(obj, to=carrier, whole=True)
    assert all(pin.follow is None for pin in obj.planar.pins)
    shape = coordinates(obj.data.vertices)
    drag(carrier, 1, (-0.3, 0.5))
    np.testing.assert_array_equal(coordinates(obj.data.vertices), shape)
    assert np.linalg.norm(np.array(obj.matrix_world)[:3, 3]) > 0.2
    drag(obj, 1, (0.1, 0.0))
    assert np.abs(coordinates(obj.data.vertices) - shape).max() > 0.05
    place = np.array(obj.matrix_world)
    activate(carrier)
    assert bpy.ops.planar.remesh(vertices=400) == {"FINISHED"}
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(obj.matrix_world), place, atol=0.02)
    drag(carrier, 1, (-0.1, 0.2))
    assert np.linalg.norm((np.array(obj.matrix_world) - place)[:3, 3]) > 0.1


def test_where_one_cannot_be_carried_nothing_is():
    carrier, obj, first = body(), lantern(), empty((1.8, 0.0, 0.2), "First")
    carrier.planar.pins[0].follow = first
    groups = len(carrier.vertex_groups)
    choose(obj, 0, 1)
    activate(carrier)
    for one in (obj, first):
        one.select_set(True)
    with pytest.raises(RuntimeError, match="'Body' follows 'First' already: let go of that first"):
        bpy.ops.planar.attach_to()
    assert first.parent is None
    assert all(pin.follow is None for pin in obj.planar.pins)
    assert len(carrier.vertex_groups) == groups
    assert not obj.planar.live


def test_where_the_second_drawing_cannot_be_carried_the_first_keeps_its_carrier(pair):
    carrier, obj = pair
    other = strip("Other", 1.7, 0.2, pins="PATCH")
    carrier.planar.pins[0].follow = other
    last = strip("Last", 1.7, 0.4, pins="PATCH")
    other.planar.pins[0].follow = last
    groups = {one.name: one.vertex_groups.keys() for one in (carrier, other, last)}
    offsets = [tuple(pin.follow_offset) for pin in obj.planar.pins]
    activate(last)
    for one in (obj, other, carrier):
        one.select_set(True)
        choose(one, 0, 1)
    last.planar.pins[0].follow = other
    assert last.planar.pins[0].follow is None, "that would be a circle"
    bpy.context.view_layer.objects.active = carrier
    with pytest.raises(RuntimeError, match="'(Body|Other)' follows '(Other|Last)' already: let go"):
        bpy.ops.planar.attach_to()
    assert {one.name: one.vertex_groups.keys() for one in (carrier, other, last)} == groups
    assert [tuple(pin.follow_offset) for pin in obj.planar.pins] == offsets
    assert {pin.follow for pin in obj.planar.pins} == {carrier}
    goes_along(carrier, obj)


def test_without_anything_to_carry_it_says_what_to_do():
    carrier = body()
    activate(carrier)
    assert not bpy.ops.planar.attach_to.poll()
    with pytest.raises(RuntimeError, match="Select what is to be carried first, and the drawing that"):
        bpy.ops.planar.attach_to()


def test_a_carrier_deformed_by_modifiers_carries(pair):
    carrier, obj = pair
    before = world(obj, evaluated(obj)).mean(axis=0)
    bend = carrier.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis, bend.angle = "TAPER", "X", 0.0
    wave = carrier.modifiers.new("Displace", "DISPLACE")
    wave.direction, wave.mid_level, wave.strength = "Z", 0.0, 0.3
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world(obj, evaluated(obj)).mean(axis=0) - before, (0.0, 0.0, 0.3), atol=CLOSE)
    carrier.modifiers.new("Solid", "SOLIDIFY")
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world(obj, evaluated(obj)).mean(axis=0), before, atol=CLOSE)


def test_a_duplicate_whose_carrier_is_deleted_does_not_go_over_to_the_first_one(pair, capfd):
    carrier, obj = pair
    activate(carrier)
    obj.select_set(True)
    bpy.ops.object.duplicate()
    twin, other = bpy.data.objects["Body.001"], bpy.data.objects["Lantern.001"]
    assert {pin.follow for pin in other.planar.pins} == {twin}
    twin.location.x += 3.0
    bpy.context.view_layer.update()
    activate(twin)
    bpy.ops.object.delete()
    bpy.context.scene.frame_set(2)
    assert carrier not in {pin.follow for pin in other.planar.pins}
    assert not other.planar.live
    assert "Lantern.001: 'Body.001'" in capfd.readouterr().out
    assert obj.planar.live
