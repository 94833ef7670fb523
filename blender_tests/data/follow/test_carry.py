# SPDX-License-Identifier: GPL-3.0-or-later
"""Attach to Drawing: pins that go with the mesh of another drawing, whatever moves that."""

import bpy
import numpy as np
import pytest
from carry_scenes import attach, body, choose, drag, lantern, motion, place_of, seen, strip
from follow_scenes import empty
from support import activate, add_pins, coordinates

CLOSE = 4e-3  # how near pins come to where they are led
RIGID = 0.02  # of a drawing one long, bent by pins that are led as one


def carried_by(carrier, before, obj, *, rows=None, atol=CLOSE):
    """The rows of a carried drawing are where the place that it follows has taken them."""
    place, weights = place_of(carrier, obj.planar.pins[0])
    turn, offset, _ = motion(before[carrier.name][place], seen(carrier)[place], weights)
    rows = slice(None) if rows is None else rows
    expected = before[obj.name][rows] @ turn.T + offset
    np.testing.assert_allclose(seen(obj)[rows].mean(axis=0), expected.mean(axis=0), atol=atol)
    return turn


@pytest.fixture
def pair():
    carrier, obj = body(), lantern()
    choose(obj, 0, 1)
    attach(obj, to=carrier)
    return carrier, obj, {one.name: seen(one) for one in (carrier, obj)}


def test_nothing_moves_when_it_is_attached():
    carrier, obj = body(), lantern()
    drag(carrier, 1, (-0.2, 0.3), angle=0.4)
    choose(obj, 0, 1)
    before = {one.name: seen(one) for one in (carrier, obj)}
    attach(obj, to=carrier)
    for one in (carrier, obj):
        np.testing.assert_array_equal(seen(one), before[one.name])
    assert obj.planar.live
    assert {pin.follow for pin in obj.planar.pins} == {carrier}
    assert len({pin.follow_group for pin in obj.planar.pins}) == 1, "the pin beside it goes with the other"


def test_pins_follow_the_layer_that_lies_under_them_however_far_away_one_of_their_depth_is():
    far, near = strip("Far", -3.0, 0.0, depth=-0.01, pins=None), body()
    activate(near)
    far.select_set(True)
    bpy.ops.object.join()
    obj = lantern()  # as deep as the layer that is far away
    choose(obj, 0, 1)
    attach(obj, to=near)
    place, weights = place_of(near, obj.planar.pins[0])
    np.testing.assert_allclose(weights @ seen(near)[place] / weights.sum(), (1.85, 0.1), atol=0.15)


def test_a_layer_that_was_joined_without_pins_carries():
    arm, carrier = strip("Arm", -3.0, 0.0, depth=-0.01, pins=None), body()
    drag(carrier, 1, (-0.1, 0.2))
    activate(carrier)
    arm.select_set(True)
    bpy.ops.object.join()
    obj = strip("Prop", -1.2, 0.2, width=0.2, height=0.8, nx=4, ny=8, depth=-0.02, pins=None)
    add_pins(obj, range(5), range(40, 45), kind="PATCH")
    choose(obj, 0, 1)
    before = {one.name: seen(one) for one in (carrier, obj)}
    attach(obj, to=carrier)
    for one in (carrier, obj):
        np.testing.assert_array_equal(seen(one), before[one.name])
    add_pins(carrier, [85 + 16 + 34], kind="PATCH")  # at the arm's right end
    drag(carrier, 2, (0.2, 0.3))
    carried_by(carrier, before, obj)


def test_a_drag_of_the_carrier_takes_it_along(pair):
    carrier, obj, before = pair
    drag(carrier, 1, (-0.3, 0.5), angle=0.8)
    turn = carried_by(carrier, before, obj)
    assert np.degrees(np.arctan2(turn[1, 0], turn[0, 0])) > 30.0
    assert motion(before[obj.name], seen(obj))[2] < RIGID
    drag(carrier, 1, (0.3, -0.5), angle=-0.8)
    np.testing.assert_allclose(seen(obj), before[obj.name], atol=CLOSE)


def test_the_carrier_s_transform_takes_it_along(pair):
    carrier, obj, before = pair
    drag(carrier, 1, (-0.1, 0.2), angle=0.3)
    carrier.location, carrier.rotation_euler = (0.4, 0.0, -0.2), (0.0, 0.5, 0.0)
    bpy.context.view_layer.update()
    carried_by(carrier, before, obj)
    obj.rotation_euler = (0.0, -0.3, 0.0)
    carrier.location.z += 0.1
    bpy.context.view_layer.update()
    carried_by(carrier, before, obj)
    carrier.parent = empty((0.0, 0.0, 0.0), "Holder")
    carrier.parent.location = (0.2, 0.0, 0.5)
    bpy.context.view_layer.update()
    carried_by(carrier, before, obj)


