# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutout from Image: what becomes of files, where it lies, what it is made of, and what is refused."""

import os

import bpy
import numpy as np
import pytest
from pictures import (
    SHARED,
    blobs,
    blocks,
    corner_places,
    corner_uvs,
    covered,
    cutout,
    letter,
    new_image,
    pixels_of,
    save,
)
from support import add_pins

REAL = sorted((SHARED / "images").glob("*.png")) or [None]


def texture(obj):
    nodes = obj.active_material.node_tree.nodes
    return next(node for node in nodes if node.type == "TEX_IMAGE")


@pytest.fixture
def drawing(tmp_path):
    return save(tmp_path, "hero.png", letter())


def test_a_drawing_becomes_a_cutout_named_after_its_file(drawing):
    obj = cutout(drawing, vertices=1500)
    assert (obj.name, obj.data.name, obj.active_material.name) == ("hero", "hero", "hero")
    assert obj.select_get()
    assert obj.mode == "OBJECT"
    assert list(bpy.context.selected_objects) == [obj]
    assert all(len(face.vertices) == 3 for face in obj.data.polygons)
    assert 1125 <= len(obj.data.vertices) <= 1875
    assert blocks() == {"objects": 1, "meshes": 1, "materials": 1, "images": 1, "node_groups": 0}
    assert texture(obj).image.filepath_from_user() == str(drawing)
    assert texture(obj).extension == "CLIP"


def test_pixels_lie_where_they_should_to_half_a_pixel(drawing):
    obj = cutout(drawing)
    height, width = letter().shape
    uvs, places = corner_uvs(obj.data), corner_places(obj)
    expected = (uvs - 0.5) * [width, height] / 600.0  # pixels a unit, about the 3D cursor
    assert np.abs(places[:, [0, 2]] - expected).max() * 600.0 < 0.01
    assert np.abs(places[:, 1]).max() < 1e-6
    shown = covered(obj, letter().shape)
    assert shown[letter()].all(), "no pixel is lost"
    assert np.count_nonzero(shown) < 1.5 * np.count_nonzero(letter())


def test_it_faces_the_front_and_is_counter_clockwise_as_seen(drawing):
    obj = cutout(drawing)
    normals = np.array([obj.matrix_world.to_3x3() @ face.normal for face in obj.data.polygons])
    assert np.abs(normals - [0, -1, 0]).max() < 1e-5


def test_it_can_be_pinned_and_posed_at_once(drawing):
    obj = cutout(drawing)
    places = corner_places(obj)
    corners = [loop.vertex_index for loop in obj.data.loops]
    low, high = (corners[index] for index in (places[:, 2].argmin(), places[:, 2].argmax()))
    add_pins(obj, [low], [high])
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.03)) == {"FINISHED"}
    assert np.ptp(corner_places(obj)[:, 2]) > np.ptp(places[:, 2]) + 0.02


@pytest.mark.parametrize("suffix", [".png", ".tif", ".webp", ".exr"])
def test_formats_with_an_alpha(tmp_path, suffix):
    obj = cutout(save(tmp_path, f"hero{suffix}", letter()))
    assert covered(obj, letter().shape)[letter()].all()
    assert np.count_nonzero(covered(obj, letter().shape)) < 0.6 * letter().size


def test_without_an_alpha_a_plain_border_is_cut_away(tmp_path):
    obj = cutout(save(tmp_path, "scan.jpg", letter(), ground=(1.0, 1.0, 1.0)))
    shown = covered(obj, letter().shape)
    assert shown[letter()].all()
    assert np.count_nonzero(shown) < 0.6 * letter().size


def test_an_alpha_that_is_opaque_everywhere_is_told_as_that(tmp_path, capfd):
    cutout(save(tmp_path, "export.png", letter(), ground=(1.0, 1.0, 1.0)))
    assert "'export.png': it is opaque: cut out by the colour of its border" in capfd.readouterr().out
    cutout(save(tmp_path, "scan.jpg", letter(), ground=(1.0, 1.0, 1.0)))
    assert "'scan.jpg': it has no alpha: cut out by the colour of its border" in capfd.readouterr().out


