# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins of lattices that follow objects and bones: at once, live, and frame by frame."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Quaternion, Vector
from support import activate, bar, coordinates, evaluated, world
from test_lattice_posing import layered, pin_at, points, shown

from planar_deform.operators import live
from planar_deform.scene.motion import follow_offset

ENDS = (0, 90)


def empty(place, name="Target"):
    target = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(target)
    target.location = place
    bpy.context.view_layer.update()
    return target


def aimed(offset=(0.2, 0.0, 0.15)):
    """A lattice with a pin at each end of its back layer, of which the last one has a target."""
    cage, back, _ = layered()
    for vertex in ENDS:
        pin_at(back, vertex)
    target = empty(shown(back, ENDS[1]) + np.array(offset))
    snapped(cage, 1, target)
    activate(cage)
    return cage, back, target


def snapped(obj, pin, target):
    """Let a pin follow the origin of a target, and not from where it is."""
    obj.planar.pins[pin].follow = target
    follow_offset.clear(obj, [pin])


def along(cage, offset):
    """The part of a world offset that lies in the lattice's plane."""
    normal = np.array(cage.matrix_world)[:3, 2]
    normal /= np.linalg.norm(normal)
    return offset - normal * (normal @ offset)


def test_a_pin_goes_to_its_target_and_the_others_hold():
    cage, back, target = aimed()
    start = [shown(back, vertex) for vertex in ENDS]
    assert bpy.ops.planar.follow_now() == {"FINISHED"}
    gone = along(cage, np.array(target.location) - start[1])
    np.testing.assert_allclose(shown(back, ENDS[1]) - start[1], gone, atol=8e-3)
    np.testing.assert_allclose(shown(back, ENDS[0]), start[0], atol=8e-3)
    before = points(cage)
    target.location.x += 1e-9  # it is there
    bpy.ops.planar.follow_now()
    np.testing.assert_allclose(points(cage), before, atol=2e-2)


def test_a_bone_is_followed():
    cage, back, target = aimed()
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("Hand")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.location = target.location
    pin = cage.planar.pins[1]
    pin.follow, pin.follow_bone = rig, "Foot"
    activate(cage)
    with pytest.raises(RuntimeError, match="no bone 'Foot'"):
        bpy.ops.planar.follow_now()
    pin.follow_bone = "Hand"
    rig.pose.bones["Hand"].location.y = 0.1
    bpy.context.view_layer.update()
    start = shown(back, ENDS[1])
    bpy.ops.planar.follow_now()
    gone = along(cage, np.array((0.0, 0.0, 0.1)))
    np.testing.assert_allclose(shown(back, ENDS[1]) - start, gone, atol=8e-3)


def test_a_drawing_s_pin_has_a_target_as_well():
    obj = bar(plane="XZ")
    bpy.ops.planar.add_pin(location=world(obj)[0])
    bpy.ops.planar.add_pin(location=world(obj)[64])
    start = world(obj)
    snapped(obj, 1, empty(start[64] + (0.1, 3.0, 0.2)))
    activate(obj)
    assert bpy.ops.planar.follow_now() == {"FINISHED"}
    np.testing.assert_allclose(world(obj)[64], start[64] + (0.1, 0.0, 0.2), atol=5e-3)
    np.testing.assert_allclose(world(obj)[0], start[0], atol=5e-3)


def test_frames_are_baked_to_keys_of_the_lattice_that_blender_plays():
    cage, back, target = aimed()
    start = shown(back, ENDS[1])
    for frame, shift in ((1, 0.0), (13, 0.4)):
        target.location = start + np.array((shift, 0.0, 0.5 * shift))
        target.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(5)
    cage.planar.live = True
    assert bpy.ops.planar.bake_pins(frame_start=1, frame_end=13) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 5
    assert not cage.planar.live, "what is keyed plays"
    keys = cage.data.shape_keys
    assert not keys.use_relative
    for frame in (1, 4, 5, 9, 13):
        bpy.context.scene.frame_set(frame)
        gone = along(cage, np.array(target.matrix_world.translation) - start)
        np.testing.assert_allclose(shown(back, ENDS[1]) - start, gone, atol=1e-2)
    bpy.context.scene.frame_set(4)
    first = evaluated(back)
    bpy.context.scene.frame_set(5)
    second = evaluated(back)
    bpy.context.scene.frame_set(4, subframe=0.5)
    np.testing.assert_allclose(evaluated(back), (first + second) / 2, atol=1e-6)
    curves = bpy.data.actions[keys.animation_data.action.name]
    assert curves is not None


