# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings that are transformed as a whole after they were pinned and posed: rest shape and pins follow."""

import bmesh
import bpy
import numpy as np
import pytest
from drawings import DRAWINGS, extremes
from sequences import filled, go_to, shown_at
from support import activate, add_end_pins, add_pins, bar, coordinates, measured, pose, world


def posed(kind):
    """A drawing from elsewhere, posed by three pins, one of which does not reach its target."""
    obj = DRAWINGS[kind]()
    left, middle, right = extremes(obj)
    add_pins(obj, [left], [middle], [right], [right])
    size = np.ptp(world(obj), axis=0).max()
    obj.planar.pins[2].weight = 0.2
    pose(obj, offset=(-0.1 * size, 0.2 * size), moving=[3])
    return obj


def rest_in_world(obj):
    return world(obj, coordinates(obj.data.attributes["planar_rest"].data, "vector"))


def pins_in_world(obj):
    """Where the pins are and where they were asked to be."""
    from planar_deform.scene.view import snapshot

    activate(obj)
    snapshot.forget()
    pins = snapshot.of_active(bpy.context).pins
    return np.array([pin.place for pin in pins]), np.array([pin.target for pin in pins])


def in_edit_mode(*steps):
    def run(obj):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        for step in steps:
            assert step() == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")

    return run


def mirrored_and_applied(obj):
    obj.scale.x *= -1.0
    bpy.context.view_layer.update()
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)


KEEPS_PLACE = {  # what the drawing is in the world stays the same
    "scale": lambda obj: bpy.ops.object.transform_apply(location=False, rotation=False, scale=True),
    "rotation": lambda obj: bpy.ops.object.transform_apply(location=False, rotation=True, scale=False),
    "all transforms": lambda obj: bpy.ops.object.transform_apply(),
    "origin to geometry": lambda obj: bpy.ops.object.origin_set(type="ORIGIN_GEOMETRY"),
    "origin to cursor": lambda obj: bpy.ops.object.origin_set(type="ORIGIN_CURSOR"),
    "scale, then origin": lambda obj: (
        bpy.ops.object.transform_apply(location=False, rotation=False, scale=True),
        bpy.ops.object.origin_set(type="ORIGIN_GEOMETRY"),
    ),
}
MOVES = {
    "mirrored by scale": mirrored_and_applied,
    "turned in Edit Mode": in_edit_mode(lambda: bpy.ops.transform.rotate(value=0.7, orient_axis="Y")),
    "scaled in Edit Mode": in_edit_mode(lambda: bpy.ops.transform.resize(value=(3.0, 3.0, 3.0))),
    "moved in Edit Mode": in_edit_mode(lambda: bpy.ops.transform.translate(value=(1.0, 0.0, 2.0))),
    "all in Edit Mode": in_edit_mode(
        lambda: bpy.ops.transform.rotate(value=0.7, orient_axis="Y"),
        lambda: bpy.ops.transform.resize(value=(0.5, 0.5, 0.5)),
        lambda: bpy.ops.transform.translate(value=(1.0, 0.0, 2.0)),
        lambda: bpy.ops.transform.mirror(constraint_axis=(True, False, False)),
    ),
}


def goes_on(obj, before, shape):
    """Posed on from where it is, nothing jumps; the pose taken away, the drawing is undistorted."""
    size = np.ptp(shape, axis=0).max()
    assert bpy.ops.planar.drag_pins(offset=(1e-4 * size, 0.0)) == {"FINISHED"}
    assert np.abs(world(obj) - shape).max() < 0.02 * size
    assert measured(obj).area == pytest.approx(before, rel=1e-2)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert measured(obj).area == pytest.approx(2.0, abs=1e-6)
    assert world(obj) == pytest.approx(rest_in_world(obj), abs=1e-5 * size)


