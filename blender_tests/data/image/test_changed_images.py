# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that change on disk in ways that paint programs have, below cutouts that are pinned and keyed."""

import os
import time

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from pictures import blobs, corner_places, corner_uvs, covered, cutout, letter, save
from remeshed import assert_in_place, held, painted, remesh, repaint
from sequences import go_to, key, pull, stored
from support import activate, add_pins, measured, world


def keyed(folder):
    obj, path = painted(folder)
    key(obj, 1)
    pull(obj, 9, (0.0, 0.05))
    go_to(1)
    return obj, path


def on_canvas(art, size, at):
    """The art with its lower left corner at a pixel x, y of a canvas of width x height."""
    canvas = np.zeros(size[::-1], bool)
    canvas[at[1] : at[1] + art.shape[0], at[0] : at[0] + art.shape[1]] = art
    return canvas


def changed(obj):
    from planar_deform.scene.image import file_state

    file_state.forget()
    return file_state.is_changed(obj)


def pixel_places(obj):
    """The affine map (3 x 3) of pixels of the image to the mesh at rest."""
    size = np.array(bpy.data.images[0].size)
    return np.linalg.lstsq(
        np.insert(corner_uvs(obj.data) * size, 2, 1.0, axis=1), corner_places(obj), rcond=None
    )[0]


@pytest.mark.parametrize("way", ["reload", "read already", "new version"])
def test_a_larger_canvas_leaves_drawing_pins_and_poses_in_place(tmp_path, capfd, way):
    obj, path = keyed(tmp_path)
    before, pixels = held(obj), pixel_places(obj)
    art = letter()
    art[55:72, 15:80] = True  # as far as the old canvas
    art = on_canvas(art, (150, 160), (30, 20))
    art[75:92, 110:140] = True  # and beyond it
    if way == "new version":
        path = path.with_name("hero_v2.png")
        bpy.data.images[0].filepath = str(path)
    repaint(path, art)
    capfd.readouterr()
    assert changed(obj)
    if way != "read already":
        assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    else:  # another day
        bpy.data.images[0].reload()
        remesh(obj, source="IMAGE", vertices=300)
    assert "the canvas of 'hero.png' is 150 x 160 pixels instead of 80 x 120" in capfd.readouterr().out
    assert_in_place(obj, before)
    assert covered(obj, art.shape)[art].all()
    go_to(1)
    now = pixel_places(obj)
    assert np.abs(now[:2] - pixels[:2]).max() < 1e-5
    assert np.abs([30.0, 20.0, 1.0] @ now - pixels[2]).max() < 1e-4
    go_to(9)
    assert measured(obj).flipped == 0
    again = pixel_places(obj)
    remesh(obj, source="IMAGE", vertices=400)  # it has come to stay
    assert "the canvas" not in capfd.readouterr().out
    assert np.abs(pixel_places(obj) - again).max() < 1e-4


def test_an_image_of_more_pixels_is_the_same_drawing(tmp_path, capfd):
    obj, path = keyed(tmp_path)
    before, places = held(obj), world(obj)
    repaint(path, np.kron(letter(), np.ones((3, 3), bool)))
    capfd.readouterr()
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert "canvas" not in capfd.readouterr().out
    assert_in_place(obj, before)
    go_to(1)
    assert np.abs(np.ptp(world(obj), axis=0) - np.ptp(places, axis=0)).max() < 0.02 * np.ptp(places)


def test_a_trimmed_drawing_stays_in_place_among_the_parts(tmp_path):
    paths = [save(tmp_path, name, art) for name, art in (("a.png", letter()), ("b.png", blobs((60, 30))))]
    obj = cutout(*paths, vertices=300, layers="PARTS")
    add_pins(obj, [0])
    before = world(obj)
    repaint(paths[0], letter()[8:112, 13:72])
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    now = world(obj)
    assert np.abs(now.min(axis=0) - before.min(axis=0)).max() < 0.02 * np.ptp(before)
    assert np.abs(now.max(axis=0) - before.max(axis=0)).max() < 0.02 * np.ptp(before)