def test_a_photograph_becomes_its_rectangle(tmp_path):
    image = new_image(letter())
    image.pixels.foreach_set(np.random.default_rng(0).uniform(0, 1, (120, 80, 4)).astype(np.float32).ravel())
    image.alpha_mode, image.file_format, image.filepath_raw = "NONE", "JPEG", str(tmp_path / "photo.jpg")
    image.save()
    bpy.data.images.remove(image)
    obj = cutout(tmp_path / "photo.jpg")
    assert covered(obj, (120, 80)).all()


def test_pixel_art_keeps_its_corners(tmp_path):
    art = np.zeros((24, 16), bool)
    art[4:20, 5:9] = art[14:20, 3:13] = art[4:6, 5:12] = True
    obj = cutout(save(tmp_path, "sprite.png", art), interpolation="Closest")
    shown = covered(obj, art.shape)
    assert shown[art].all()
    assert np.count_nonzero(shown) < 1.1 * np.count_nonzero(art)
    assert texture(obj).interpolation == "Closest"


def test_settings_do_what_they_say(drawing, tmp_path):
    many, few = (len(cutout(drawing, vertices=wish).data.vertices) for wish in (3000, 300))
    assert (2250 <= many <= 3750, few <= 600) == (True, True)
    edges = [
        np.linalg.norm(np.subtract(*(edge_ends.co for edge_ends in ends))) * 600.0
        for obj in [cutout(drawing, density="EDGE", edge=8.0)]
        for ends in ([obj.data.vertices[index] for index in edge.vertices] for edge in obj.data.edges)
    ]
    assert 2.0 < np.median(edges) <= 8.0
    wide, narrow = (
        np.count_nonzero(covered(cutout(drawing, margin=margin), letter().shape)) for margin in (8.0, 1.0)
    )
    assert wide > narrow + 600
    ring = save(tmp_path, "ring.png", blobs((40, 60), radius=34) & ~blobs((40, 60), radius=16))
    kept, filled = (covered(cutout(ring, holes=holes), (120, 80))[60, 40] for holes in ("KEEP", "FILL"))
    assert (kept, filled) == (False, True)
    specks = save(tmp_path, "specks.png", blobs((40, 60), radius=30) | blobs((8, 8), radius=4))
    assert covered(cutout(specks), (120, 80))[8, 8]
    assert not covered(cutout(specks, smallest=5.0), (120, 80))[8, 8]
    faint = new_image(letter())
    faint.pixels.foreach_set(np.dstack([np.ones((120, 80, 3)), 0.4 * letter()]).astype(np.float32).ravel())
    faint.filepath_raw, faint.file_format = str(tmp_path / "faint.png"), "PNG"
    faint.save()
    bpy.data.images.remove(faint)
    assert cutout(tmp_path / "faint.png", threshold=0.3) is not None
    with pytest.raises(RuntimeError, match="threshold of 0.50: lower that below 0.40"):
        cutout(tmp_path / "faint.png", threshold=0.5)


def test_islands_can_be_objects(tmp_path):
    path = save(tmp_path, "eyes.png", blobs((20, 60), radius=10) | blobs((58, 60), radius=18))
    assert len(bpy.data.objects) == 0
    cutout(path)
    assert len(bpy.data.objects) == 1
    largest = cutout(path, separate_islands=True)
    eyes = [obj for obj in bpy.data.objects if obj.name.startswith("eyes.")]
    assert len(eyes) == 2
    assert set(bpy.context.selected_objects) == set(eyes)
    other = next(obj for obj in eyes if obj is not largest)
    assert np.ptp(corner_places(largest)[:, 0]) > np.ptp(corner_places(other)[:, 0])
    assert corner_places(largest)[:, 0].min() > corner_places(other)[:, 0].max()
    assert largest.matrix_world == other.matrix_world


def test_parts_keep_their_islands_together_which_is_told(tmp_path, capfd):
    paths = [save(tmp_path, f"{name}.png", blobs((20, 60), (60, 60), radius=10)) for name in ("eyes", "ears")]
    cutout(*paths, layers="PARTS", separate_islands=True)
    assert len(bpy.data.objects) == 1
    assert "islands are not separated where files become parts" in capfd.readouterr().out
    cutout(*paths, layers="PARTS")
    assert "islands are" not in capfd.readouterr().out


