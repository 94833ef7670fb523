# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatten: flat meshes true to scale, UV maps, seams, and what cannot be laid flat."""

import bmesh
import bpy
import numpy as np
import pytest
from support import TRANSFORMS, activate, coordinates, make_object, world
from surfaces import (
    all_of,
    cap,
    cube,
    flatten,
    mark,
    numbers,
    signed_area,
    stretches,
    surface_vertices,
    tube,
    uv_ratios,
    uvs,
)

from planar_deform.compat import uv_pins

RIGID = ("none", "rotated", "mirrored", "tiny", "huge and far")


def select_faces(obj, wanted):
    """In Edit Mode."""
    activate(obj)
    obj.data.polygons.foreach_set("select", [face.index in wanted for face in obj.data.polygons])
    held = {vertex for face in obj.data.polygons if face.select for vertex in face.vertices}
    obj.data.vertices.foreach_set("select", [vertex.index in held for vertex in obj.data.vertices])
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    bpy.ops.object.mode_set(mode="EDIT")


@pytest.mark.parametrize("transform", [name for name in TRANSFORMS if name != "sheared"])
def test_what_can_be_unrolled_is_flat_with_its_edges_as_long_as_they_are_seen(transform):
    obj = tube()
    # Scaled unevenly a tube is a tube still, but its quads in triangles have the lengths.
    obj.matrix_world = TRANSFORMS[transform]
    flat = flatten(obj)
    assert np.abs(stretches(obj, flat) - 1.0).max() < 2e-6 * max(
        1.0, np.abs(world(obj)).max() / np.ptp(world(obj))
    )
    assert tuple(flat.scale) == (1.0, 1.0, 1.0)
    assert np.ptp(coordinates(flat.data.vertices)[:, 1]) == 0.0
    assert len(flat.data.vertices) == len(obj.data.vertices) + 7, "the seam has two sides"


@pytest.mark.parametrize("transform", ["none", "rotated", "mirrored"])
def test_it_faces_the_front_and_reads_as_the_outside_does(transform):
    obj = tube()
    obj.matrix_world = TRANSFORMS[transform]
    flat = flatten(obj)
    assert all(face.normal.y < -0.999 for face in flat.data.polygons)
    # A quad's corners, as seen: up along the tube and on around it, from outside.
    places = world(obj)
    face = obj.data.polygons[30]
    corner = {v: i for i, v in enumerate(surface_vertices(flat)) if v in face.vertices}
    here = world(flat)[[corner[v] for v in face.vertices]][:, [0, 2]]
    middle = places[list(face.vertices)].mean(axis=0)
    axis = np.array(obj.matrix_world.to_3x3()) @ (0.0, 0.0, 1.0)
    outward = middle - np.array(obj.matrix_world.translation)
    outward -= axis * (outward @ axis) / (axis @ axis)
    there = places[list(face.vertices)]
    normal = np.cross(there[1] - there[0], there[2] - there[1])
    assert np.sign(signed_area(here)) == np.sign(normal @ outward)


def test_ngons_materials_uv_maps_and_shares_of_them_come_along():
    obj = cap()
    for name in ("Skin", "Eye"):
        obj.data.materials.append(bpy.data.materials.new(name))
    obj.data.polygons[0].material_index = 1
    for name in ("First", "Second"):
        obj.data.uv_layers.new(name=name)
    random = np.random.default_rng(3).random((len(obj.data.loops), 2)).astype(np.float32)
    obj.data.uv_layers["Second"].uv.foreach_set("vector", random.ravel())
    obj.data.uv_layers["Second"].active_render = True
    obj.data.uv_layers.active_index = 1
    flat = flatten(obj)
    assert [slot.name for slot in flat.material_slots] == ["Skin", "Eye"]
    assert [face.material_index for face in flat.data.polygons] == [1] + [0] * (len(flat.data.polygons) - 1)
    assert len(flat.data.polygons[0].vertices) == 24
    assert [layer.name for layer in flat.data.uv_layers] == ["First", "Second"]
    assert flat.data.uv_layers.active.name == "Second"
    assert flat.data.uv_layers["Second"].active_render
    corners = numbers(flat.data, "planar_surface_corner") - 1
    assert np.array_equal(uvs(flat), random[corners])
    assert 0.85 < stretches(obj, flat).min() < stretches(obj, flat).max() < 1.15


def test_patches_lie_side_by_side_right_of_the_surface_and_do_not_overlap():
    obj = cube()
    obj.location = (3.0, 1.0, -2.0)
    flat = flatten(obj)
    assert len(flat.data.vertices) == 24
    places = world(flat)
    assert places[:, 0].min() > world(obj)[:, 0].max()
    boxes = [places[list(face.vertices)] for face in flat.data.polygons]
    for i, one in enumerate(boxes):
        for other in boxes[:i]:
            apart = (one.min(axis=0) > other.max(axis=0)) | (other.min(axis=0) > one.max(axis=0))
            assert apart[[0, 2]].any()
    assert np.abs(stretches(obj, flat) - 1.0).max() < 2e-6