def test_keyed_poses_and_in_betweens_take_it_along(pair):
    carrier, obj, before = pair
    for frame, offset, angle in ((1, (0.0, 0.0), 0.0), (9, (-0.3, 0.5), 0.8), (17, (-0.2, -0.4), -0.6)):
        bpy.context.scene.frame_set(frame)
        activate(carrier)
        bpy.ops.planar.reset_to_rest()
        if frame > 1:
            drag(carrier, 1, offset, angle)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    shapes = {}
    for frame in range(1, 18):
        bpy.context.scene.frame_set(frame)
        carried_by(carrier, before, obj)
        shapes[frame] = seen(obj)
    assert np.ptp([shape.mean(axis=0) for shape in shapes.values()], axis=0).max() > 0.4
    for frame in (12, 3, 17, 1, 8):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(obj), shapes[frame], atol=2e-6)
    bpy.context.scene.frame_set(5)
    activate(obj)
    assert bpy.ops.planar.bake_pins(frame_start=1, frame_end=17) == {"FINISHED"}
    for frame, shape in shapes.items():
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(obj), shape, atol=1e-5)


def chain():
    """Body, arm and lantern: the arm's left end lies on the body, the lantern on the arm's right end."""
    carrier, arm = body(), strip("Arm", 1.6, 0.1, width=1.6, height=0.3, depth=-0.01, pins="PATCH")
    prop = strip("Prop", 2.95, -0.5, width=0.2, height=0.8, nx=4, ny=8, depth=-0.02, pins=None)
    add_pins(prop, range(38, 43), range(5), kind="PATCH")
    choose(arm, 0)
    attach(arm, to=carrier)
    choose(prop, 0, 1)
    attach(prop, to=arm)
    return carrier, arm, prop


def test_a_chain_is_carried_in_order():
    carrier, arm, prop = chain()
    before = {one.name: seen(one) for one in (carrier, arm, prop)}
    drag(carrier, 1, (-0.3, 0.4), angle=0.5)
    carried_by(carrier, before, arm, rows=np.arange(5) * 17)
    carried_by(arm, before, prop)
    drag(arm, 1, (-0.3, 0.4), angle=0.5)
    carried_by(arm, before, prop)
    for frame, angle in ((1, -0.3), (11, 0.6)):
        bpy.context.scene.frame_set(frame)
        drag(carrier, 1, (0.0, 0.0), angle=angle)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    shapes = {}
    for frame in (1, 4, 7, 11):
        bpy.context.scene.frame_set(frame)
        carried_by(carrier, before, arm, rows=np.arange(5) * 17)
        carried_by(arm, before, prop)
        shapes[frame] = seen(prop)
    activate(prop)
    bpy.ops.planar.bake_pins(frame_start=1, frame_end=11)
    for frame, shape in shapes.items():
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(prop), shape, atol=1e-5)


def test_circles_are_refused_and_nothing_has_changed():
    carrier, _, prop = chain()
    activate(prop)
    carrier.select_set(True)
    groups = [group.name for group in prop.vertex_groups]
    with pytest.raises(RuntimeError, match="'Prop' follows 'Arm' already|'Arm' follows 'Body' already"):
        bpy.ops.planar.attach_to()
    assert [group.name for group in prop.vertex_groups] == groups
    assert all(pin.follow is None for pin in carrier.planar.pins)
    with pytest.raises(RuntimeError, match="follows '(Arm|Body)' already: let go of that first, with Detach"):
        bpy.ops.planar.attach_to(whole=True)
    assert carrier.parent is None


def test_undo_is_one_step(pair):
    carrier, _, before = pair
    bpy.ops.ed.undo_push(message="Attach")
    drag(carrier, 1, (-0.3, 0.5))
    bpy.ops.ed.undo_push(message="Drag")
    moved = seen(bpy.data.objects["Lantern"])
    bpy.ops.ed.undo()
    np.testing.assert_array_equal(seen(bpy.data.objects["Lantern"]), before["Lantern"])
    np.testing.assert_array_equal(seen(bpy.data.objects["Body"]), before["Body"])
    bpy.ops.ed.redo()
    np.testing.assert_array_equal(seen(bpy.data.objects["Lantern"]), moved)


def test_stretch_and_shear_do_not_turn_it(pair):
    """The shape of the carrier is another one's than its pins': what is carried keeps its own."""
    carrier, obj, before = pair
    carrier.shape_key_add(name="Basis")
    key = carrier.shape_key_add(name="Sheared")
    shape = coordinates(key.data).astype(float)
    sheared = shape + 0.6 * shape[:, [2]] * (1.0, 0.0, 0.0)  # which turns the edges along Z by 31 degrees
    for wanted, most in ((shape * (1.5, 1.0, 1.0), 1.0), (sheared, 17.0)):
        key.data.foreach_set("co", wanted.astype(np.float32).ravel())
        key.value = 1.0
        carrier.data.update()
        bpy.context.view_layer.update()
        turn, _, missed = motion(before["Lantern"], seen(obj))
        assert missed < RIGID
        assert abs(np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))) < most
        carried_by(carrier, before, obj)