@pytest.mark.parametrize("content", [None, b"", b"no image", "half"])
def test_a_file_that_cannot_be_read_takes_no_picture_away(tmp_path, content):
    obj, path = keyed(tmp_path)
    image, before = bpy.data.images[0], stored(obj)
    pixels = np.array(image.pixels)
    whole = path.read_bytes()
    path.unlink()
    if content is not None:
        path.write_bytes(whole[: len(whole) // 2] if content == "half" else content)
    with pytest.raises(RuntimeError, match="hero.png"):
        bpy.ops.planar.remesh(reload=True)
    assert stored(obj) == before
    assert len(bpy.data.images) == 1
    assert image.has_data
    assert tuple(image.size) == (80, 120)
    assert np.array_equal(np.array(image.pixels), pixels)
    path.write_bytes(whole)
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}


def test_what_was_painted_in_blender_is_not_lost(tmp_path):
    obj, path = keyed(tmp_path)
    image, before = bpy.data.images[0], stored(obj)
    pixels = np.array(image.pixels)
    pixels[:400] = 1.0
    image.pixels.foreach_set(pixels.astype(np.float32))
    assert image.is_dirty
    repaint(path, letter())
    with pytest.raises(RuntimeError, match="'hero.png' has been painted on in Blender"):
        bpy.ops.planar.remesh(reload=True)
    assert stored(obj) == before
    assert np.array_equal(np.array(image.pixels), pixels)


def test_what_was_read_for_one_object_is_read_for_the_other(tmp_path):
    first, path = painted(tmp_path)
    bpy.ops.object.duplicate()
    second = bpy.context.object
    repaint(path, letter()[::-1])
    assert changed(first)
    assert changed(second)
    activate(first)
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    remesh(second, source="IMAGE", vertices=300)
    assert covered(second, letter().shape)[letter()[::-1]].all()
    from planar_deform.scene.image import file_state

    assert not file_state.is_changed(second)


def test_the_images_of_what_was_joined_are_looked_at_too(tmp_path):
    obj, _ = keyed(tmp_path)
    path = save(tmp_path, "dots.png", blobs((20, 30), (60, 90)))
    other = cutout(path, vertices=200)
    other.matrix_world = obj.matrix_world @ Matrix.Translation((0.3, 0.1, 0.05))
    add_pins(other, [0])
    activate(obj)
    other.select_set(True)
    bpy.ops.object.join()
    bpy.context.view_layer.update()
    assert not changed(obj)
    repaint(path, blobs((20, 30), (50, 90)))
    assert changed(obj)
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert not changed(obj)


def test_a_material_more_in_another_order_is_no_change(tmp_path):
    obj, path = keyed(tmp_path)
    paper = bpy.data.images.load(str(save(tmp_path, "paper.png", letter())))
    tree = obj.active_material.node_tree
    for node in [node for node in tree.nodes if node.type == "TEX_IMAGE"]:
        tree.nodes.remove(node)
    for image in (paper, bpy.data.images["hero.png"]):
        tree.nodes.new("ShaderNodeTexImage").image = image
    bpy.data.images["hero.png"].name = "Hero"
    assert not changed(obj)
    art = letter()
    art[:40, :20] = True
    repaint(path, art)
    assert changed(obj)


def test_a_repainted_frame_of_a_sequence_is_noticed(tmp_path):
    arts = [blobs((30, 40), radius=20), blobs((40, 50), radius=20), blobs((50, 60), radius=20)]
    paths = [save(tmp_path, f"walk_{number}.png", art) for number, art in enumerate(arts, 1)]
    obj = cutout(*paths, vertices=200, image_sequence=True)
    add_pins(obj, [0])
    assert not changed(obj)
    art = arts[1] | blobs((60, 100), radius=12)
    save(tmp_path, "walk_2.png", art)
    later = time.time() + 5.0
    os.utime(paths[1], (later, later))
    assert changed(obj)
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert covered(obj, art.shape)[art].all()
    assert not changed(obj)


def test_a_sequence_on_a_larger_canvas_stays_in_place(tmp_path):
    arts = [blobs((30, 40), radius=20), blobs((40, 50), radius=20)]
    paths = [save(tmp_path, f"walk_{number}.png", art) for number, art in enumerate(arts, 1)]
    obj = cutout(*paths, vertices=200, image_sequence=True)
    add_pins(obj, [0])
    before, places = held(obj), world(obj)
    for path, art in zip(paths, arts, strict=True):
        repaint(path, on_canvas(art, (150, 160), (70, 40)))
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert_in_place(obj, before)
    assert np.abs(np.ptp(world(obj), axis=0) - np.ptp(places, axis=0)).max() < 0.03 * np.ptp(places)


def test_an_island_of_its_own_object_stays_as_fine_as_it_was(tmp_path):
    path = save(tmp_path, "dots.png", blobs((20, 30), (60, 90), (20, 90)))
    obj = cutout(path, vertices=600, separate_islands=True)
    add_pins(obj, [0])
    count = len(obj.data.vertices)
    for _ in range(3):
        repaint(path, blobs((20, 30), (60, 90), (20, 90)))
        assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
        assert 0.8 * count < len(obj.data.vertices) < 1.25 * count


def test_of_several_images_the_empty_one_is_told(tmp_path):
    paths = [save(tmp_path, name, art) for name, art in (("a.png", letter()), ("b.png", blobs((60, 30))))]
    obj = cutout(*paths, vertices=300, layers="PARTS")
    add_pins(obj, [0])
    before = stored(obj)
    repaint(paths[1], np.zeros((120, 80), bool))
    with pytest.raises(RuntimeError, match=r"'b.png' cannot be cut out: all of it is transparent"):
        bpy.ops.planar.remesh(reload=True)
    assert stored(obj) == before


def test_a_copied_project_has_the_same_images_until_one_is_painted_on(tmp_path):
    obj, path = painted(tmp_path)
    copied = path.read_bytes()
    os.utime(path, (1, 1))
    assert not changed(obj)
    path.write_bytes(copied[:-9] + bytes(9))  # as large, and another picture
    assert changed(obj)
    path.write_bytes(copied)
    assert not changed(obj)


def test_a_state_without_a_digest_goes_by_the_time(tmp_path):
    obj, path = painted(tmp_path)
    obj.planar.image_state = obj.planar.image_state.replace(
        obj.planar.image_state.split('"')[3], obj.planar.image_state.split('"')[3].rpartition("/")[0]
    )
    assert not changed(obj)
    os.utime(path, (1, 1))
    assert changed(obj)