def test_a_seam_that_ends_inside_makes_a_slit():
    obj = make_object(
        [(x, y, 0.1 * x * x) for y in range(4) for x in range(4)],
        [(4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4) for j in range(3) for i in range(3)],
    )
    mark(obj, [(1, 5), (5, 9)])
    flat = flatten(obj, numbered_edges=True)
    assert sorted(surface_vertices(flat)) == sorted([*range(16), 1, 5])
    found = numbers(flat.data, "planar_edge_number")
    assert sorted(found[found > 0]) == [1, 1, 2, 2]
    vertices = surface_vertices(flat)
    for edge, number in zip(flat.data.edges, found, strict=True):
        on_seam = set(vertices[list(edge.vertices)]) in ({1, 5}, {5, 9})
        assert (number > 0) == on_seam


def test_both_sides_of_each_seam_have_its_number():
    flat = flatten(cube(), numbered_edges=True)
    found = numbers(flat.data, "planar_edge_number")
    assert sorted(found) == sorted([*range(1, 13)] * 2)
    vertices = surface_vertices(flat)
    for number in range(1, 13):
        ends = [set(vertices[list(flat.data.edges[i].vertices)]) for i in np.flatnonzero(found == number)]
        assert ends[0] == ends[1]
    assert "planar_edge_number" not in flatten(cube(name="Another")).data.attributes


def test_in_edit_mode_the_selected_faces_alone_are_laid_flat():
    obj = cube(seams=False)
    select_faces(obj, {0, 2})
    assert bpy.ops.planar.flatten() == {"FINISHED"}
    flat = bpy.context.object
    assert bpy.context.mode == "OBJECT"
    assert len(flat.data.polygons) == 2
    assert len(flat.data.vertices) == 6
    assert np.abs(stretches(obj, flat) - 1.0).max() < 2e-6


def test_a_flat_mesh_can_be_posed_at_once():
    obj = tube()
    flat = flatten(obj)
    for vertex in (0, len(flat.data.vertices) - 1):
        place = world(flat)[vertex].tolist()
        assert bpy.ops.planar.add_pin(location=place) == {"FINISHED"}
    before = coordinates(flat.data.vertices)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.3, 0.2)) == {"FINISHED"}
    assert np.abs(coordinates(flat.data.vertices) - before).max() > 0.2


def test_the_fixed_edge_lies_horizontal():
    obj = tube()
    edge = next(edge.index for edge in obj.data.edges if set(edge.vertices) == {30, 54})
    for method in ("HOLD", "TWO_STEP"):
        flat = flatten(obj, fixed_edge=edge, method=method)
        ends = [int(np.flatnonzero(surface_vertices(flat) == vertex)[0]) for vertex in (30, 54)]
        along = np.diff(coordinates(flat.data.vertices)[ends], axis=0)[0]
        assert abs(along[2]) < 1e-5 * abs(along[0])


def test_in_edit_mode_the_active_edge_is_fixed():
    obj = tube()
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    bpy.ops.mesh.select_all(action="SELECT")
    mesh = bmesh.from_edit_mesh(obj.data)
    edge = next(edge for edge in mesh.edges if {vertex.index for vertex in edge.verts} == {30, 54})
    mesh.select_history.add(edge)
    bmesh.update_edit_mesh(obj.data)
    assert bpy.ops.planar.flatten() == {"FINISHED"}
    flat = bpy.context.object
    ends = [int(np.flatnonzero(surface_vertices(flat) == vertex)[0]) for vertex in (30, 54)]
    along = np.diff(coordinates(flat.data.vertices)[ends], axis=0)[0]
    assert abs(along[2]) < 1e-5 * abs(along[0])


def test_two_steps_and_weights_are_other_shapes_where_a_surface_cannot_be_unrolled():
    obj = cap(angle=1.3)
    places = []
    for options in ({}, {"method": "TWO_STEP"}, {"method": "TWO_STEP", "weights": "UNIFORM"}):
        places.append(coordinates(flatten(obj, **options).data.vertices))
    assert np.abs(places[0] - places[1]).max() > 1e-3
    assert np.abs(places[1] - places[2]).max() > 1e-4


def test_triangles_that_two_steps_turn_over_are_told(capfd):
    obj = cap(rings=12, around=16, angle=2.9)
    flatten(obj, method="TWO_STEP")
    assert "triangles are turned over: Hold Shape has none" in capfd.readouterr().out
    flatten(obj)
    assert "1 patch laid flat, edges 0." in capfd.readouterr().out