def test_several_files_are_layers_in_front_of_each_other_in_their_order(tmp_path):
    paths = [save(tmp_path, f"{name}.png", letter()) for name in ("legs", "body", "arm")]
    cutout(*paths, offset=0.02)
    layers = [bpy.data.objects[name] for name in ("legs", "body", "arm")]
    assert [layer.matrix_world.translation.y for layer in layers] == pytest.approx([0.0, -0.02, -0.04])
    assert all(layer.matrix_world.translation.xz.length < 1e-6 for layer in layers)
    assert set(bpy.context.selected_objects) == set(layers)
    assert bpy.context.object == layers[0]


def test_several_files_can_be_parts_of_one_object(tmp_path):
    paths = [save(tmp_path, f"{name}.png", letter()) for name in ("legs", "body")]
    obj = cutout(*paths, offset=0.02, layers="PARTS", vertices=300)
    assert list(bpy.data.objects) == [obj]
    assert len(bpy.data.meshes) == 1
    assert obj.name == obj.data.name == tmp_path.name
    assert obj.data.materials.keys() == ["legs", "body"]
    depths = [round(float(depth), 4) for depth in corner_places(obj)[:, 1]]
    assert set(depths) == {0.0, -0.02}
    numbers = [face.material_index for face in obj.data.polygons for _ in face.vertices]
    assert {(number, depth) for number, depth in zip(numbers, depths, strict=True)} == {
        (0, 0.0),
        (1, -0.02),
    }
    add_pins(obj, [0])
    assert bpy.ops.planar.drag_pins(offset=(0.01, 0.0)) == {"FINISHED"}


def test_the_hindmost_of_five_layers_comes_to_the_front_by_a_depth(tmp_path):
    paths = [save(tmp_path, f"{number}.png", letter()) for number in range(5)]
    obj = cutout(*paths, layers="PARTS", vertices=200, factor=float(letter().shape[0]))  # 1 high
    back = [
        vertex.index for vertex in obj.data.vertices if vertex.co.z == min(v.co.z for v in obj.data.vertices)
    ]
    add_pins(obj, back[:1])
    assert bpy.ops.planar.select_pins(action="ALL") == {"FINISHED"}
    assert bpy.ops.planar.set_depth(depth=10.0) == {"FINISHED"}
    depths = obj.matrix_world.to_3x3().col[2].y * np.array([vertex.co.z for vertex in obj.data.vertices])
    others = np.delete(depths, back)
    assert depths[back].max() < others.min() - 1e-4, "nearer to who looks along Y"


def test_a_sequence_is_cut_out_as_wide_as_all_its_frames(tmp_path):
    places = [(20, 40), (40, 60), (60, 80)]
    paths = [save(tmp_path, f"walk_{7 + i:03d}.png", blobs(place)) for i, place in enumerate(places)]
    obj = cutout(*paths, image_sequence=True)
    assert blocks()["images"] == blocks()["objects"] == 1
    node = texture(obj)
    assert node.image.source == "SEQUENCE"
    assert (node.image_user.frame_duration, node.image_user.frame_offset) == (3, 6)
    shown = covered(obj, (120, 80))
    assert shown[blobs(*places)].all()
    assert np.count_nonzero(shown) < 1.6 * np.count_nonzero(blobs(*places))


@pytest.mark.parametrize("numbers", [("1", "2", "4", "5"), ("8", "9", "10", "11")])
def test_behind_a_gap_in_a_sequence_there_is_another_one(tmp_path, numbers):
    paths = [save(tmp_path, f"walk_{number}.png", blobs((20, 40))) for number in numbers]
    cutout(*paths, image_sequence=True)
    assert len(bpy.data.objects) == 2
    durations = {texture(obj).image_user.frame_duration for obj in bpy.data.objects}
    assert durations == {2}