@pytest.mark.parametrize("kind", DRAWINGS)
@pytest.mark.parametrize("how", KEEPS_PLACE)
def test_what_is_applied_changes_nothing_of_what_is_seen_and_posed(kind, how):
    obj = posed(kind)
    area, shape, rest, pins = measured(obj).area, world(obj), rest_in_world(obj), pins_in_world(obj)
    size = np.ptp(shape, axis=0).max()
    assert np.abs(pins[0] - pins[1]).max() > 1e-3 * size
    KEEPS_PLACE[how](obj)
    assert world(obj) == pytest.approx(shape, abs=1e-5 * size)
    assert measured(obj).area == pytest.approx(area, abs=1e-4)
    assert rest_in_world(obj) == pytest.approx(rest, abs=1e-5 * size)
    assert np.array(pins_in_world(obj)) == pytest.approx(np.array(pins), abs=1e-4 * size)
    goes_on(obj, area, shape)


@pytest.mark.parametrize("kind", DRAWINGS)
@pytest.mark.parametrize("how", MOVES)
def test_what_takes_all_vertices_along_takes_rest_and_pins_along(kind, how):
    obj = posed(kind)
    area, shape, pins = measured(obj).area, world(obj), np.array(pins_in_world(obj))
    gaps = np.linalg.norm(pins[0] - pins[1], axis=1)
    MOVES[how](obj)
    moved = world(obj)
    scale = np.ptp(moved[:, 1:]) / np.ptp(shape[:, 1:]) if "Edit" not in how else None
    assert not np.allclose(moved, shape, atol=1e-3)
    assert measured(obj).area == pytest.approx(area, abs=1e-4)
    assert measured(obj).flipped == 0
    now = np.array(pins_in_world(obj))
    grown = {"scaled in Edit Mode": 3.0, "all in Edit Mode": 0.5}.get(how, 1.0)
    assert np.linalg.norm(now[0] - now[1], axis=1) == pytest.approx(grown * gaps, abs=1e-4 * scale_of(moved))
    assert scale is None or scale > 0.0
    goes_on(obj, area, moved)


def scale_of(shape):
    return np.ptp(shape, axis=0).max()


@pytest.mark.parametrize("turn", [0.9, 3.0 * np.pi])
def test_a_turned_patch_keeps_its_turn(turn):
    obj = bar()
    add_end_pins(obj, kind="PATCH")
    for _ in range(4):
        pose(obj, angle=turn / 4)
    shape = world(obj)
    pose(obj, offset=(0.0, 0.0))
    drift = np.abs(world(obj) - shape).max() * 2.0  # in the size that it gets
    obj.data.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    obj.data.update()
    obj.scale = (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    bpy.ops.object.transform_apply()
    assert obj.planar.pins[1].angle == pytest.approx(turn)
    obj.scale.x = -1.0
    bpy.context.view_layer.update()
    bpy.ops.object.transform_apply()
    assert obj.planar.pins[1].angle == pytest.approx(-turn)
    shape = world(obj)
    pose(obj, offset=(0.0, 0.0))
    assert np.abs(world(obj) - shape).max() < max(1.1 * drift, 1e-3)


def test_applied_in_a_chain_and_with_edits_of_some_vertices_between():
    obj = bar(plane="XZ")
    obj.scale = (2.0, 2.0, 2.0)
    add_end_pins(obj)
    pose(obj, offset=(-0.4, 1.2))
    for step in range(4):
        obj.scale = (1.5, 1.0, 0.5)
        obj.rotation_euler = (0.3, 0.2, 0.1 * step)
        bpy.context.view_layer.update()
        area = measured(obj).area
        bpy.ops.object.transform_apply()
        assert measured(obj).area == pytest.approx(area, abs=1e-4)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide() if step == 1 else bpy.ops.transform.resize(value=(1.1, 1.1, 1.1))
        bpy.ops.object.mode_set(mode="OBJECT")
        assert measured(obj).area == pytest.approx(area, abs=1e-3)


def test_an_extrusion_and_a_scaling_in_one_stay_in_edit_mode():
    obj = bar()
    add_end_pins(obj)
    pose(obj, offset=(-0.2, 0.6))
    area = measured(obj).area
    rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for row in range(5):
        obj.data.vertices[12 + 13 * row].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.2, 0.1, 0.0)})
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.resize(value=(4.0, 4.0, 4.0), center_override=(0, 0, 0))
    bpy.ops.object.mode_set(mode="OBJECT")
    now = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    assert now[:65] == pytest.approx(4.0 * rest, abs=1e-5)
    assert measured(obj).area == pytest.approx(area, abs=0.2)


