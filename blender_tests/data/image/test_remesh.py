# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh: another mesh of the same drawing, and all that the old one had."""

import bpy
import numpy as np
import pytest
from drawings import DRAWINGS, character, extremes
from remeshed import area, assert_in_place, coarse_bar, group, held, remesh, weights
from support import TRANSFORMS, activate, add_pins, bar, coordinates, grid, make_object, measured, world

# ---- density


def test_it_has_about_as_many_vertices_as_wished_and_its_outline():
    obj = bar()
    for count in (500, 1500):
        remesh(vertices=count)
        assert 0.8 * count < len(obj.data.vertices) < 1.25 * count
        assert area(obj) == pytest.approx(2.0, rel=3e-3)
        places = coordinates(obj.data.vertices)
        assert places.min(axis=0) == pytest.approx([0, 0, 0], abs=3e-3)
        assert places.max(axis=0) == pytest.approx([2, 1, 0], abs=3e-3)
        assert all(len(face.vertices) == 3 and face.normal.z > 0.999 for face in obj.data.polygons)
        assert not obj.data.validate()


def test_an_edge_length_is_in_thousandths_of_the_size_where_there_is_no_image():
    obj = bar()
    remesh(density="EDGE", edge=50.0)
    lengths = [
        (obj.data.vertices[edge.vertices[0]].co - obj.data.vertices[edge.vertices[1]].co).length
        for edge in obj.data.edges
    ]
    assert np.median(lengths) == pytest.approx(0.1, rel=0.15)


def test_the_outline_stays_however_often_it_is_done():
    obj = character("racoon")
    before = area(obj)
    for count in (800, 1200, 800):
        remesh(vertices=count)
    assert area(obj) == pytest.approx(before, rel=1e-2)


def test_holes_parts_and_depths_stay():
    vertices, faces = grid(6, 6, 2.0, 2.0)
    faces = [face for number, face in enumerate(faces.tolist()) if number not in (14, 15, 20, 21)]
    other, more = grid(3, 3, 1.0, 1.0, origin=(0.5, 0.5), depth=-0.3)  # over the hole, in a layer of its own
    obj = make_object([*vertices, *other], faces + (more + len(vertices)).tolist())
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete_loose()
    bpy.ops.object.mode_set(mode="OBJECT")
    before = area(obj)
    remesh(vertices=600)
    assert area(obj) == pytest.approx(before, rel=1e-2)
    depths = coordinates(obj.data.vertices)[:, 2]
    assert set(np.round(depths, 5).tolist()) == {0.0, np.float32(-0.3).round(5).item()}
    from planar_deform.scene.objects.cutout_object import begin

    assert begin(bpy.context).parts.max() == 1
    remesh(vertices=600, holes="FILL")
    assert area(obj) == pytest.approx(before + 4.0 / 9.0, rel=1e-2)


@pytest.mark.parametrize("name", ["text", "outline"])
def test_drawings_from_elsewhere_of_long_triangles_and_ngons(name):
    obj = DRAWINGS[name]()
    rows = extremes(obj)
    add_pins(obj, *([row] for row in rows))
    before, size = held(obj), area(obj)
    remesh(obj, vertices=1200)
    assert area(obj) == pytest.approx(size, rel=2e-2)
    assert_in_place(obj, before)
    assert bpy.ops.planar.drag_pins(offset=(0.02, 0.03)) == {"FINISHED"}
    assert measured(obj).flipped == 0


def test_as_few_and_as_fine_as_can_be():
    obj = bar()
    remesh(vertices=3)
    assert 3 <= len(obj.data.vertices) < 150
    assert area(obj) == pytest.approx(2.0, rel=3e-2)
    with pytest.raises(RuntimeError, match="cannot be filled"):
        bpy.ops.planar.remesh(source="OUTLINE", density="EDGE", edge=0.01)
    remesh(vertices=20_000)
    assert 15_000 < len(obj.data.vertices) < 25_000


# ---- pins and weights


@pytest.mark.parametrize(
    ("plane", "transform"),
    [("XY", "none"), ("XZ", "stretched"), ("tilted", "mirrored"), ("XZ", "tiny"), ("tilted", "huge and far")],
)
def test_pins_stay_in_place(plane, transform):
    obj = coarse_bar(plane=plane)
    obj.matrix_world = TRANSFORMS[transform]
    before = held(obj)
    for count in (900, 300):
        remesh(vertices=count)
        assert_in_place(obj, before)
    assert len(obj.vertex_groups) == 5


