# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh too coarse to bend is told of, and made finer by one click; what is seen stays."""

import math

import bpy
import numpy as np
import pytest
from support import activate, add_pins, bar, coordinates, grid, make_object, measured, world


def coarse(obj):
    from planar_deform.scene.view import coarseness

    return coarseness.of(obj)


def image_plane():
    """As Images as Planes makes it: one quad with a UV map, turned upright."""
    bpy.ops.mesh.primitive_plane_add(rotation=(math.pi / 2, 0.0, 0.3))
    bpy.context.object.scale = (3.0, 2.0, 1.0)
    return bpy.context.object


def text():
    bpy.ops.object.text_add(rotation=(math.pi / 2, 0.0, 0.0))
    bpy.context.object.data.body = "Planar"
    bpy.context.object.scale = (0.01, 0.01, 0.01)
    bpy.ops.object.convert(target="MESH")
    return bpy.context.object


def disc():
    """An outline filled with one n-gon, as an imported SVG may be."""
    bpy.ops.mesh.primitive_circle_add(vertices=48, fill_type="NGON", calc_uvs=True)
    return bpy.context.object


def strip():
    vertices, faces = grid(40, 1, 20.0, 1.0)
    obj = make_object(vertices, faces.tolist())
    uv = obj.data.uv_layers.new().uv
    for loop in obj.data.loops:
        uv[loop.index].vector = obj.data.vertices[loop.vertex_index].co.xy * 0.05
    return obj


def area(obj):
    return sum(face.area for face in obj.data.polygons)


def rim(obj):
    """The length of the edges that one face has."""
    count = np.zeros(len(obj.data.edges), int)
    for loop in obj.data.loops:
        count[loop.edge_index] += 1
    places = coordinates(obj.data.vertices)
    ends = np.array([edge.vertices[:] for edge in obj.data.edges])[count == 1]
    return float(np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1).sum())


@pytest.mark.parametrize("make", [image_plane, text, disc, strip])
def test_one_click_makes_it_fine_and_all_looks_the_same(make):
    obj = make()
    assert coarse(obj)
    before = area(obj), rim(obj)
    textured = make is not text  # whose letters each have the whole texture
    assert bpy.ops.planar.refine_mesh() == {"FINISHED"}
    assert not coarse(obj)
    assert 50 <= len(obj.data.vertices) < 3000
    assert (area(obj), rim(obj)) == pytest.approx(before, rel=1e-4)
    if textured:  # the texture lies where it did
        places = np.array([obj.data.vertices[loop.vertex_index].co for loop in obj.data.loops])
        uv = np.array([item.vector for item in obj.data.uv_layers[0].uv])
        known = np.c_[places, np.ones(len(places))]
        found = np.linalg.lstsq(known, uv, rcond=None)[0]
        assert np.abs(known @ found - uv).max() < 1e-4
    assert not bpy.ops.planar.refine_mesh.poll()


def test_it_bends_then():
    distortion = []
    for refine in (False, True):
        obj = strip()
        obj.rotation_euler.x = math.pi / 2
        activate(obj)
        if refine:
            bpy.ops.planar.refine_mesh()
        for x in (0.0, 10.0, 20.0):
            bpy.ops.planar.add_pin(location=(x, 0.0, 0.5))
        for pin, inwards in ((0, 6.0), (2, -6.0)):
            bpy.ops.planar.select_pins(action="SELECT", pin=pin)
            bpy.ops.planar.drag_pins(offset=(inwards, 7.0))
        distortion.append(measured(obj).area - 2.0)
    assert distortion[1] < 0.6 * distortion[0]


def test_pins_stay_where_they_are():
    obj = strip()
    add_pins(obj, range(0, 82, 41), [20, 61])
    places = [world(obj)[rows].mean(axis=0) for rows in ([0, 41], [20, 61])]
    bpy.ops.planar.refine_mesh()
    from planar_deform.scene.view import snapshot

    snapshot.forget()
    seen = snapshot.of_active(bpy.context)
    for pin, place in zip(seen.pins, places, strict=True):
        assert pin.place == pytest.approx(place, abs=1e-5)


def test_a_border_of_materials_stays():
    vertices, faces = grid(2, 1, 2.0, 1.0)
    faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    obj = make_object(vertices, faces.tolist())
    for name in ("Left", "Right"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for face in obj.data.polygons:
        face.material_index = int(face.center.x > 1.0)
    bpy.ops.planar.refine_mesh()
    for face in obj.data.polygons:
        assert face.material_index == int(face.center.x > 1.0)
        xs = [obj.data.vertices[vertex].co.x for vertex in face.vertices]
        assert max(xs) <= 1.0 + 1e-6 or min(xs) >= 1.0 - 1e-6


def test_fine_meshes_and_those_with_shape_keys_are_refused():
    obj = bar(nx=20, ny=6)
    assert not coarse(obj)
    with pytest.raises(RuntimeError, match="fine enough"):
        bpy.ops.planar.refine_mesh()
    obj = image_plane()
    obj.shape_key_add(name="Basis")
    with pytest.raises(RuntimeError, match="shape keys"):
        bpy.ops.planar.refine_mesh()
    assert len(obj.data.vertices) == 4
