# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh: another mesh of the same drawing, and all that the old one had."""

import os
import time

import bpy
import numpy as np
import pytest
from drawings import character, extremes
from filling import curve_fields, everything, stale
from mathutils import Matrix
from pictures import blobs, corner_places, corner_uvs, covered, cutout, letter, pixels_of, save
from sequences import History, curve_of, go_to, key, pull, shown_at, stored
from support import TRANSFORMS, activate, add_pins, bar, coordinates, grid, make_object, measured, world

SAME = 1e-6  # of the size: pins stay in place


def remesh(obj=None, **options):
    if obj is not None:
        activate(obj)
    options = {"source": "OUTLINE", **options}
    assert bpy.ops.planar.remesh(**options) == {"FINISHED"}
    bpy.context.view_layer.update()


def held(obj):
    """Where the usable pins are at rest, by name, in the world's lengths."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    drawing = begin(bpy.context)
    pins = pin_list.model_pins(obj, drawing)
    names = [obj.planar.pins[pin.key].name for pin in pins]
    places = [Holder(pin, drawing.cutout).place(drawing.cutout.rest) for pin in pins]
    return dict(zip(names, np.array(places), strict=True))


def assert_in_place(obj, before, within=SAME, patches=0.03):
    """Pins are where they were, to a share of the size; the middle of a patch nearly."""
    from planar_deform.scene.objects.cutout_object import begin

    now, size = held(obj), begin(bpy.context).diagonal
    assert list(now) == list(before)
    for pin in obj.planar.pins:
        gap = np.abs(now[pin.name] - before[pin.name]).max()
        assert gap < size * (within if pin.kind == "POINT" else patches), pin.name


def area(obj):
    return sum(face.area for face in obj.data.polygons)


def coarse_bar(**options):
    """A bar of 12 x 4 quads, with pins at its ends, in a face and on the rim, and a patch in the middle."""
    obj = bar(**options)
    add_pins(obj, [0], [12, 25, 38], [26, 27, 40], [58])
    add_pins(obj, [30, 31, 32, 43, 44, 45], kind="PATCH")
    for pin in obj.planar.pins:
        pin.select = pin.name == "Pin.001"
    return obj


def group(obj, name, weight):
    """A vertex group whose weights are a function of the place."""
    made = obj.vertex_groups.new(name=name)
    for vertex in obj.data.vertices:
        made.add([vertex.index], weight(vertex.co), "REPLACE")
    return made


def weights(obj, name):
    index = obj.vertex_groups[name].index
    return [next((g.weight for g in v.groups if g.group == index), None) for v in obj.data.vertices]


# ---- density


def test_it_has_about_as_many_vertices_as_wished_and_its_outline():
    obj = bar()
    for count in (500, 3000, 1500):
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
    obj = character("horse")
    before = area(obj)
    for count in (1500, 3000, 1500, 2000, 1500):
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


# ---- pins and weights


@pytest.mark.parametrize("transform", ["none", "stretched", "mirrored", "tiny", "huge and far"])
@pytest.mark.parametrize("plane", ["XY", "XZ", "tilted"])
def test_pins_stay_in_place(plane, transform):
    obj = coarse_bar(plane=plane)
    obj.matrix_world = TRANSFORMS[transform]
    before = held(obj)
    for count in (400, 1500, 300):
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


# ---- poses


def keyed(**options):
    """A bar that bends, keyed and filled; its settings are not those of a new one."""
    obj = coarse_bar(**options)
    key(obj, 1)
    pull(obj, 13, (-0.3, 0.7))
    pull(obj, 25, (0.1, -1.6))
    obj.planar.smooth = True
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    obj.planar.poses[1].name = "Up"
    return obj


def without_shapes(obj):
    """All that is stored of poses but the shapes themselves and their digests."""
    keys = obj.data.shape_keys
    from planar_deform.scene.sequence.playback import record_of

    records = [record_of(pose) for pose in obj.planar.poses]
    for record in records:
        for name in ("stamp", "made_with", "copied"):
            record[name] = bool(record[name])
    return (
        [(b.name, b.frame, b.interpolation, b.lock_shape, b.mute, b.value) for b in keys.key_blocks],
        (keys.name, keys.use_relative, keys.eval_time, obj.active_shape_key_index),
        keys.animation_data.action.name,
        curve_fields(obj),
        records,
        (obj.planar.active_pose, obj.planar.anchor_path, obj.planar.smooth, obj.planar.curve_before),
        [(pin.name, pin.kind, pin.weight, pin.enabled, pin.select) for pin in obj.planar.pins],
        obj.planar.active_pin,
    )


@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_poses_and_inbetweens_are_carried(plane):
    obj = keyed(plane=plane)
    obj.planar.active_pin = 2
    go_to(7)
    before, frames = without_shapes(obj), (1, 4, 7, 13, 18, 25)
    outline = {frame: rim(obj, frame) for frame in frames}
    places = held(obj)
    go_to(7)
    remesh(obj, vertices=900)
    assert without_shapes(obj) == before
    assert stale(obj) == []
    for frame in frames:
        corners = rim(obj, frame)
        gaps = np.linalg.norm(outline[frame][:, None] - corners[None], axis=2).min(axis=1)
        assert gaps.max() < 0.05, frame  # of a drawing of 2 x 1, to its nearest vertex
        assert measured(obj).flipped == 0
    assert_in_place(obj, places)


def rim(obj, frame):
    """Where the corners and the middles of the sides are shown, in the world."""
    shown, rest = shown_at(obj, frame), coordinates(obj.data.shape_keys.reference_key.data)
    axes = np.argsort(np.ptp(rest, axis=0))[1:]
    flat = rest[:, np.sort(axes)]
    flat = (flat - flat.min(axis=0)) / np.ptp(flat, axis=0)
    marks = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0), (0.5, 1)])
    return world(obj, shown[[np.linalg.norm(flat - mark, axis=1).argmin() for mark in marks]])


def test_generate_finds_nothing_to_do_and_goes_on_after_a_change():
    obj = keyed()
    remesh(obj, vertices=700)
    count = len(obj.data.shape_keys.key_blocks)
    shapes = stored(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert len(obj.data.shape_keys.key_blocks) == count
    pull(obj, 13, (0.1, 0.2))
    assert stale(obj) == [(0, 1), (1, 2)]
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert stale(obj) == []
    assert stored(obj) != shapes


def test_what_was_out_of_date_stays_so():
    obj = keyed()
    pull(obj, 25, (0.2, 0.1))
    before = stale(obj)
    assert before
    remesh(obj, vertices=700)
    assert stale(obj) == before


def test_repeated_poses_go_on_following():
    obj = coarse_bar()
    key(obj, 1)
    pull(obj, 13, (-0.3, 0.7))
    curve_of(obj).keyframe_points.insert(25, obj.planar.poses[0].at).interpolation = "LINEAR"
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    copies = [pose.copy_of for pose in obj.planar.poses]
    assert any(copies)
    assert stale(obj) == []
    remesh(obj, vertices=600)
    assert [pose.copy_of for pose in obj.planar.poses] == copies
    assert stale(obj) == []
    pull(obj, 1, (0.05, 0.3))
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert np.abs(shown_at(obj, 1) - shown_at(obj, 25)).max() < 1e-6


def test_a_pose_that_is_not_keyed_is_shown_on():
    obj = keyed()
    go_to(13)
    go_to(5)
    from planar_deform.scene.sequence import pose_state

    assert bpy.ops.planar.drag_pins(offset=(0.0, -0.2)) == {"FINISHED"}
    assert pose_state.unkeyed(obj)
    shown = corner_places(obj)[:, :2]
    remesh(obj, vertices=700)
    assert pose_state.unkeyed(obj)
    now = corner_places(obj)[:, :2]
    assert np.abs([shown.min(axis=0) - now.min(axis=0), shown.max(axis=0) - now.max(axis=0)]).max() < 0.02


@pytest.mark.parametrize("name", ["horse", "elephant"])
def test_bent_poses_of_characters_have_no_turned_triangles(name):
    obj = character(name)
    left, middle, right = extremes(obj)
    add_pins(obj, [left], [middle], [right])
    size = max(obj.dimensions)
    key(obj, 1)
    pull(obj, 9, (-0.2 * size, 0.3 * size))
    pull(obj, 17, (-0.5 * size, -0.2 * size))
    flipped = {frame: (go_to(frame), measured(obj).flipped)[1] for frame in (1, 9, 17)}
    for count in (600, 2500):
        remesh(obj, vertices=count)
        for frame, before in flipped.items():
            go_to(frame)
            assert measured(obj).flipped <= before


def test_undo_and_redo_bring_all_back_to_the_bit():
    obj = keyed()
    group(obj, "Weights", lambda co: co.x / 3.0)
    obj.data.uv_layers.new(name="Map")

    def state(obj):
        members = [[(g.group, g.weight) for g in v.groups] for v in obj.data.vertices]
        pins = [
            (pin.name, pin.group, pin.has_target, tuple(pin.target), tuple(pin.reached), pin.angle)
            for pin in obj.planar.pins
        ]
        places = [(p.name, tuple(p.place), p.even) for p in obj.data.planar_seen.places]
        faces = [tuple(face.vertices) for face in obj.data.polygons]
        uvs = [tuple(uv.vector) for uv in obj.data.uv_layers[0].uv]
        return everything(obj), members, pins, places, tuple(obj.data.planar_seen.counts), faces, uvs

    history = History(state)
    for count in (800, 300):
        activate(bpy.data.objects["Cutout"])
        history.did(bpy.ops.planar.remesh(source="OUTLINE", vertices=count))
    history.undo_all()
    history.redo_all()
    history.undo_all()


# ---- images


@pytest.fixture
def painted(tmp_path):
    """A cutout of an F, turned and scaled and parented, and its file."""
    path = save(tmp_path, "hero.png", letter())
    obj = cutout(path, vertices=300)
    parent = bpy.data.objects.new("Root", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.rotation_euler, obj.parent = (0.1, 0.2, np.pi / 2), parent
    obj.rotation_euler.y, obj.scale = 0.5, (3.0, 3.0, 3.0)
    activate(obj)
    add_pins(obj, *([row] for row in extremes(obj)))
    return obj, path


def texture(obj):
    return next(node for node in obj.active_material.node_tree.nodes if node.type == "TEX_IMAGE")


def assert_pixels_in_place(obj, linear):
    uvs = np.insert(corner_uvs(obj.data), 2, 1.0, axis=1)
    assert np.abs(uvs @ linear - corner_places(obj)).max() < 1e-3 * max(obj.dimensions)


def pixel_map(obj):
    uvs = np.insert(corner_uvs(obj.data), 2, 1.0, axis=1)
    return np.linalg.lstsq(uvs, corner_places(obj), rcond=None)[0]


def repaint(path, art):
    """Write the file again, later and larger, as a paint program does."""
    save(path.parent, path.name, art)
    later = time.time() + 5.0
    os.utime(path, (later, later))
    from planar_deform.scene.image import file_state

    file_state.forget()


def test_it_follows_the_image(painted):
    obj, _ = painted
    linear, before = pixel_map(obj), held(obj)
    for count in (500, 1200):
        remesh(obj, source="IMAGE", vertices=count)
        assert 0.75 * count < len(obj.data.vertices) < 1.3 * count
        assert_pixels_in_place(obj, linear)
        assert_in_place(obj, before)
        assert covered(obj, letter().shape)[letter()].all()


def test_by_itself_it_takes_the_image_where_there_is_one(painted):
    obj, _ = painted
    assert bpy.ops.planar.remesh(vertices=700, margin=8.0) == {"FINISHED"}
    assert covered(obj, letter().shape).sum() > 1.5 * letter().sum()
    other = bar()
    assert bpy.ops.planar.remesh(vertices=500) == {"FINISHED"}
    assert area(other) == pytest.approx(2.0, rel=3e-3)


def test_changed_art_is_noticed_and_taken_in_by_one_click(painted):
    from planar_deform.scene.image import file_state

    obj, path = painted
    key(obj, 1)
    pull(obj, 9, (0.0, 0.05))
    linear, before = pixel_map(obj), held(obj)
    shown = {frame: (go_to(frame), held(obj))[1] for frame in (1, 9)}
    assert not file_state.is_changed(obj)
    art = letter()
    art[20:36, 15:75] = True  # a foot, and the arm in the middle is longer
    art[55:72, 15:72] = True
    repaint(path, art)
    assert file_state.is_changed(obj)
    go_to(1)
    remesh(obj, source="IMAGE", reload=True, vertices=600)
    assert not file_state.is_changed(obj)
    assert covered(obj, art.shape)[art].all()
    go_to(1)
    assert_pixels_in_place(obj, linear)
    assert_in_place(obj, before)
    go_to(9)
    assert measured(obj).flipped == 0
    assert list(held(obj)) == list(shown[9])


def test_an_image_of_the_same_size_is_swapped_without_anything(painted):
    obj, path = painted
    key(obj, 1)
    pull(obj, 9, (0.0, 0.05))
    before, places = stored(obj), held(obj)
    other = save(path.parent, "night.png", letter(), colour=(0.1, 0.1, 0.6))
    texture(obj).image.filepath = str(other)
    go_to(1)
    go_to(9)
    assert stored(obj) == before
    assert_in_place(obj, places)


def test_a_new_island_is_a_new_part_and_a_lost_one_is_told_of(tmp_path, capfd):
    path = save(tmp_path, "dots.png", blobs((20, 30), (60, 30)))
    obj = cutout(path, vertices=200)
    from planar_deform.scene.objects.cutout_object import begin

    assert begin(bpy.context).parts.max() == 1
    add_pins(obj, [0])
    repaint(path, blobs((20, 30), (20, 90), (60, 90)))
    capfd.readouterr()
    remesh(obj, source="IMAGE", reload=True, vertices=300)
    assert begin(bpy.context).parts.max() == 2
    assert "no drawing any more" in capfd.readouterr().out
    assert len(held(obj)) == 1


def test_an_island_that_another_object_shows_stays_there(tmp_path):
    path = save(tmp_path, "dots.png", blobs((20, 30), (60, 90)))
    first = cutout(path, vertices=200, separate_islands=True)
    others = [obj for obj in bpy.data.objects if obj != first and obj.type == "MESH"]
    assert len(others) == 1
    before = area(first), area(others[0])
    remesh(first, source="IMAGE", vertices=300)
    assert area(first) == pytest.approx(before[0], rel=0.1)
    assert area(others[0]) == before[1]


def test_layers_keep_their_images_and_depths(tmp_path):
    low = save(tmp_path, "low.png", blobs((25, 40), (55, 40), radius=22))
    high = save(tmp_path, "high.png", blobs((40, 60), radius=25))
    obj = cutout(low, high, vertices=200, layers="PARTS", offset=0.02)
    depths = sorted(set(np.round(corner_places(obj)[:, 1], 4).tolist()))
    assert len(depths) == 2
    areas = [sum(f.area for f in obj.data.polygons if f.material_index == slot) for slot in (0, 1)]
    remesh(obj, source="IMAGE", vertices=900)
    assert sorted(set(np.round(corner_places(obj)[:, 1], 4).tolist())) == depths
    assert [m.name for m in obj.data.materials] == ["low", "high"]
    now = [sum(f.area for f in obj.data.polygons if f.material_index == slot) for slot in (0, 1)]
    assert now == pytest.approx(areas, rel=0.1)
    assert bpy.data.images["low.png"].size[:] == pixels_of(blobs((40, 60))).shape[1::-1]


# ---- refusals


def unchanged(obj, match, **options):
    activate(obj)
    before = bits(obj)
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.planar.remesh(**{"source": "OUTLINE", **options})
    assert bits(obj) == before


def bits(obj):
    keys = obj.data.shape_keys
    return (
        coordinates(obj.data.vertices).tobytes(),
        [tuple(face.vertices) for face in obj.data.polygons],
        [] if keys is None else [(b.name, b.frame, coordinates(b.data).tobytes()) for b in keys.key_blocks],
    )


def shared(obj):
    other = bpy.data.objects.new("Other", obj.data)
    bpy.context.scene.collection.objects.link(other)


def foreign_keys(obj):
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile")


def pushed_down(obj):
    key(obj, 1)
    pull(obj, 5, (0.1, 0.2))
    animation = obj.data.shape_keys.animation_data
    action = animation.action
    animation.nla_tracks.new().strips.new("Strip", 1, action)
    animation.action = None


def bound(obj):
    other = bar(name="Driver", nx=20, ny=20)
    other.location.z = 0.1
    activate(obj)
    obj.modifiers.new("Follow", "SURFACE_DEFORM").target = other
    assert bpy.ops.object.surfacedeform_bind(modifier="Follow") == {"FINISHED"}
    assert obj.modifiers["Follow"].is_bound


def bound_to(obj):
    other = bar(name="Follower")
    other.modifiers.new("Follow", "SURFACE_DEFORM").target = obj
    activate(other)
    obj.data.transform(Matrix.Scale(2.0, 4))
    assert bpy.ops.object.surfacedeform_bind(modifier="Follow") == {"FINISHED"}
    assert other.modifiers["Follow"].is_bound


def hooked(obj):
    obj.modifiers.new("Hook", "HOOK").vertex_indices_set([0, 1])


def cached(obj):
    obj.modifiers.new("Cache", "MESH_CACHE")


def vertex_child(obj):
    child = bpy.data.objects.new("Hat", None)
    bpy.context.scene.collection.objects.link(child)
    child.parent, child.parent_type = obj, "VERTEX"


def loose(obj):
    obj.data.vertices.add(1)


def edited(obj):
    bpy.ops.object.mode_set(mode="EDIT")


def folded(obj):
    places = coordinates(obj.data.vertices)
    places[:, 0] = np.abs(places[:, 0] - 1.0)
    obj.data.vertices.foreach_set("co", places.ravel())
    obj.data.update()
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}


def laid_flat(obj):
    bpy.ops.planar.flatten(to="MESH")
    flat = bpy.context.object
    assert flat != obj
    activate(obj)


REFUSED = {
    shared: "shared",
    foreign_keys: "shape keys of its own",
    pushed_down: "Nonlinear Animation",
    bound: "'Follow' is bound",
    bound_to: "'Follow' of 'Follower'",
    hooked: "hooks single vertices",
    cached: "plays a file",
    vertex_child: "hangs on vertices",
    loose: "without faces",
    folded: "lies over itself",
    laid_flat: "laid flat",
}


@pytest.mark.parametrize("made", REFUSED, ids=lambda made: made.__name__)
def test_what_would_lose_something_is_refused(made):
    obj = bar(nx=6, ny=3)
    add_pins(obj, [0])
    made(obj)
    unchanged(obj, REFUSED[made])


def test_other_modes_are_refused_and_change_nothing():
    obj = bar()
    edited(obj)
    with pytest.raises(RuntimeError, match="leave the current mode"):
        bpy.ops.planar.remesh()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(obj.data.vertices) == 65


def test_a_flat_mesh_of_a_surface_is_refused():
    bar()
    bpy.ops.planar.flatten(to="MESH")
    unchanged(bpy.context.object, "surface laid flat")


def test_images_that_cannot_be_cut_out_are_refused(painted, tmp_path):
    obj, path = painted
    repaint(path, np.zeros_like(letter()))
    unchanged(obj, "cannot be cut out", source="IMAGE", reload=True)
    repaint(path, blobs((40, 60), size=(120, 80), radius=0.1))
    unchanged(obj, "cannot be cut out|no drawing any more", source="IMAGE")
    unchanged(bar(), "shows no image", source="IMAGE")


def test_what_is_refused_leaves_the_poses(painted):
    obj, _ = painted
    key(obj, 1)
    pull(obj, 9, (0.0, 0.05))
    before = stored(obj)
    vertex_child(obj)
    unchanged(obj, "hangs on vertices", source="IMAGE")
    assert stored(obj) == before