def test_a_sequence_of_frames_of_several_sizes_is_refused(tmp_path):
    save(tmp_path, "walk_1.png", blobs((20, 40)))
    paths = [tmp_path / "walk_1.png", save(tmp_path, "walk_2.png", blobs((20, 40), size=(60, 60)))]
    before = blocks()
    with pytest.raises(RuntimeError, match="60 x 60 pixels, and the sequence's first file 80 x 120"):
        cutout(*paths, image_sequence=True)
    assert blocks() == before


def test_fifty_files_by_a_script(tmp_path):
    paths = [save(tmp_path, f"leaf {i}.png", blobs((20 + i / 2, 60), radius=12)) for i in range(50)]
    cutout(*paths, vertices=60)
    assert len(bpy.context.selected_objects) == len(bpy.data.objects) == len(bpy.data.images) == 50
    assert bpy.data.objects["leaf 49"].matrix_world.translation.y == pytest.approx(-0.049)


def test_size_alignment_and_the_cursor_are_blenders(drawing):
    bpy.context.scene.cursor.location = (1.0, 2.0, 3.0)
    obj = cutout(drawing, size_mode="ABSOLUTE", height=2.4, align_axis="+X")
    places, uvs = corner_places(obj), corner_uvs(obj.data)
    height, width = letter().shape
    assert np.abs(places[:, 2] - (3.0 + (uvs[:, 1] - 0.5) * 2.4)).max() < 1e-5
    assert np.abs(places[:, 1] - (2.0 + (uvs[:, 0] - 0.5) * 2.4 * width / height)).max() < 1e-5
    assert np.abs(places[:, 0] - 1.0).max() < 1e-5


def test_a_material_of_the_same_name_stays_as_it_is(drawing):
    mine = bpy.data.materials.new("hero")
    obj = cutout(drawing)
    assert obj.active_material != mine
    assert not [node for node in (mine.node_tree.nodes if mine.node_tree else ()) if node.type == "TEX_IMAGE"]


def test_an_image_that_has_changed_on_the_disk_is_read_anew(drawing, tmp_path):
    cutout(drawing)
    save(tmp_path, "hero.png", blobs((40, 60)))
    os.utime(drawing, ns=(1, 1))
    shown = covered(cutout(drawing), (120, 80))
    assert not shown[100, 20]
    assert len(bpy.data.images) == 1


def test_what_has_been_painted_on_an_image_and_not_saved_is_not_lost(drawing):
    image = texture(cutout(drawing)).image
    painted = pixels_of(blobs((40, 60)))
    image.pixels.foreach_set(painted.ravel())
    image.update()
    with pytest.raises(RuntimeError, match="'hero.png' has been painted on: save the image first"):
        cutout(drawing)
    assert image.is_dirty
    assert np.array_equal(np.array(image.pixels) > 0.5, painted.ravel() > 0.5)
    image.save()
    shown = covered(cutout(drawing), (120, 80))
    assert (shown[60, 40], shown[100, 20]) == (True, False)


def test_one_file_by_its_path(drawing):
    bpy.ops.planar.cutout_from_image(filepath=str(drawing))
    assert bpy.context.object.name == "hero"


def test_undo_takes_all_of_it_back_and_redo_brings_it_again(drawing):
    bpy.ops.ed.undo_push(message="Start")
    before = blocks()
    cutout(drawing, vertices=300)
    bpy.ops.ed.undo_push(message="Cutout")
    bpy.ops.ed.undo()
    assert blocks() == before
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["hero"].data.vertices) > 200


def _unreadable(folder):
    (folder / "bad.png").write_bytes(b"\x89PNG\r\n\x1a\n, but not really")
    return folder / "bad.png"


def _empty(folder):
    (folder / "empty.png").touch()
    return folder / "empty.png"


def _folder(folder):
    (folder / "folder.png").mkdir()
    return folder / "folder.png"


