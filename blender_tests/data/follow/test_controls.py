# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Controls and Follow Bones: what is made for pins to follow."""

import base64

import bpy
import numpy as np
import pytest
from follow_scenes import HAND, LEFT, angle, axes, empty, held, imported, moved, turned
from mathutils import Matrix
from support import activate, add_pins, coordinates, evaluated, world

from planar_deform.operators import live

CLOSE = 4e-3


def pinned(**options):
    obj = imported(**options)
    add_pins(obj, [26])
    add_pins(obj, HAND, kind="PATCH")
    activate(obj)
    return obj


def rig(*bones, name="Rig", matrix=None):
    """An armature of unconnected bones: name, head, tail, whether it deforms."""
    data = bpy.data.armatures.new(name)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.matrix_world = matrix or Matrix()
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    back = obj.matrix_world.inverted()
    for bone, head, tail, deform in bones:
        made = data.edit_bones.new(bone)
        made.head, made.tail, made.use_deform = (
            back @ Matrix.Translation(head).translation,
            back @ (Matrix.Translation(tail).translation),
            deform,
        )
    bpy.ops.object.mode_set(mode="OBJECT")
    return obj


@pytest.mark.parametrize("parented", [False, True])
def test_each_pin_gets_an_empty_where_it_is_and_follows_it_live(parented):
    obj = pinned(parented=parented)
    group = bpy.data.collections.new("Drawings")
    bpy.context.scene.collection.children.link(group)
    group.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    for pin in obj.planar.pins:
        pin.select = False
    activate(obj)
    before = coordinates(obj.data.vertices)
    places = held(obj, [26]), held(obj, HAND)
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    assert obj.planar.live
    added = [pin.follow for pin in obj.planar.pins]
    assert [control.name for control in added] == [pin.name for pin in obj.planar.pins]
    assert [control.empty_display_type for control in added] == ["CIRCLE", "CUBE"]
    assert all(control.show_in_front for control in added), "behind the body, too"
    assert set(bpy.context.selected_objects) == set(added)
    assert bpy.context.view_layer.objects.active in added
    for control, place in zip(added, places, strict=True):
        assert control.users_collection == (group,)
        assert control.parent == obj.parent
        np.testing.assert_allclose(control.matrix_world.translation, place, atol=1e-5)
        np.testing.assert_allclose(control.matrix_world.to_scale(), 1.0, atol=1e-5)
        across = control.matrix_world.to_3x3() @ Matrix.Translation((0, 1, 0)).translation
        assert abs(np.dot(across, axes(obj)[2])) == pytest.approx(1.0, abs=1e-5), "its circle lies on it"
    live.follow()
    np.testing.assert_allclose(coordinates(obj.data.vertices), before, atol=5e-3)
    u, v, normal = axes(obj)
    moved(added[1], 0.1 * u + 0.2 * v)
    turned(added[1], normal, 15.0)
    live.follow()
    np.testing.assert_allclose(held(obj, HAND), places[1] + 0.1 * u + 0.2 * v, atol=CLOSE)
    assert angle(obj) == pytest.approx(15.0, abs=1.5)


def test_a_pin_that_follows_and_is_dragged_is_told_not_to_stay(capfd):
    obj = pinned()
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    activate(obj)
    told = "'Pin.001' goes back to 'Pin.001' with the next frame: move that, or keep this by Set Offset"
    capfd.readouterr()
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.0, 0.1)) == {"FINISHED"}
    assert told in capfd.readouterr().out
    obj.planar.live = False
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.0, 0.1)) == {"FINISHED"}
    assert told not in capfd.readouterr().out


def test_a_patch_s_control_shows_its_turn():
    obj = pinned()
    bpy.ops.planar.rotate_pins(pin=1, angle=0.5)
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    first = obj.planar.pins[1].follow.matrix_world.to_3x3() @ Matrix.Translation((1, 0, 0)).translation
    u, v, _ = axes(obj)
    assert np.arctan2(np.dot(first, v), np.dot(first, u)) == pytest.approx(0.5, abs=1e-3)


def test_a_pin_that_follows_live_is_not_recorded_and_another_one_is():
    obj = imported()
    add_pins(obj, LEFT, HAND)
    obj.planar.pins[1].follow = empty((1.0, -1.0, 2.0))
    obj.planar.live = True
    path = base64.b64encode(np.tile((0.1, 0.1, 0.0), (4, 1)).astype("<f4").tobytes()).decode("ascii")
    before = world(obj, evaluated(obj))
    with pytest.raises(RuntimeError, match="'Pin.001' follows 'Control', which would take it back"):
        bpy.ops.planar.record_pins(pin=1, path=path)
    np.testing.assert_array_equal(world(obj, evaluated(obj)), before)
    assert not obj.planar.poses
    assert bpy.ops.planar.record_pins(pin=0, path=path) == {"FINISHED"}
    obj.planar.live = False
    assert bpy.ops.planar.record_pins(pin=1, path=path) == {"FINISHED"}


