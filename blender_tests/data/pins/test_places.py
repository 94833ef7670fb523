# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins keep their places on the drawing when its mesh is subdivided, decimated, extended or cut."""

import bpy
import numpy as np
import pytest
from drawings import character, outline, text
from sequences import filled, shown_at
from support import (
    activate,
    add_pins,
    bar,
    coordinates,
    grid,
    in_edit_mode,
    make_object,
    measured,
    pose,
    world,
)


def coarse(turned=True):
    """A drawing of few quads, turned and scaled as if imported, with pins within its faces, and a patch."""
    vertices, faces = grid(5, 2, 3.0, 1.0)
    obj = make_object(vertices, faces.tolist(), name="Coarse")
    if turned:
        obj.rotation_euler, obj.scale = (np.pi / 2, 0.0, 0.0), (0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    for place in ((0.2, 0.3, 0.0), (1.37, 0.61, 0.0), (2.9, 0.9, 0.0)):
        in_world = world(obj, np.array([place], np.float32))[0]
        assert bpy.ops.planar.add_pin(location=in_world) == {"FINISHED"}
    add_pins(obj, [0], [17])
    add_pins(obj, [3, 4, 9, 10], kind="PATCH")
    return obj


def shape_of(obj):
    from planar_deform.scene.view import snapshot

    activate(obj)
    snapshot.forget()
    return snapshot.of_active(bpy.context)


def places(obj):
    """Where the pins are at rest, in the world; none is missing."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    drawing = begin(bpy.context)
    pins = pin_list.model_pins(obj, drawing)
    assert [pin.key for pin in pins] == list(range(len(obj.planar.pins)))
    return np.array([Holder(pin, drawing.cutout).place(drawing.cutout.rest) for pin in pins])


def modifier(kind, **settings):
    def run(obj):
        added = obj.modifiers.new("Edit", kind)
        for name, value in settings.items():
            setattr(added, name, value)
        bpy.ops.object.modifier_apply(modifier="Edit")

    return run


def subdivided(obj):
    in_edit_mode(obj, lambda: bpy.ops.mesh.subdivide(number_cuts=3))


EDITS = {
    "subdivided": subdivided,
    "subdivided twice": lambda obj: (subdivided(obj), subdivided(obj)),
    "subdivided in part": lambda obj: in_edit_mode(
        obj, lambda: bpy.ops.mesh.subdivide(), select=lambda vertex: vertex.co.x > 1.0
    ),
    "subdivided and thinned": lambda obj: (
        subdivided(obj),
        in_edit_mode(obj, lambda: bpy.ops.mesh.decimate(ratio=0.5)),
    ),
    "triangulated and poked": lambda obj: in_edit_mode(
        obj, lambda: bpy.ops.mesh.quads_convert_to_tris(), lambda: bpy.ops.mesh.poke()
    ),
    "subdivision modifier": modifier("SUBSURF", subdivision_type="SIMPLE", levels=2),
    "extruded beside": lambda obj: in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.1, 0.0, 0.0)}),
        select=lambda vertex: vertex.index % 6 == 5,
    ),
}


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("how", EDITS)
@pytest.mark.parametrize("bent", [False, True])
def test_pins_keep_their_places_on_a_coarse_drawing(how, turned, bent):
    obj = coarse(turned)
    if bent:
        pose(obj, offset=(-0.1, 0.15), moving=[2])
    before, shown = places(obj), np.array([pin.place for pin in shape_of(obj).pins])
    EDITS[how](obj)
    points = slice(0, 3 if "thinned" in how else 5)  # corners may be among what is thinned out
    assert places(obj)[points] == pytest.approx(before[points], abs=1e-4)
    now = np.array([pin.place for pin in shape_of(obj).pins])
    # Blender bends what was the flat half of a face where it subdivides a bent one.
    assert now[points] == pytest.approx(shown[points], abs=0.05 if bent else 1e-4)
    # The middle of the patch's vertices, of which thinning leaves a few, on which side is chance.
    assert places(obj)[5] == pytest.approx(before[5], abs=0.2 if "thinned" in how else 0.1)
    shape = world(obj)
    assert bpy.ops.planar.drag_pins(offset=(1e-5, 0.0)) == {"FINISHED"}
    if not bent:  # a finer drawing bends more softly than a coarse one
        assert np.abs(world(obj) - shape).max() < 1e-3
    assert measured(obj).flipped == 0


def test_a_point_in_a_face_stays_a_point_of_three_vertices_and_one_on_a_vertex_stays_there():
    obj = coarse()
    subdivided(obj)
    for index, count in enumerate((3, 3, 3, 1, 1)):
        group = obj.vertex_groups[obj.planar.pins[index].group].index
        members = [v.index for v in obj.data.vertices if any(g.group == group for g in v.groups)]
        assert len(members) <= count
    assert [pin.name for pin in obj.planar.pins] == ["Pin"] + [f"Pin.{i:03d}" for i in range(1, 6)]


def test_a_subdivided_patch_holds_the_vertices_within_it():
    obj = coarse()
    subdivided(obj)
    group = obj.vertex_groups[obj.planar.pins[5].group].index
    members = [v.co for v in obj.data.vertices if any(g.group == group for g in v.groups)]
    assert len(members) == 25
    low, high = np.min(members, axis=0), np.max(members, axis=0)
    assert (low[:2], high[:2]) == (pytest.approx([1.8, 0.0]), pytest.approx([2.4, 0.5]))


@pytest.mark.parametrize("make", [character, outline, text])
def test_real_drawings_are_thinned_and_refined(make):
    obj = make()
    size = np.ptp(world(obj), axis=0).max()
    rng = np.random.default_rng(1)
    seen = shape_of_faces(obj)
    for triangle in rng.choice(len(seen), 6, replace=False):
        bpy.ops.planar.add_pin(location=seen[triangle].mean(axis=0), extend=True)
    assert len(obj.planar.pins) == 6
    before = places(obj)
    if make is outline:
        in_edit_mode(obj, lambda: bpy.ops.mesh.quads_convert_to_tris())
    subdivided(obj)
    assert places(obj) == pytest.approx(before, abs=1e-5 * size)
    modifier("DECIMATE", ratio=0.3)(obj)
    assert places(obj) == pytest.approx(before, abs=1e-2 * size if make is text else 2e-3 * size)
    assert bpy.ops.planar.drag_pins(offset=(1e-3 * size, 0.0)) == {"FINISHED"}


def shape_of_faces(obj):
    obj.data.calc_loop_triangles()
    rows = np.array([triangle.vertices for triangle in obj.data.loop_triangles])
    return world(obj)[rows]


def test_targets_that_were_not_reached_are_kept():
    obj = coarse()
    obj.planar.pins[2].weight = 0.01
    obj.planar.pins[4].weight = 1.0
    pose(obj, offset=(0.3, 0.3), moving=[2])
    seen = shape_of(obj).pins
    gaps = [np.linalg.norm(pin.place - pin.target) for pin in seen]
    assert gaps[2] > 0.01
    subdivided(obj)
    now = [np.linalg.norm(pin.place - pin.target) for pin in shape_of(obj).pins]
    assert now[:5] == pytest.approx(gaps[:5], abs=0.01)


def test_what_is_cut_off_takes_its_pins_away_and_leaves_the_others():
    obj = bar()
    bpy.ops.planar.add_pin(location=(0.3, 0.4, 0.0))
    bpy.ops.planar.add_pin(location=(1.7, 0.4, 0.0))
    before = places(obj)
    in_edit_mode(obj, lambda: bpy.ops.mesh.delete(type="VERT"), select=lambda vertex: vertex.co.x > 1.4)
    pins = shape_of(obj).pins
    assert [pin.key for pin in pins] == [0]
    assert pins[0].place[:2] == pytest.approx(before[0], abs=1e-5)


def test_vertices_of_a_pin_that_are_dissolved_leave_it_in_its_place():
    obj = bar(triangles=True)
    add_pins(obj, [20], [33])
    bpy.ops.planar.add_pin(location=(1.51, 0.55, 0.0))
    before = places(obj)
    in_edit_mode(
        obj, lambda: bpy.ops.mesh.dissolve_verts(), select=lambda vertex: vertex.index in (20, 33, 35, 36)
    )
    assert len(obj.data.vertices) == 61
    assert places(obj) == pytest.approx(before, abs=1e-4)


def test_weights_that_the_user_changes_move_the_pin_as_ever():
    obj = bar()
    add_pins(obj, [20])
    bpy.context.view_layer.update()
    group = obj.vertex_groups[obj.planar.pins[0].group]
    group.remove([20])
    group.add([30], 1.0, "REPLACE")
    obj.data.update()
    bpy.context.view_layer.update()
    rest = coordinates(obj.data.vertices)[30, :2]
    assert places(obj)[0] == pytest.approx(rest, abs=1e-6)
    subdivided(obj)
    assert places(obj)[0] == pytest.approx(rest, abs=1e-5)


def test_a_group_of_the_user_is_left_as_blender_makes_it():
    obj = coarse()
    obj.vertex_groups.new(name="Mine").add([7, 8, 13], 1.0, "REPLACE")
    bpy.ops.planar.add_pin_from_group(group="Mine")
    before = places(obj)
    subdivided(obj)
    assert places(obj)[:5] == pytest.approx(before[:5], abs=1e-4)
    assert places(obj)[6] == pytest.approx(before[6], abs=1e-4)
    group = obj.vertex_groups["Mine"].index
    assert sum(any(g.group == group for g in v.groups) for v in obj.data.vertices) > 3
    assert obj.planar.pins[6].name == "Mine"


def test_the_drawing_with_keyed_poses_is_subdivided():
    obj = filled()
    bpy.ops.planar.add_pin(location=(1.02, 0.44, 0.0))
    before = places(obj)
    shown = {frame: np.ptp(shown_at(obj, frame), axis=0) for frame in (1, 7, 13, 25)}
    subdivided(obj)
    assert places(obj) == pytest.approx(before, abs=1e-4)
    for frame, extent in shown.items():
        assert np.ptp(shown_at(obj, frame), axis=0) == pytest.approx(extent, abs=1e-4)


def test_undone_and_redone():
    coarse()
    bpy.ops.ed.undo_push(message="Start")
    obj = bpy.data.objects["Coarse"]
    before, count = places(obj), len(obj.data.vertices)
    subdivided(obj)
    bpy.ops.ed.undo_push(message="Subdivide")
    for _ in range(2):
        obj = bpy.data.objects["Coarse"]
        assert len(obj.data.vertices) > count
        assert places(obj) == pytest.approx(before, abs=1e-4)
        while len(bpy.data.objects["Coarse"].data.vertices) > count:
            bpy.ops.ed.undo()
        obj = bpy.data.objects["Coarse"]
        bpy.context.view_layer.update()
        assert places(obj) == pytest.approx(before, abs=1e-4)
        while (
            len(bpy.data.objects["Coarse"].data.vertices) == count
            or bpy.data.objects["Coarse"].mode != "OBJECT"
        ):
            bpy.ops.ed.redo()