BAD = {
    "unreadable": (_unreadable, "cannot be read as an image: export it again"),
    "empty": (_empty, "empty.png is empty: export it again"),
    "missing": (lambda folder: folder / "none.png", "There is no file .*none.png: choose"),
    "a folder": (_folder, "is a folder: choose the images in it"),
    "all transparent": (
        lambda folder: save(folder, "clear.png", letter() & False),
        "all of it is transparent: export it with its drawing visible",
    ),
    "one pixel": (lambda folder: save(folder, "dot.png", np.ones((1, 1), bool)), "has one pixel only"),
    "too large": (
        lambda folder: save(folder, "long.png", np.ones((1, 16385), bool)),
        "has 16385 x 1 pixels: scale it down to 16384 a side",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_file_that_cannot_be_cut_out_says_why_and_leaves_nothing_behind(kind, tmp_path, drawing):
    make, told = BAD[kind]
    bad = make(tmp_path)
    mine = bpy.data.objects.new("Mine", None)
    bpy.context.scene.collection.objects.link(mine)
    mine.select_set(True)
    bpy.context.view_layer.objects.active = mine
    before = blocks()
    with pytest.raises(RuntimeError, match=told):
        cutout(drawing, bad)
    assert blocks() == before
    assert bpy.context.object == mine
    assert list(bpy.context.selected_objects) == [mine]


def test_every_bad_file_is_named(tmp_path, drawing):
    bad = [make(tmp_path) for make in (_unreadable, _empty, _folder)]
    before = blocks()
    with pytest.raises(RuntimeError) as told:
        cutout(bad[0], drawing, *bad[1:])
    assert all(path.name in str(told.value) for path in bad)
    assert "hero.png" not in str(told.value)
    clear = [save(tmp_path, f"{name}.png", letter() & False) for name in ("clear", "blank")]
    with pytest.raises(RuntimeError) as told:
        cutout(clear[0], drawing, clear[1])
    assert all(f"'{path.name}' cannot be cut out" in str(told.value) for path in clear)
    assert "hero.png" not in str(told.value)
    assert blocks() == before


def test_a_file_without_permission_is_told(drawing, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(RuntimeError, match=r"hero.png cannot be read: give yourself the permission"):
        cutout(drawing)


def test_a_failed_import_leaves_an_image_that_was_there_alone(drawing, tmp_path):
    image = bpy.data.images.load(str(drawing))
    image.alpha_mode = "PREMUL"
    with pytest.raises(RuntimeError):
        cutout(drawing, BAD["all transparent"][0](tmp_path))
    assert (image.alpha_mode, image.filepath, len(bpy.data.images)) == ("PREMUL", str(drawing), 1)


def test_nothing_to_import_is_told():
    with pytest.raises(RuntimeError, match="Which images"):
        bpy.ops.planar.cutout_from_image()


def test_only_in_object_mode(drawing):
    cutout(drawing)
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="leave the current mode first"):
        cutout(drawing)
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.stem if path else "none")
def test_real_drawings(path):
    if path is None:
        pytest.skip(f"there are no drawings in {SHARED / 'images'}")
    assert bpy.ops.planar.cutout_from_image(filepath=str(path)) == {"FINISHED"}
    obj = bpy.context.object
    image = texture(obj).image
    width, height = image.size
    pixels = np.empty(4 * width * height, np.float32)
    image.pixels.foreach_get(pixels)
    alpha = pixels.reshape(height, width, 4)[..., 3]
    assert covered(obj, (height, width))[alpha > 0.5].all()
    assert 1125 <= len(obj.data.vertices) <= 1875
    assert all(face.area > 0 for face in obj.data.polygons)


def test_a_depth_takes_a_layer_across_the_next_one(tmp_path):
    paths = [save(tmp_path, f"{name}.png", blobs((60, 45), radius=40)) for name in ("arm", "head")]
    obj = cutout(*paths, layers="PARTS", vertices=200, size_mode="ABSOLUTE", height=1.0)
    obj.select_set(True)
    behind = min(obj.data.vertices, key=lambda vertex: vertex.co.z)  # Blender 5.2 joins in any order
    assert bpy.ops.planar.add_pin(location=obj.matrix_world @ behind.co) == {"FINISHED"}
    ahead = np.array([vertex.co.z > behind.co.z + 1e-6 for vertex in obj.data.vertices])
    assert 0 < ahead.sum() < len(ahead)
    assert bpy.ops.planar.set_depth(depth=10.0) == {"FINISHED"}
    heights = np.array([vertex.co.z for vertex in obj.data.vertices])
    assert heights[~ahead].min() > heights[ahead].max()