def test_how_much_lengths_are_kept_is_told(capfd):
    obj = tube()
    flatten(obj)
    assert "1 patch laid flat, true to scale\n" in capfd.readouterr().out
    for edge in obj.data.edges:
        edge.use_seam = False
    flat = flatten(obj)
    ratios = stretches(obj, flat)
    told = capfd.readouterr().out
    assert (
        f"laid flat, edges {ratios.min():.2f} to {ratios.max():.2f} times as long as on the surface" in told
    )
    assert "more seams distort less" in told
    flatten(cap(angle=0.9))
    assert "more seams" not in capfd.readouterr().out


# ---- UV maps


@pytest.mark.parametrize("transform", RIGID)
def test_uvs_are_written_per_corner_with_one_scale_for_all_islands(transform):
    obj = cube()
    obj.matrix_world = TRANSFORMS[transform]
    activate(obj)
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    assert bpy.context.object == obj
    ratios = uv_ratios(obj)
    assert np.abs(ratios / ratios.mean() - 1.0).max() < 2e-5
    assert uvs(obj).min() >= 0.0
    assert uvs(obj).max() <= 1.0
    assert np.ptp(uvs(obj), axis=0).max() > 0.9, "they fill the map"
    mirrored = obj.matrix_world.determinant() < 0.0
    for face in obj.data.polygons:
        assert (signed_area(uvs(obj)[list(face.loop_indices)]) < 0.0) == mirrored, "seen from outside"
    assert [other.name for other in bpy.data.objects] == ["Cube"]


def test_keep_scale_makes_a_unit_of_the_map_a_unit_of_the_scene():
    obj = cube()
    obj.scale = (3.0, 3.0, 3.0)
    activate(obj)
    assert bpy.ops.planar.flatten(to="UV", keep_scale=True) == {"FINISHED"}
    assert np.abs(uv_ratios(obj) - 1.0).max() < 1e-5


def test_a_new_map_leaves_the_old_one_as_it_is():
    obj = cube()
    activate(obj)
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    before = uvs(obj, "UVMap")
    assert bpy.ops.planar.flatten(to="UV", new_map=True, method="TWO_STEP", keep_scale=True) == {"FINISHED"}
    assert len(obj.data.uv_layers) == 2
    assert obj.data.uv_layers.active_index == 1
    assert np.array_equal(uvs(obj, "UVMap"), before)


def test_in_edit_mode_the_uvs_of_other_faces_stay():
    obj = cube()
    layer = obj.data.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", np.full(48, 0.25, np.float32))
    select_faces(obj, {1, 3})
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [face.index for face in obj.data.polygons if face.select] == [1, 3]
    for face in obj.data.polygons:
        changed = bool((uvs(obj)[list(face.loop_indices)] != 0.25).any())
        assert changed == (face.index in {1, 3})


def test_objects_edited_together_are_edited_together_afterwards():
    other = cube(name="Other")
    obj = cube()
    other.select_set(True)
    obj.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    assert {o.name for o in bpy.context.objects_in_mode} == {"Cube", "Other"}
    assert bpy.context.object == obj
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(other.data.uv_layers) == 0
    assert len(obj.data.uv_layers) == 1


def pin(obj, places):
    """Pin vertices of an object in its map at places, on all their corners."""
    pins = uv_pins(obj.data)
    layer = obj.data.uv_layers.active
    for corner in obj.data.loops:
        if corner.vertex_index in places:
            layer.uv[corner.index].vector = places[corner.vertex_index]
            pins[corner.index].value = True


def test_pinned_uvs_stay_and_tell_the_scale_of_all_islands():
    sheet = tube(share=0.5)
    sheet.data.uv_layers.new(name="UVMap")
    width = 24 * 2 * 0.5 * np.sin(np.pi / 48)  # unrolled, of half of it
    columns = 25
    last = len(sheet.data.vertices) - 1
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    corners = {0: (0.0, 0.0), columns - 1: (width, 0.0), last: (width, 2.0), last - columns + 1: (0.0, 2.0)}
    goals = {vertex: 0.2 * turn @ np.array(place) + (0.3, 0.4) for vertex, place in corners.items()}
    activate(sheet)
    pin(sheet, goals)
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    for corner in sheet.data.loops:
        if corner.vertex_index in goals:
            assert np.abs(uvs(sheet)[corner.index] - goals[corner.vertex_index]).max() < 2e-3
    area = abs(signed_area(np.array([goals[v] for v in (0, columns - 1, last, last - columns + 1)])))
    assert 0.9 < np.median(uv_ratios(sheet)) / 0.2 < 1.1
    assert area > 0.0


