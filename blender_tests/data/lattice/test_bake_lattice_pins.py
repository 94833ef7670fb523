# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets baked over frames in which more moves than the targets, and pins that have none."""

import bpy
import numpy as np
import pytest
from lattice_scenes import pin_at, points, shown, solid
from sequences import curve_of
from support import activate, add_pins, bar, evaluated, world
from test_lattice_follow import ENDS, aimed, along, empty

FRAMES = 41


def swaying(target, reach=0.4):
    """The target goes to and fro beside its pin."""
    start = target.location.copy()
    for frame in range(1, FRAMES + 1, 4):
        target.location = start
        target.location.x += reach * np.sin(0.4 * (frame - 1))
        target.location.z += 0.5 * reach * np.sin(0.4 * (frame - 1))
        target.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)


def bake(last=FRAMES):
    assert bpy.ops.planar.bake_pins(frame_start=1, frame_end=last) == {"FINISHED"}


def in_frames(see, last=FRAMES):
    """What is seen in each frame."""
    found = []
    for frame in range(1, last + 1):
        bpy.context.scene.frame_set(frame)
        found.append(see())
    return np.array(found)


def keyed_value(keys, index, values):
    """Animate the value of a shape key."""
    for frame, value in values.items():
        keys.key_blocks[index].value = value
        keys.key_blocks[index].keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_set(1)


def test_pins_without_a_target_stand_in_all_frames():
    _cage, back, target = aimed((0.0, 0.0, 0.0))
    swaying(target)
    held = shown(back, ENDS[0])
    bake()
    gaps = np.linalg.norm(in_frames(lambda: shown(back, ENDS[0])) - held, axis=1)
    assert gaps.max() < 8e-4, "they are soft, but do not drift from frame to frame"


def test_patches_of_a_drawing_are_not_turned_by_the_way_of_their_target():
    obj = bar(plane="XZ")
    left, hand = list(range(0, 65, 13)), [11, 12, 24, 25, 37, 38, 50, 51, 63, 64]
    add_pins(obj, left)
    add_pins(obj, hand, kind="PATCH")
    target = empty(world(obj)[hand].mean(axis=0))
    obj.planar.pins[1].follow = target
    swaying(target, 0.3)
    activate(obj)
    bake()

    def angle():
        arm = np.diff(world(obj, evaluated(obj))[[11, 63]], axis=0)[0]
        return np.degrees(np.arctan2(arm[0], arm[2]))

    assert np.abs(in_frames(angle)).max() < 2.0


def test_meshes_that_are_animated_by_shape_keys_are_read_in_every_frame():
    cage, back, target = aimed((0.0, 0.0, 0.0))
    back.shape_key_add(name="Basis")
    key = back.shape_key_add(name="Stretch")
    for point in key.data:
        point.co.x *= 1.25
    keyed_value(back.data.shape_keys, 1, {1: 0.0, 11: 1.0})
    held, start = (shown(back, vertex) for vertex in ENDS)
    activate(cage)
    bake(11)
    for frame in (1, 4, 8, 11):
        bpy.context.scene.frame_set(frame)
        goal = start + along(cage, np.array(target.location) - start)
        np.testing.assert_allclose(shown(back, ENDS[1]), goal, atol=8e-3)
        np.testing.assert_allclose(shown(back, ENDS[0]), held, atol=8e-3)


def test_modifiers_above_that_are_animated_are_read_in_every_frame():
    cage, back, target = aimed((0.0, 0.0, 0.0))
    bend = back.modifiers.new("Shear", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis = "STRETCH", "X"
    back.modifiers.move(1, 0)
    for frame, factor in ((1, 0.0), (11, 0.2)):
        bend.factor = factor
        bend.keyframe_insert("factor", frame=frame)
    bpy.context.scene.frame_set(1)
    held = shown(back, ENDS[0])
    activate(cage)
    bake(11)
    for frame in (1, 6, 11):
        bpy.context.scene.frame_set(frame)
        there = shown(back, ENDS[1])
        np.testing.assert_allclose(along(cage, there - np.array(target.location)), 0.0, atol=1e-2)
        np.testing.assert_allclose(along(cage, shown(back, ENDS[0]) - held), 0.0, atol=1e-2)


def test_a_lattice_in_space_that_its_model_walks_through():
    """The lattice stands, and what it deforms is moved through it."""
    cage, sheet = solid()
    last = len(sheet.data.vertices) - 1
    pin_at(sheet, 0)
    pin_at(sheet, last)
    target = empty(shown(sheet, last))
    cage.planar.pins[1].follow = target
    x = sheet.location.x
    for frame, shift in ((1, 0.0), (7, 0.12)):
        sheet.location.x = x + shift
        sheet.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    activate(cage)
    bake(7)
    gaps = in_frames(lambda: np.linalg.norm(shown(sheet, last) - np.array(target.location)), 7)
    assert gaps.max() < 1e-2


def test_what_cannot_be_read_in_a_frame_is_refused_with_the_frame_and_all_is_as_it_was():
    cage, back, _target = aimed()
    finer = back.modifiers.new("Finer", "SUBSURF")
    back.modifiers.move(1, 0)
    for frame, on in ((1, False), (5, True)):
        finer.show_viewport = on
        finer.keyframe_insert("show_viewport", frame=frame)
    bpy.context.scene.frame_set(2)
    activate(cage)
    before = points(cage)
    with pytest.raises(RuntimeError, match="At frame 5: Modifier 'Finer' of 'Back' makes new vertices"):
        bpy.ops.planar.bake_pins(frame_start=1, frame_end=8)
    assert bpy.context.scene.frame_current == 2
    assert cage.data.shape_keys is None
    assert np.array_equal(points(cage), before)


def test_a_pin_that_was_dragged_before_goes_on_from_frame_to_frame():
    """Its stored target is where it was left by the drag: no frame starts from there again."""
    cage, back, target = aimed((0.0, 0.0, 0.0))
    bpy.ops.planar.drag_pins(pin=1, offset=(0.3, 0.3))
    assert cage.planar.pins[1].has_target
    swaying(target, 0.2)
    bake()
    gaps = in_frames(lambda: np.linalg.norm(along(cage, shown(back, 90) - np.array(target.location))))
    assert gaps.max() < 8e-3
    assert len(curve_of(cage).keyframe_points) == FRAMES
