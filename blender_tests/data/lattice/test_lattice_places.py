# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins of a lattice keep their places on its meshes when these are subdivided, cut, extended or thinned."""

import bmesh
import bpy
import numpy as np
import pytest
from lattice_scenes import TURNED, deform, lattice, points, seen, shown
from mathutils import Matrix
from pins.test_places import EDITS
from support import activate, coordinates, grid, in_edit_mode, make_object, world


def coarse(matrix=TURNED, bent=0.0, keys=False, finer=1):
    """A sheet of few quads, flat or bent in space, in a lattice with pins on both."""
    vertices, faces = grid(5 * finer, 2 * finer, 3.0, 1.0)
    vertices[:, 2] = bent * np.sin(2.0 * vertices[:, 0])
    sheet = make_object(vertices, faces.tolist(), name="Sheet")
    counts = (9, 8, 1) if not bent else (7, 6, 4)
    cage = lattice(counts, (4.4, 2.2, 2.0 if bent else 1.0), (1.5, 0.5, 0.0), matrix=matrix)
    sheet.matrix_world = matrix.copy()
    deform(sheet, cage)
    if keys:
        sheet.shape_key_add(name="Basis")
        key = sheet.shape_key_add(name="Shift")
        for point in key.data:
            point.co.y += 0.1
        key.value = 0.5
    activate(cage)
    column = slice(0, 5 * finer + 1)
    for x, y in ((0.2, 0.3), (1.37, 0.61), (2.9, 0.9), (0.0, 0.0), (3.0, 1.0)):
        place = (x, y + 0.05 * keys, np.interp(x, vertices[column, 0], vertices[column, 2]))
        at = world(sheet, np.array([place], np.float32))[0]
        assert bpy.ops.planar.add_pin(location=at.tolist()) == {"FINISHED"}
    group = sheet.vertex_groups.new(name="Hand")
    group.add([3, 4, 9, 10], 1.0, "REPLACE")
    assert bpy.ops.planar.add_pin_from_group(object="Sheet", group="Hand", kind="PATCH") == {"FINISHED"}
    assert bpy.ops.planar.add_pin(lattice_point=1) == {"FINISHED"}
    return cage, sheet


def places():
    bpy.context.view_layer.update()
    marks = seen()
    assert [mark.key for mark in marks.pins] == list(range(7)), "none is missing"
    return np.array([mark.place for mark in marks.pins])


def cut(obj):
    """Through the middle of everything, as by the knife and by bisecting."""

    def bisect():
        return bpy.ops.mesh.bisect(plane_co=obj.matrix_world.translation, plane_no=(0.3, 0.2, 1.0))

    in_edit_mode(obj, bisect)


def thinned(obj):
    activate(obj)
    obj.modifiers.new("Thin", "DECIMATE").ratio = 0.7
    bpy.ops.object.modifier_apply(modifier="Thin")


HOW = {name: EDITS[name] for name in EDITS if name != "subdivision modifier"} | {"cut": cut}


@pytest.mark.parametrize("bent", [0.0, 0.3])
@pytest.mark.parametrize("how", HOW)
def test_pins_stay_where_they_are_on_meshes_that_are_edited(how, bent):
    cage, sheet = coarse(bent=bent)
    before = places()
    HOW[how](sheet)
    activate(cage)
    corners = 3 if "thinned" in how else 5  # corners may be among what is thinned out
    # A finer mesh is bent where the coarse one was straight between its vertices: none is, unposed.
    assert places()[:corners] == pytest.approx(before[:corners], abs=1e-4 if not bent else 1e-3)
    assert places()[6] == pytest.approx(before[6], abs=1e-6)
    if "thinned" not in how:
        assert places()[5] == pytest.approx(before[5], abs=0.1)
    shape = points(cage)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(1e-5, 0.0)) == {"FINISHED"}
    assert np.abs(points(cage) - shape).max() < 2e-2