def test_a_lattice_that_moves_with_its_targets_stays_as_it_is():
    cage, back, target = aimed((0.0, 0.0, 0.0))
    for obj in (target, back):
        obj.parent = cage
        obj.matrix_parent_inverse = cage.matrix_world.inverted()
    first = cage.location.x
    for frame, x in ((1, 0.0), (5, 3.0)):
        cage.location.x = first + x
        cage.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.context.view_layer.update()
    target.location = cage.matrix_world.inverted() @ target.location
    target.matrix_parent_inverse = Matrix()
    rest = points(cage)
    bpy.ops.planar.bake_pins(frame_start=1, frame_end=5)
    bpy.context.scene.frame_set(5)
    played = cage.data.shape_keys.key_blocks[-1]
    shape = np.array([point.co for point in played.data])
    np.testing.assert_allclose(shape, rest, atol=2e-2)


def through_a_camera():
    """A monkey in a lattice across a perspective camera, whose nearest pin has a target out of its depth."""
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    turn = Quaternion((0.8, 0.5, 0.1, 0.2)).normalized()
    camera.matrix_world = Matrix.LocRotScale(turn @ Matrix.Translation((0, 0, 6)).translation, turn, None)
    bpy.context.scene.camera = camera
    activate(monkey)
    bpy.ops.planar.fit_lattice(space="CAMERA")
    cage = bpy.context.object
    before = world(monkey, evaluated(monkey))
    depth = (before - np.array(camera.location)) @ np.array(camera.matrix_world)[:3, 2]
    nearest, furthest = int(np.argmax(depth)), int(np.argmin(depth))
    for vertex in (nearest, furthest):
        bpy.ops.planar.add_pin(location=before[vertex])
    target = empty(before[nearest] + np.array(camera.matrix_world)[:3, :3] @ (0.3, 0.2, 1.5))
    snapped(cage, 0, target)
    activate(cage)
    return cage, monkey, nearest, camera, target


def on_screen(camera, place):
    seen = np.array(camera.matrix_world.inverted() @ Matrix.Translation(place).translation)
    return seen[:2] / seen[2]


def assert_seen_at_the_target(monkey, vertex, camera, target):
    now = world(monkey, evaluated(monkey))[vertex]
    np.testing.assert_allclose(
        on_screen(camera, now), on_screen(camera, target.matrix_world.translation), atol=4e-3
    )


def test_through_a_camera_a_model_s_pin_is_seen_where_its_target_is():
    _cage, monkey, vertex, camera, target = through_a_camera()
    assert bpy.ops.planar.follow_now() == {"FINISHED"}
    assert_seen_at_the_target(monkey, vertex, camera, target)


def test_through_a_camera_frames_are_baked_as_they_are_solved():
    _cage, monkey, vertex, camera, target = through_a_camera()
    start = target.location.copy()
    for frame, shift in ((1, 0.0), (5, 0.4)):
        target.location = start + camera.matrix_world.to_3x3() @ Matrix.Translation((shift, 0, 0)).translation
        target.keyframe_insert("location", frame=frame)
    bpy.ops.planar.bake_pins(frame_start=1, frame_end=5)
    for frame in (1, 3, 5):
        bpy.context.scene.frame_set(frame)
        assert_seen_at_the_target(monkey, vertex, camera, target)