def test_pins_that_follow_nothing_go_on_being_posed(capfd):
    carrier, obj = body(), lantern()
    choose(obj, 0)
    attach(obj, to=carrier)
    told = "Attached 1 pin to 'Body', those that are selected; 1 that is not stays as posed"
    assert told in capfd.readouterr().out
    assert [pin.follow for pin in obj.planar.pins] == [carrier, None]
    before = {one.name: seen(one) for one in (carrier, obj)}
    for frame, offset in ((1, (0.0, 0.0)), (11, (0.3, 0.1))):
        bpy.context.scene.frame_set(frame)
        drag(obj, 1, offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    foot = seen(obj)[:5].mean(axis=0)
    asked = before["Lantern"][:5].mean(axis=0) + np.array((0.3, 0.1))
    np.testing.assert_allclose(foot, asked, atol=CLOSE)
    drag(carrier, 1, (-0.2, 0.3))
    np.testing.assert_allclose(seen(obj)[:5].mean(axis=0), foot, atol=CLOSE)
    carried_by(carrier, before, obj, rows=range(38, 43))
    bpy.context.scene.frame_set(1)
    np.testing.assert_allclose(seen(obj)[:5].mean(axis=0), before["Lantern"][:5].mean(axis=0), atol=CLOSE)


def test_a_lattice_goes_along_while_its_carrier_is_written():
    carrier, obj = body(), strip("Flag", 1.7, -0.6, width=0.3, height=0.8, nx=4, ny=8, depth=-0.01, pins=None)
    activate(obj)
    assert bpy.ops.planar.fit_lattice(resolution=(5, 9)) == {"FINISHED"}
    cage = bpy.context.object
    for row in (40, 2):
        place = obj.matrix_world @ obj.data.vertices[row].co
        assert bpy.ops.planar.add_pin(location=place, extend=True) == {"FINISHED"}
    choose(cage, 0, 1)
    attach(cage, to=carrier)
    before = seen(obj)
    points = coordinates(carrier.data.vertices) + np.array([0.1, 0.0, 0.2])
    bpy.context.view_layer.update()
    carrier.data.vertices.foreach_set("co", points.astype(np.float32).ravel())  # as in a drag
    carrier.data.update()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(seen(obj) - before, np.broadcast_to((0.1, 0.2), before.shape), atol=CLOSE)


def test_the_places_of_what_is_deleted_are_cleared():
    carrier, obj, other = body(), lantern(), strip("Flag", 0.2, 0.1, width=0.3, nx=4)
    carrier.vertex_groups.new(name="Place of my own")
    for one in (obj, other):
        choose(one, 0, 1)
    attach(obj, other, to=carrier)
    kept = {pin.follow_group for pin in other.planar.pins}
    assert {pin.follow_group for pin in obj.planar.pins} - kept
    bpy.context.view_layer.update()
    bpy.data.objects.remove(obj)
    bpy.context.scene.frame_set(2)
    pins = {pin.group for pin in carrier.planar.pins}
    assert set(carrier.vertex_groups.keys()) == {"Place of my own"} | kept | pins


def test_what_is_let_go_plays_its_own_poses_again(pair):
    _, obj, _ = pair
    activate(obj)
    for frame, offset in ((1, (0.0, 0.0)), (9, (0.2, 0.0))):
        bpy.context.scene.frame_set(frame)
        drag(obj, 1, offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    keyed = seen(obj)
    choose(obj)
    activate(obj)
    assert bpy.ops.planar.detach_from() == {"FINISHED"}
    assert not obj.planar.live, "nothing is followed any more"
    for frame in (1, 9):
        bpy.context.scene.frame_set(frame)
    np.testing.assert_allclose(seen(obj), keyed, atol=1e-5)
    bpy.context.scene.frame_set(1)
    assert np.abs(seen(obj) - keyed).max() > 0.1


def test_what_is_posed_by_hand_stays_when_its_carrier_moves_and_goes_with_the_frame():
    carrier, obj = body(), lantern()
    choose(obj, 0)
    attach(obj, to=carrier)
    for frame in (1, 11):  # and held behind the last one
        bpy.context.scene.frame_set(frame)
        activate(obj)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    bpy.context.scene.frame_set(15)
    kept = seen(obj)
    drag(obj, 1, (0.3, 0.2), angle=0.4)
    foot = seen(obj)[:5].mean(axis=0)
    assert np.abs(foot - kept[:5].mean(axis=0)).max() > 0.1
    before = {one.name: seen(one) for one in (carrier, obj)}
    drag(carrier, 1, (-0.1, 0.2), angle=0.3)
    np.testing.assert_allclose(seen(obj)[:5].mean(axis=0), foot, atol=CLOSE)
    carried_by(carrier, before, obj, rows=range(38, 43))
    drag(carrier, 1, (0.1, -0.2), angle=-0.3)
    np.testing.assert_allclose(seen(obj), before[obj.name], atol=CLOSE)
    bpy.context.scene.frame_set(16)
    np.testing.assert_allclose(seen(obj), kept, atol=CLOSE)
    bpy.context.scene.frame_set(15)
    np.testing.assert_allclose(seen(obj), kept, atol=CLOSE)