def test_an_edit_of_some_vertices_is_a_pose_as_ever():
    obj = bar()
    add_end_pins(obj)
    rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    for vertex in bmesh.from_edit_mesh(obj.data).verts:
        vertex.select_set(vertex.index % 13 > 3)  # two thirds of them
    bpy.ops.transform.translate(value=(0.5, 0.2, 0.0))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.array_equal(coordinates(obj.data.attributes["planar_rest"].data, "vector"), rest)
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(coordinates(obj.data.vertices), rest)


def test_a_pose_that_moves_all_alike_is_a_pose():
    """One pin takes the drawing along as a whole, which no edit did: Reset brings it back."""
    obj = bar()
    before = coordinates(obj.data.vertices)
    add_pins(obj, [20])
    assert bpy.ops.planar.drag_pins(offset=(0.7, 0.3)) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert np.array_equal(coordinates(obj.data.vertices), before)


def test_keyed_poses_and_inbetweens_stay_what_they_are():
    obj = filled()
    frames = (1, 5, 13, 20, 25)
    obj.scale = (2.0, 2.0, 2.0)
    obj.rotation_euler = (np.pi / 2, 0.0, 0.3)
    bpy.context.view_layer.update()
    shapes = [world(obj, shown_at(obj, frame)) for frame in frames]
    areas = [(go_to(frame), measured(obj).area)[1] for frame in frames]
    go_to(13)
    before = pins_in_world(obj)
    bpy.ops.object.transform_apply()
    assert pins_in_world(obj)[1] == pytest.approx(before[1], abs=1e-4)
    for frame, shape, area in zip(frames, shapes, areas, strict=True):
        assert world(obj, shown_at(obj, frame)) == pytest.approx(shape, abs=1e-5)
        assert measured(obj).area == pytest.approx(area, abs=1e-4)
    # The rest that the mesh gets back with the end of the sequence has followed, too.
    bpy.ops.planar.clear_poses()
    assert measured(obj).area == pytest.approx(2.0, abs=1e-4)
    bpy.ops.planar.reset_to_rest()
    assert np.ptp(world(obj), axis=0).max() == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize("how", ["all transforms", "origin to geometry"])
def test_inbetweens_stay_up_to_date_and_those_that_were_not_do_not_get_so(how):
    from planar_deform.scene.sequence.stretches import stale

    obj = filled()
    obj.scale = (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    assert stale(obj) == []
    KEEPS_PLACE[how](obj)
    assert stale(obj) == []
    go_to(25)
    pose(obj, offset=(0.3, 0.3))
    bpy.ops.planar.key_pose()
    bpy.context.view_layer.update()
    assert stale(obj) == [(1, 2)]
    obj.scale = (0.5, 0.5, 0.5)
    obj.location = (1.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    KEEPS_PLACE[how](obj)
    assert stale(obj) == [(1, 2)]


def test_a_duplicate_is_applied_alone():
    obj = posed("outline")
    shape, area = world(obj), measured(obj).area
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    bpy.ops.object.transform_apply()
    assert measured(twin).area == pytest.approx(area, abs=1e-4)
    goes_on(twin, area, shape)
    assert world(obj) == pytest.approx(shape)
    assert measured(obj).area == pytest.approx(area, abs=1e-6)


def test_undone_and_redone():
    posed("outline")
    bpy.ops.ed.undo_push(message="Start")

    def state():
        obj = bpy.data.objects["Outline"]
        return obj.scale.x, measured(obj).area, world(obj), rest_in_world(obj), *pins_in_world(obj)

    def same(a, b):
        return all(np.allclose(x, y, atol=1e-4) for x, y in zip(a, b, strict=True))

    before = state()
    bpy.ops.object.transform_apply()
    bpy.ops.ed.undo_push(message="Apply")
    after = state()
    assert after[0] == 1.0
    bpy.ops.planar.drag_pins(offset=(0.01, 0.0))
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()
    assert same(state(), after)
    bpy.ops.ed.undo()
    assert same(state(), before)
    bpy.ops.ed.redo()
    assert same(state(), after)
    bpy.ops.ed.undo()
    assert same(state(), before)
    goes_on(bpy.data.objects["Outline"], before[1], before[2])