def test_an_island_without_pins_gets_the_scale_of_the_pinned_one_and_keeps_off_it():
    obj = cube()
    obj.data.uv_layers.new(name="UVMap")
    first = list(obj.data.polygons[0].loop_indices)  # what Blender writes may move its polygons
    square = ((0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6))
    goals = np.array(square, np.float32)[::1]
    pins = uv_pins(obj.data)
    layer = obj.data.uv_layers.active
    for corner, place in zip(first, goals, strict=True):
        layer.uv[corner].vector = place
        pins[corner].value = True
    activate(obj)
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    assert np.abs(uvs(obj)[first] - goals).max() < 1e-5
    assert np.abs(uv_ratios(obj) - 0.1).max() < 1e-4
    for face in list(obj.data.polygons)[1:]:
        island = uvs(obj)[list(face.loop_indices)]
        apart = (island.min(axis=0) >= 0.6 - 1e-5) | (island.max(axis=0) <= 0.4 + 1e-5)
        assert apart.any()


def test_a_single_pinned_uv_stays_where_it_is():
    obj = tube()
    obj.data.uv_layers.new(name="UVMap")
    activate(obj)
    pin(obj, {60: (0.2, 0.9)})
    assert bpy.ops.planar.flatten(to="UV") == {"FINISHED"}
    corners = [corner.index for corner in obj.data.loops if corner.vertex_index == 60]
    assert np.abs(uvs(obj)[corners] - (0.2, 0.9)).max() < 1e-6
    assert 0.9 < np.ptp(uvs(obj), axis=0).max() < 1.1


# ---- what cannot be laid flat


def no_faces():
    return make_object([(0, 0, 0), (1, 0, 0)], [], [(0, 1)])


def three_at_an_edge():
    vertices = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0)]
    return make_object(vertices, [(0, 1, 2), (0, 1, 3), (0, 1, 4)])


def no_area():
    return make_object([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)])


def not_numbers():
    obj = cube()
    obj.data.vertices[3].co.x = float("nan")
    return obj


def one_side():
    angles = np.linspace(0.0, 2.0 * np.pi, 20, endpoint=False)
    rows = [
        ((1 + s * np.cos(a / 2)) * np.cos(a), (1 + s * np.cos(a / 2)) * np.sin(a), s * np.sin(a / 2))
        for a in angles
        for s in (-0.3, 0.3)
    ]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(19)] + [(38, 39, 0, 1)]
    return make_object(rows, faces)


def handle():
    """A torus with one of its faces left out."""
    around = 8
    rows = [
        ((2 + np.cos(b)) * np.cos(a), (2 + np.cos(b)) * np.sin(a), np.sin(b))
        for a in np.arange(around) * np.pi / 4
        for b in np.arange(around) * np.pi / 4
    ]
    faces = [
        (8 * i + j, 8 * i + (j + 1) % 8, 8 * ((i + 1) % 8) + (j + 1) % 8, 8 * ((i + 1) % 8) + j)
        for i in range(8)
        for j in range(8)
    ]
    return make_object(rows, faces[1:])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cube(seams=False), r"patch 1 of 1 \(with face 0\).*closed.*Mark Seam"),
        (no_faces, "no faces"),
        (three_at_an_edge, "More than two faces meet in edge [0-9]+: .*Edge Split"),
        (no_area, "no area"),
        (not_numbers, "not numbers"),
        (one_side, "one side only.*vertices"),
        (handle, "handle.*seam"),
    ],
)
@pytest.mark.parametrize("to", ["MESH", "UV"])
def test_what_cannot_be_laid_flat_is_refused_with_the_remedy_and_left_as_it_is(make, message, to):
    obj = make()
    activate(obj)
    before = all_of(obj)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.planar.flatten(to=to)
    assert all_of(obj) == before


def test_the_patch_that_cannot_be_laid_flat_is_told_among_others():
    closed, sheet = cube(seams=False, name="Closed"), tube(name="Sheet")
    activate(sheet)
    closed.select_set(True)
    bpy.ops.object.join()
    before = all_of(sheet)
    with pytest.raises(RuntimeError, match=r"patch 2 of 2 \(with face 144\)"):
        bpy.ops.planar.flatten()
    assert all_of(sheet) == before


def test_other_refusals():
    obj = cube()
    activate(obj)
    for options, message in (({"fixed_edge": 99}, "There is no edge 99"),):
        before = all_of(obj)
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.planar.flatten(**options)
        assert all_of(obj) == before
    select_faces(obj, set())
    with pytest.raises(RuntimeError, match="No faces are selected"):
        bpy.ops.planar.flatten()
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.mode_set(mode="SCULPT")
    with pytest.raises(RuntimeError, match="leave this mode first"):
        bpy.ops.planar.flatten()
    bpy.ops.object.mode_set(mode="OBJECT")
