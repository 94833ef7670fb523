# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh by the image that a cutout shows, as it was or as it has become."""

import bpy
import numpy as np
import pytest
from pictures import blobs, corner_places, corner_uvs, covered, cutout, letter, pixels_of, plane, save
from remeshed import area, assert_in_place, held, painted, remesh, repaint
from sequences import go_to, key, pull, stored
from support import add_pins, bar, measured


def texture(obj):
    return next(node for node in obj.active_material.node_tree.nodes if node.type == "TEX_IMAGE")


def assert_pixels_in_place(obj, linear):
    uvs = np.insert(corner_uvs(obj.data), 2, 1.0, axis=1)
    assert np.abs(uvs @ linear - corner_places(obj)).max() < 1e-3 * max(obj.dimensions)


def pixel_map(obj):
    uvs = np.insert(corner_uvs(obj.data), 2, 1.0, axis=1)
    return np.linalg.lstsq(uvs, corner_places(obj), rcond=None)[0]


def test_it_follows_the_image(tmp_path):
    obj, _ = painted(tmp_path)
    linear, before = pixel_map(obj), held(obj)
    for count in (500, 1200):
        remesh(obj, source="IMAGE", vertices=count)
        assert 0.75 * count < len(obj.data.vertices) < 1.3 * count
        assert_pixels_in_place(obj, linear)
        assert_in_place(obj, before)
        assert covered(obj, letter().shape)[letter()].all()


def test_by_itself_it_takes_the_image_where_there_is_one(tmp_path):
    obj, _ = painted(tmp_path)
    assert bpy.ops.planar.remesh(vertices=700, margin=8.0) == {"FINISHED"}
    assert covered(obj, letter().shape).sum() > 1.5 * letter().sum()
    other = bar()
    assert bpy.ops.planar.remesh(vertices=500) == {"FINISHED"}
    assert area(other) == pytest.approx(2.0, rel=3e-3)


def test_changed_art_is_noticed_and_taken_in_by_one_click(tmp_path):
    from planar_deform.scene.image import file_state

    obj, path = painted(tmp_path)
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
    count = len(obj.data.vertices)
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert 0.7 * count < len(obj.data.vertices) < 1.5 * count
    assert not file_state.is_changed(obj)
    assert covered(obj, art.shape)[art].all()
    go_to(1)
    assert_pixels_in_place(obj, linear)
    assert_in_place(obj, before)
    go_to(9)
    assert measured(obj).flipped == 0
    assert list(held(obj)) == list(shown[9])


def test_an_image_of_the_same_size_is_swapped_without_anything(tmp_path):
    obj, path = painted(tmp_path)
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


def test_an_image_plane_with_pins_becomes_a_cutout_that_keeps_them(tmp_path):
    obj = plane(tmp_path)
    linear = pixel_map(obj)
    for x, y in ((20, 15), (20, 100), (65, 100)):
        at = np.array([x / 80, y / 120, 1.0]) @ linear
        assert bpy.ops.planar.add_pin(location=at.tolist()) == {"FINISHED"}
    before = held(obj)
    remesh(obj, source="IMAGE", vertices=700)
    assert_in_place(obj, before)
    assert_pixels_in_place(obj, linear)
    assert covered(obj, letter().shape)[letter()].all()
    assert covered(obj, letter().shape).sum() < 1.5 * letter().sum()


def test_without_a_choice_an_image_that_does_not_fit_gives_way_to_the_outline(tmp_path, capfd):
    obj = cutout(save(tmp_path, "hero.png", letter()), vertices=300)
    uvs = obj.data.uv_layers.active.uv
    for loop in obj.data.loops:
        uvs[loop.index].vector.x += 0.3 * uvs[loop.index].vector.y ** 2
    before = area(obj)
    assert bpy.ops.planar.remesh(vertices=600) == {"FINISHED"}
    assert "by its outline: 'hero' does not show its image evenly" in capfd.readouterr().out
    assert area(obj) == pytest.approx(before, rel=1e-2)
    with pytest.raises(RuntimeError, match="evenly"):
        bpy.ops.planar.remesh(source="IMAGE")


def test_a_changed_image_that_was_not_read_is_still_told_of(tmp_path):
    from planar_deform.scene.image import file_state

    obj, path = painted(tmp_path)
    repaint(path, blobs((40, 60)))
    remesh(obj, source="IMAGE", vertices=500)  # of what Blender has in memory
    assert file_state.is_changed(obj)


def test_pins_on_what_is_no_more_are_told_of(tmp_path, capfd):
    obj, path = painted(tmp_path)
    art = letter()
    art[60:] = False
    repaint(path, art)
    count = len(held(obj))
    capfd.readouterr()
    remesh(obj, source="IMAGE", reload=True, vertices=500)
    assert "hold the point of it that is nearest: Pin" in capfd.readouterr().out
    assert len(held(obj)) == count
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.01)) == {"FINISHED"}


def test_a_plane_that_shows_a_part_of_its_image_stays_within_that(tmp_path):
    obj = plane(tmp_path)
    for loop in obj.data.loops:  # the upper half alone
        uv = obj.data.uv_layers.active.uv[loop.index]
        uv.vector.y = 0.5 + uv.vector.y / 2
    remesh(obj, source="IMAGE", vertices=400)
    assert corner_uvs(obj.data)[:, 1].min() > 0.45
    assert covered(obj, letter().shape)[60:][letter()[60:]].all()