def test_pins_of_a_parented_imported_character_stay_through_1500_500_and_3000():
    obj = character("giraffe")
    parent = bpy.data.objects.new("Root", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.rotation_euler, parent.scale = (0.3, 0.2, 1.5), (2.0, 2.0, 2.0)
    obj.parent = parent
    add_pins(obj, *([row] for row in extremes(obj)))
    before = held(obj)
    for count in (1500, 500, 3000):
        remesh(obj, vertices=count)
        assert_in_place(obj, before)
    assert obj.parent == parent


def test_a_patch_keeps_its_region_and_is_told_of(capfd):
    obj = bar(nx=24, ny=12)
    inside = [v.index for v in obj.data.vertices if abs(v.co.x - 1.0) < 0.34 and abs(v.co.y - 0.5) < 0.2]
    add_pins(obj, inside, kind="PATCH")
    remesh(vertices=2000)
    places = coordinates(obj.data.vertices)
    members = np.array([w is not None for w in weights(obj, "Pin")])
    far = np.maximum(np.abs(places[:, 0] - 1.0) / 0.333, np.abs(places[:, 1] - 0.5) / 0.167)
    assert members[far < 0.98].all()
    assert not members[far > 1.3].any()
    assert "Pin (" in capfd.readouterr().out


def test_a_patch_without_a_vertex_in_the_new_mesh_holds_a_triangle():
    obj = bar(nx=60, ny=30)
    add_pins(obj, [15 * 61 + 30], kind="PATCH")
    before = held(obj)
    remesh(vertices=60)
    assert sum(w is not None for w in weights(obj, "Pin")) in (1, 2, 3)
    assert_in_place(obj, before, patches=0.1)


def test_a_pin_goes_on_with_its_target():
    obj = bar(nx=40, ny=20)
    add_pins(obj, [0], [400], [860])
    assert bpy.ops.planar.drag_pins(offset=(-0.3, 0.4)) == {"FINISHED"}
    target = np.array(obj.planar.pins[2].target)
    remesh(vertices=1500)
    assert np.abs(np.array(obj.planar.pins[2].target) - target).max() < 1e-6
    shape = world(obj)
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}
    assert np.linalg.norm(world(obj) - shape, axis=1).max() < 0.15  # about points it is softer, being finer
    assert measured(obj).flipped == 0
    assert np.linalg.norm(np.array(obj.planar.pins[2].reached) - target) < 0.01


def test_a_pin_on_a_group_of_the_user_leaves_that_to_others():
    obj = bar()
    made = group(obj, "Arm", lambda co: 0.1 + co.x / 4.0)
    from planar_deform.scene.pins import pin_list

    pin_list.add_on_group(obj, made, "POINT")
    before = held(obj)
    remesh(vertices=700)
    assert_in_place(obj, before)
    places = coordinates(obj.data.vertices)
    assert weights(obj, "Arm") == pytest.approx((0.1 + places[:, 0] / 4.0).tolist(), abs=3e-3)


def test_stiffness_and_weights_stay_where_they_were_painted():
    obj = coarse_bar()
    obj.planar.stiffness_group = group(obj, "Stiff", lambda co: min(1.0, co.x / 2.0)).name
    partly = obj.vertex_groups.new(name="Half")
    partly.add([v.index for v in obj.data.vertices if v.co.x > 0.999], 0.75, "REPLACE")
    names = obj.vertex_groups.keys()
    for count in (1000, 300):
        remesh(vertices=count)
        places = coordinates(obj.data.vertices)
        assert weights(obj, "Stiff") == pytest.approx((places[:, 0] / 2.0).clip(0, 1).tolist(), abs=3e-3)
    assert obj.vertex_groups.keys() == names
    assert obj.planar.stiffness_group == "Stiff"
    half = weights(obj, "Half")
    for x, weight in zip(places[:, 0].tolist(), half, strict=True):
        if x > 1.05:
            assert weight == pytest.approx(0.75, abs=1e-3)
        if x < 0.78:  # a column beside, Blender's own weights fade
            assert weight is None


def test_stiffness_painted_in_part_is_neutral_elsewhere():
    obj = bar()
    made = obj.vertex_groups.new(name="Stiff")
    made.add([v.index for v in obj.data.vertices if v.co.x < 1.001], 1.0, "REPLACE")
    obj.planar.stiffness_group = "Stiff"
    remesh(vertices=700)
    for place, weight in zip(coordinates(obj.data.vertices), weights(obj, "Stiff"), strict=True):
        if place[0] < 0.98:
            assert weight == pytest.approx(1.0, abs=1e-3)
        elif weight is not None:
            assert weight >= 0.49