def test_a_camera_that_moves_with_its_lattice_and_model_sees_the_target_where_it_is():
    cage, monkey, vertex, camera, target = through_a_camera()
    bpy.context.view_layer.update()
    for obj in (cage, monkey):
        obj.parent = camera
        obj.matrix_parent_inverse = camera.matrix_world.inverted()
    place = camera.location.copy()
    for frame, x in ((1, 0.0), (5, 0.3)):
        camera.location.x = place.x + x
        camera.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.ops.planar.bake_pins(frame_start=1, frame_end=5)
    for frame in (1, 3, 5):
        bpy.context.scene.frame_set(frame)
        assert_seen_at_the_target(monkey, vertex, camera, target)


def test_without_targets_it_says_so_and_changes_nothing():
    cage, _back, _front = layered()
    pin_at(bpy.data.objects["Back"], 0)
    for operator in (bpy.ops.planar.follow_now, bpy.ops.planar.bake_pins):
        with pytest.raises(RuntimeError, match="No pin follows anything"):
            operator()
    assert cage.data.shape_keys is None


def test_live_follows_the_target_and_the_lattice_itself():
    cage, back, target = aimed((0.0, 0.0, 0.0))
    before = points(cage)
    live.follow()
    assert np.array_equal(points(cage), before), "it is off at first"
    cage.planar.live = True
    bpy.context.view_layer.update()
    start = [shown(back, vertex) for vertex in ENDS]
    target.location.x += 0.2
    bpy.context.view_layer.update()
    live.follow()
    gone = along(cage, np.array((0.2, 0.0, 0.0)))
    np.testing.assert_allclose(shown(back, ENDS[1]) - start[1], gone, atol=8e-3)
    np.testing.assert_allclose(shown(back, ENDS[0]), start[0], atol=8e-3)
    cage.location.z += 0.3  # the pins hold what comes along, the target stays
    back.location.z += 0.3
    bpy.context.view_layer.update()
    live.follow()
    np.testing.assert_allclose(along(cage, shown(back, ENDS[1]) - np.array(target.location)), 0.0, atol=8e-3)
    np.testing.assert_allclose(shown(back, ENDS[0]), start[0] + (0.0, 0.0, 0.3), atol=8e-3)


def test_live_does_nothing_while_no_target_moves():
    cage, back, target = aimed()
    cage.planar.live = True
    bpy.context.view_layer.update()
    live.follow()
    before = points(cage)
    other = empty((5.0, 5.0, 5.0), "Other")
    other.location.x = 7.0
    back.select_set(True)
    bpy.context.view_layer.update()
    live.follow()
    assert np.array_equal(points(cage), before)
    target.location.x += 0.1
    cage.planar.live = False
    bpy.context.view_layer.update()
    live.follow()
    assert np.array_equal(points(cage), before)


def test_live_keeps_keyed_poses():
    cage, back, target = aimed()
    bpy.ops.planar.key_pose()
    keyed = keyed_shapes(cage)
    cage.planar.live = True
    bpy.context.view_layer.update()
    live.follow()
    start = shown(back, ENDS[1])
    target.location.x += 0.1
    bpy.context.view_layer.update()
    live.follow()
    assert np.linalg.norm(shown(back, ENDS[1]) - start) > 0.05
    now = keyed_shapes(cage)
    for name, shape in keyed.items():
        assert np.array_equal(now[name], shape), "only what is shown has moved"


def keyed_shapes(cage):
    blocks = cage.data.shape_keys.key_blocks
    return {block.name: np.array([point.co for point in block.data]) for block in blocks}


def test_live_goes_off_with_the_reason_where_it_is_refused(capsys):
    cage, back, target = aimed()
    cage.planar.live = True
    bpy.context.view_layer.update()
    back.modifiers.new("Finer", "SUBSURF")
    back.modifiers.move(1, 0)
    before = points(cage)
    target.location.x += 0.1
    bpy.context.view_layer.update()
    live.follow()
    assert not cage.planar.live
    assert "Finer" in capsys.readouterr().out
    assert np.array_equal(points(cage), before)