@pytest.mark.parametrize("transform", [Matrix(), TURNED])
def test_pins_of_a_posed_lattice_stay_and_the_pose_does(transform):
    cage, sheet = coarse(transform, finer=4)
    bpy.ops.planar.drag_pins(pin=2, offset=(0.1, 0.2))
    before, shape = places(), points(cage)
    HOW["subdivided"](sheet)
    activate(cage)
    np.testing.assert_array_equal(points(cage), shape)
    assert places()[[0, 1, 2, 3, 4, 6]] == pytest.approx(before[[0, 1, 2, 3, 4, 6]], abs=0.03)
    bpy.ops.planar.drag_pins(pin=2, offset=(0.05, 0.0))
    assert places()[:2] == pytest.approx(before[:2], abs=0.03)


def test_each_point_is_held_by_three_vertices_at_most_in_a_group_that_is_as_before():
    cage, sheet = coarse()
    names = [pin.group for pin in cage.planar.pins]
    HOW["subdivided"](sheet)
    activate(cage)
    assert [pin.group for pin in cage.planar.pins] == names
    for name in names[:5]:
        index = sheet.vertex_groups[name].index
        held = [vertex for vertex in sheet.data.vertices if any(g.group == index for g in vertex.groups)]
        assert 1 <= len(held) <= 3


def test_shape_keys_of_the_mesh_do_not_matter():
    cage, sheet = coarse(keys=True)
    before = places()
    HOW["subdivided"](sheet)
    activate(cage)
    assert places()[:5] == pytest.approx(before[:5], abs=1e-4)


def test_a_pin_whose_vertices_are_deleted_goes_with_them_and_others_stay():
    cage, sheet = coarse()
    before = places()
    in_edit_mode(
        sheet, lambda: bpy.ops.mesh.delete(type="VERT"), select=lambda vertex: vertex.index in {11, 17}
    )
    activate(cage)
    marks = seen()
    for key in (0, 1, 3):
        assert marks.pin(key).place == pytest.approx(before[key], abs=1e-4)
    assert marks.pin(4) is None, "the corner is gone"
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.05, 0.0)) == {"FINISHED"}


def test_moving_vertices_moves_their_pins():
    cage, sheet = coarse()
    before = places()
    in_edit_mode(sheet, lambda: bpy.ops.transform.translate(value=(0.4, 0.0, 0.2)))
    activate(cage)
    assert places()[:6] == pytest.approx(before[:6] + np.array((0.4, 0.0, 0.2)), abs=1e-4)
    moved = places()
    HOW["subdivided"](sheet)
    activate(cage)
    assert places()[:5] == pytest.approx(moved[:5], abs=1e-4)


def test_a_mesh_with_pins_of_its_own_keeps_both():
    cage, sheet = coarse()
    activate(sheet)
    own = world(sheet, np.array([(0.7, 0.4, 0.0)], np.float32))[0]
    assert bpy.ops.planar.add_pin(location=own.tolist()) == {"FINISHED"}
    activate(cage)
    before = places()
    HOW["subdivided"](sheet)
    activate(cage)
    assert places()[:5] == pytest.approx(before[:5], abs=1e-4)
    activate(sheet)
    assert seen().pin(0).place == pytest.approx(own, abs=1e-4)


def test_a_group_that_the_mesh_has_a_pin_of_its_own_on_is_left_to_that():
    cage, sheet = coarse()
    name = cage.planar.pins[1].group
    activate(sheet)
    assert bpy.ops.planar.add_pin_from_group(group=name, kind="POINT") == {"FINISHED"}
    activate(cage)
    before = places()
    HOW["subdivided"](sheet)
    activate(cage)
    assert places()[1] == pytest.approx(before[1], abs=1e-4)
    activate(sheet)
    assert seen().pin(0).place == pytest.approx(before[1], abs=1e-4)
    assert name in sheet.vertex_groups, "it is the user's"


def test_edits_from_scripts_are_followed_with_the_next_update():
    cage, sheet = coarse()
    before = places()
    mesh = bmesh.new()
    mesh.from_mesh(sheet.data)
    bmesh.ops.subdivide_edges(mesh, edges=mesh.edges[:], cuts=2, use_grid_fill=True)
    mesh.to_mesh(sheet.data)
    mesh.free()
    sheet.data.update()
    activate(cage)
    assert places()[:5] == pytest.approx(before[:5], abs=1e-4)
    assert shown(sheet, 0) == pytest.approx(before[3], abs=1e-4)
    assert len(coordinates(sheet.data.vertices)) > 18
