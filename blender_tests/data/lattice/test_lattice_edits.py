# SPDX-License-Identifier: GPL-3.0-or-later
"""Transforms applied to a lattice, and origins set, leave what it deforms and its keys as they were."""

import bpy
import numpy as np
import pytest
from filling import stale
from lattice_poses import keyed, shown_at
from lattice_scenes import TURNED, layered, pin_at, points, seen, shown, solid
from support import activate, evaluated, grid, make_object, world

APPLIED = {
    "all": lambda: bpy.ops.object.transform_apply(),
    "rotation": lambda: bpy.ops.object.transform_apply(location=False, rotation=True, scale=False),
    "scale": lambda: bpy.ops.object.transform_apply(location=False, rotation=False, scale=True),
    "origin": lambda: bpy.ops.object.origin_set(type="ORIGIN_CURSOR"),
}


def all_shown(*objects):
    return [world(obj, evaluated(obj)) for obj in objects]


def assert_shown(objects, before):
    for obj, places in zip(objects, before, strict=True):
        np.testing.assert_allclose(world(obj, evaluated(obj)), places, atol=2e-5)


def drag(vertex_pins, *, offset):
    for obj, vertex in vertex_pins:
        pin_at(obj, vertex)
    assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}


@pytest.mark.parametrize("how", APPLIED)
@pytest.mark.parametrize("posed", [False, True])
def test_applied_to_a_lattice_nothing_that_it_deforms_jumps(how, posed):
    cage, back, front = layered()
    drag(((back, 0), (front, 48)), offset=(0.4, 0.3) if posed else (0.0, 0.0))
    before, matrix, pose = all_shown(back, front), np.array(cage.matrix_world), points(cage)
    assert APPLIED[how]() == {"FINISHED"}
    assert_shown((back, front), before)
    np.testing.assert_allclose(np.array(cage.matrix_world), matrix, atol=1e-5)
    np.testing.assert_allclose(points(cage), pose, atol=1e-5)
    # It is posed on as if nothing had been.
    assert bpy.ops.planar.drag_pins(offset=(-0.2, 0.1)) == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    np.testing.assert_allclose(all_shown(back), [world(back)], atol=2e-5)


def test_a_lattice_in_space_keeps_its_pose_and_its_pins():
    cage, sheet = solid()
    drag(((sheet, 0), (sheet, 65)), offset=(0.3, 0.2))
    before, pins = all_shown(sheet), [pin.place for pin in seen().pins]
    bpy.ops.object.transform_apply()
    assert_shown((sheet,), before)
    np.testing.assert_allclose([pin.place for pin in seen().pins], pins, atol=2e-5)
    assert cage.scale.x == pytest.approx(3.6 * 0.7, rel=1e-5)


def test_applied_together_the_drawings_get_theirs_and_the_lattice_keeps_its():
    cage, back, front = layered()
    drag(((back, 0), (front, 48)), offset=(0.4, 0.3))
    before = all_shown(back, front)
    for obj in (back, front):
        obj.select_set(True)
    bpy.ops.object.transform_apply()
    assert_shown((back, front), before)
    np.testing.assert_allclose(np.array(back.matrix_world), np.eye(4), atol=1e-6)
    assert cage.scale.x == pytest.approx(3.6 * 0.7, rel=1e-5)


def test_children_of_the_lattice_stay():
    cage, back, front = layered()
    drag(((back, 0), (front, 48)), offset=(0.4, 0.3))
    for obj in (back, front):
        obj.parent, obj.matrix_parent_inverse = cage, cage.matrix_world.inverted()
    before = all_shown(back, front)
    bpy.ops.object.transform_apply()
    assert_shown((back, front), before)
    cage.location.x += 1.0
    bpy.context.view_layer.update()
    assert_shown((back, front), [places + np.eye(3)[0] for places in before])


def test_keyed_poses_and_their_in_betweens_stay():
    cage, back, front = layered()
    keyed(cage, (back, front), {1: 0.4, 9: 1.2})
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    frames = (1, 4, 9)
    before = {frame: shown_at((back, front), frame) for frame in frames}
    bpy.context.view_layer.update()
    bpy.ops.object.transform_apply()
    bpy.context.view_layer.update()
    for frame in frames:
        for after, places in zip(shown_at((back, front), frame), before[frame], strict=True):
            np.testing.assert_allclose(after, places, atol=2e-5)
    assert stale(cage) == []


def test_undone_and_redone():
    _, back, front = layered()
    drag(((back, 0), (front, 48)), offset=(0.4, 0.3))
    before = all_shown(back, front)
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.object.transform_apply()
    bpy.ops.ed.undo_push(message="Apply")
    bpy.context.view_layer.update()
    bpy.context.object.planar.pins[0].name = "Renamed"
    bpy.ops.ed.undo_push(message="Rename")
    for step in (bpy.ops.ed.undo, bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.redo):
        step()
        assert_shown([bpy.data.objects[name] for name in ("Back", "Front")], before)


def test_what_only_moves_or_is_only_edited_is_left_alone():
    cage, back, front = layered()
    drag(((back, 0), (front, 48)), offset=(0.4, 0.3))
    pose = points(cage)
    cage.scale = (2.0, 2.0, 5.0)
    cage.location.x += 1.0
    bpy.context.view_layer.update()
    assert np.array_equal(points(cage), pose)
    assert tuple(cage.scale) == (2.0, 2.0, 5.0)
    cage.data.points.foreach_set("co_deform", (2.0 * pose).ravel())
    cage.data.update_tag()
    bpy.context.view_layer.update()
    assert np.array_equal(points(cage), 2.0 * pose)
    assert tuple(cage.scale) == (2.0, 2.0, 5.0)


def test_just_fitted_a_lattice_keeps_its_transform_as_well():
    obj = make_object(*grid(8, 6))
    obj.matrix_world = TURNED
    activate(obj)
    bpy.ops.planar.fit_lattice()
    before = all_shown(obj)
    bpy.ops.object.transform_apply()
    assert_shown((obj,), before)
    assert bpy.context.object.scale.x > 0.0
    assert shown(obj, 0) == pytest.approx(before[0][0], abs=2e-5)