def test_live_of_renamed_and_of_duplicated_drawings():
    obj = bar(plane="XZ")
    for vertex in (0, 64):
        bpy.ops.planar.add_pin(location=world(obj)[vertex])
    target = empty(world(obj)[64])
    obj.planar.pins[1].follow = target
    obj.planar.live = True
    bpy.context.view_layer.update()
    obj.name = "Renamed"
    activate(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    assert twin != obj
    target.location.z += 0.2
    bpy.context.view_layer.update()
    live.follow()
    for each in (obj, twin):
        np.testing.assert_allclose(world(each)[64], target.location, atol=5e-3)


def test_live_is_in_the_file(tmp_path):
    cage, _back, target = aimed((0.0, 0.0, 0.0))
    name = cage.name
    cage.planar.live = True
    bpy.context.view_layer.update()
    live.follow()
    path = str(tmp_path / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    cage, back, target = (bpy.data.objects[each] for each in (name, "Back", "Target"))
    before, start = points(cage), shown(back, ENDS[1])
    live.follow()
    assert np.array_equal(points(cage), before)
    target.location.x += 0.2
    bpy.context.view_layer.update()
    live.follow()
    assert np.linalg.norm(shown(back, ENDS[1]) - start) > 0.1


def with_live(build):
    """What follows a target that stands at its pin, with Live on, and where that is."""
    if build == "lattice":
        obj, _, target = aimed((0.0, 0.0, 0.0))
        bpy.ops.planar.drag_pins(pin=0, offset=(0.05, 0.1))
    else:
        obj = bar(plane="XZ")
        for vertex in (0, 64):
            bpy.ops.planar.add_pin(location=world(obj)[vertex])
        target = empty(world(obj)[64])
        obj.planar.pins[1].follow = target
        if build == "drawing with a key":
            obj.shape_key_add(name="Basis")
    obj.planar.live = True
    bpy.context.view_layer.update()
    live.follow()
    return obj, target


def stored(obj):
    """All that following writes."""
    keys = obj.data.shape_keys
    shape = points(obj) if obj.type == "LATTICE" else coordinates(obj.data.vertices)
    names = [] if keys is None else [(key.name, coordinates(key.data).tobytes()) for key in keys.key_blocks]
    pins = [
        (pin.has_target, tuple(pin.target), tuple(pin.reached), pin.angle, pin.group)
        for pin in obj.planar.pins
    ]
    return shape.tobytes(), names, pins, obj.active_shape_key_index


def moved_to(target, *places):
    for place in places:
        target.location = place
        bpy.context.view_layer.update()
        live.follow()


@pytest.mark.parametrize("build", ["lattice", "drawing", "drawing with a key"])
def test_live_gives_everything_back_to_the_bit_when_the_target_goes_back(build, monkeypatch):
    monkeypatch.setattr(live, "PAUSE", 100.0, raising=False)  # one motion, however slow the machine is
    obj, target = with_live(build)
    live.forget()  # what has been moved before is another motion
    before, place = stored(obj), target.location.copy()
    moved_to(target, *(place + Vector((0.04 * step, 0.0, 0.07 * step)) for step in range(1, 6)))
    assert stored(obj)[:2] != before[:2]
    moved_to(target, place)
    assert stored(obj) == before
    moved_to(target, place + Vector((0.1, 0.0, 0.0)))
    assert stored(obj)[:2] != before[:2], "and follows on"


def test_live_takes_nothing_back_that_was_posed_by_hand_meanwhile(monkeypatch):
    monkeypatch.setattr(live, "PAUSE", 100.0, raising=False)
    cage, target = with_live("lattice")
    back, place = bpy.data.objects["Back"], target.location.copy()
    moved_to(target, place + Vector((0.1, 0.0, 0.1)))
    activate(cage)
    bpy.ops.planar.drag_pins(pin=0, offset=(-0.2, 0.2))
    held = shown(back, ENDS[0])
    moved_to(target, place)
    np.testing.assert_allclose(shown(back, ENDS[0]), held, atol=8e-3)
    np.testing.assert_allclose(along(cage, shown(back, ENDS[1]) - np.array(place)), 0.0, atol=8e-3)