# ---- what is drawn on it


def test_maps_materials_and_attributes_stay():
    obj = bar(nx=10, ny=4)
    uv = obj.data.uv_layers.new(name="Flat")
    second = obj.data.uv_layers.new(name="Torn")
    for loop in obj.data.loops:
        place = obj.data.vertices[loop.vertex_index].co
        uv.uv[loop.index].vector = (0.1 + 0.2 * place.x, 0.3 + 0.5 * place.y)
    for face in obj.data.polygons:  # the right half lies elsewhere in the second map
        for index in face.loop_indices:
            place = obj.data.vertices[obj.data.loops[index].vertex_index].co
            second.uv[index].vector = (place.x + 5.0 * (face.center.x > 1.0), -place.y)
    for name in ("Left", "Right"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for face in obj.data.polygons:
        face.material_index, face.use_smooth = int(face.center.x > 1.0), face.center.x > 1.0
    heat = obj.data.attributes.new("heat", "FLOAT", "POINT")
    kind = obj.data.attributes.new("kind", "INT", "FACE")
    tint = obj.data.color_attributes.new("tint", "FLOAT_COLOR", "POINT")
    for vertex in obj.data.vertices:
        heat.data[vertex.index].value = 3.0 * vertex.co.x
        tint.data[vertex.index].color = (vertex.co.x / 2.0, vertex.co.y, 0.5, 1.0)
    for face in obj.data.polygons:
        kind.data[face.index].value = 7 if face.center.y > 0.5 else 2
    obj.data.uv_layers.active = obj.data.uv_layers["Torn"]
    obj.data.uv_layers["Flat"].active_render = True
    obj["note"], obj.data["of"] = "mine", 3
    remesh(vertices=800)
    mesh = obj.data
    assert [layer.name for layer in mesh.uv_layers] == ["Flat", "Torn"]
    assert (mesh.uv_layers.active.name, mesh.uv_layers["Flat"].active_render) == ("Torn", True)
    assert (obj["note"], mesh["of"], [m.name for m in mesh.materials]) == ("mine", 3, ["Left", "Right"])
    for loop in mesh.loops:
        place = mesh.vertices[loop.vertex_index].co
        found = mesh.uv_layers["Flat"].uv[loop.index].vector
        assert found[:] == pytest.approx((0.1 + 0.2 * place.x, 0.3 + 0.5 * place.y), abs=1e-5)
    for face in mesh.polygons:
        right = face.center.x > 1.0
        assert face.material_index == int(face.use_smooth)
        if abs(face.center.x - 1.0) > 1e-4:
            assert face.material_index == int(right)
        for index in face.loop_indices:
            place = mesh.vertices[mesh.loops[index].vertex_index].co
            found = mesh.uv_layers["Torn"].uv[index].vector
            assert found[:] == pytest.approx((place.x + 5.0 * face.material_index, -place.y), abs=1e-4)
        if abs(face.center.y - 0.5) > 1e-4:
            assert mesh.attributes["kind"].data[face.index].value == (7 if face.center.y > 0.5 else 2)
    for vertex in mesh.vertices:
        x = min(max(vertex.co.x, 0.0), 2.0)
        assert mesh.attributes["heat"].data[vertex.index].value == pytest.approx(3.0 * x, abs=2e-2)
        assert mesh.attributes["tint"].data[vertex.index].color[0] == pytest.approx(x / 2.0, abs=5e-3)


def test_what_hangs_on_the_object_stays():
    obj = coarse_bar()
    cage, target = bpy.data.objects.new("Cage", bpy.data.lattices.new("Cage")), bar(name="Target")
    child = bpy.data.objects.new("Child", None)
    for other in (cage, child):
        bpy.context.scene.collection.objects.link(other)
    child.parent = obj
    obj.modifiers.new("Bend", "SIMPLE_DEFORM").angle = 0.4
    obj.modifiers.new("Lattice", "LATTICE").object = cage
    target.constraints.new("COPY_LOCATION").target = obj
    activate(obj)
    mesh, count = obj.data, len(bpy.data.meshes)
    remesh(obj, vertices=500)
    assert [(m.name, m.type) for m in obj.modifiers] == [("Bend", "SIMPLE_DEFORM"), ("Lattice", "LATTICE")]
    assert (obj.data, len(bpy.data.meshes), child.parent, obj.name) == (mesh, count, obj, "Cutout")
    assert bpy.context.object == obj
    assert obj.select_get()