def test_only_selected_pins_and_those_that_follow_nothing_get_one():
    obj = pinned()
    obj.planar.pins[1].select, obj.planar.pins[0].select = True, False
    bpy.ops.planar.add_controls()
    assert obj.planar.pins[0].follow is None
    assert obj.planar.pins[1].follow is not None
    activate(obj)
    with pytest.raises(RuntimeError, match="There is no pin that follows nothing yet: add or select one"):
        bpy.ops.planar.add_controls()
    before = obj.planar.pins[1].follow
    obj.planar.pins[1].select = False
    bpy.ops.planar.add_controls()
    assert obj.planar.pins[1].follow == before
    assert obj.planar.pins[0].follow is not None


def test_the_pins_of_a_lattice_get_controls_as_well():
    obj = pinned()
    bpy.ops.planar.fit_lattice(resolution=(8, 6))
    cage = bpy.context.object
    for vertex in (26, 38):
        bpy.ops.planar.add_pin(location=held(obj, [vertex]), extend=True)
    start = held(obj, [38])
    assert bpy.ops.planar.add_controls() == {"FINISHED"}
    u, v, _ = axes(obj)
    moved(cage.planar.pins[1].follow, 0.1 * u + 0.1 * v)
    live.follow()
    np.testing.assert_allclose(held(obj, [38]), start + 0.1 * u + 0.1 * v, atol=8e-3)


def test_pins_follow_the_nearest_bones_of_the_selected_armature():
    obj = pinned(parented=True)
    left, right, (u, v, normal) = held(obj, [26]), held(obj, HAND), axes(obj)
    turn = Matrix.LocRotScale((0.4, 0.1, 0.2), None, (0.5, 0.5, 0.5))
    other = rig(("Other", right, right + v, True), name="Other")
    bones = rig(
        ("Far", left - 0.5 * u, left - 0.2 * u - v, True),
        # Nearest by its middle, far by its ends; and far behind the drawing, which does not count.
        ("Arm", right - 0.9 * v + 3.0 * normal, right + 0.7 * v + 3.0 * normal, True),
        ("Shoulder", left + 0.02 * u, left + 0.1 * u, True),
        ("Control", right, right + 0.1 * u, False),
        matrix=turn,
    )
    activate(obj)
    for pin in obj.planar.pins:
        pin.select = False
    with pytest.raises(RuntimeError, match="There are several armatures: select the one to follow"):
        bpy.ops.planar.follow_bones()
    bones.select_set(True)
    before = coordinates(obj.data.vertices)
    assert bpy.ops.planar.follow_bones() == {"FINISHED"}
    assert [pin.follow_bone for pin in obj.planar.pins] == ["Shoulder", "Arm"]
    assert {pin.follow for pin in obj.planar.pins} == {bones}
    live.follow()
    np.testing.assert_allclose(coordinates(obj.data.vertices), before, atol=5e-3)
    bone = bones.pose.bones["Arm"]
    world = bones.matrix_world @ bone.matrix
    bone.matrix = bones.matrix_world.inverted() @ Matrix.Translation(0.15 * u - 0.1 * v) @ world
    bpy.context.view_layer.update()
    live.follow()
    np.testing.assert_allclose(held(obj, HAND), right + 0.15 * u - 0.1 * v, atol=CLOSE)
    assert bpy.ops.planar.follow_bones(armature="Other") == {"FINISHED"}
    assert {pin.follow for pin in obj.planar.pins} == {other}


def test_without_an_armature_it_says_what_to_do():
    obj = pinned()
    with pytest.raises(RuntimeError, match="There is no armature: select the one to follow"):
        bpy.ops.planar.follow_bones()
    empty((0, 0, 0))
    with pytest.raises(RuntimeError, match="There is no armature 'Control' in the scene: choose another"):
        bpy.ops.planar.follow_bones(armature="Control")
    bare = rig()
    activate(obj)
    with pytest.raises(RuntimeError, match=f"'{bare.name}' has no bones: choose another armature"):
        bpy.ops.planar.follow_bones()
    assert obj.planar.pins[0].follow is None
    assert not obj.planar.live


def test_without_pins_it_says_so():
    imported()
    with pytest.raises(RuntimeError, match="There is no pin that follows nothing yet"):
        bpy.ops.planar.add_controls()
