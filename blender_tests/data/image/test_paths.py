# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a .blend names, as Blender on Windows writes their paths."""

import bpy
import numpy as np
from baking import bake, keyed_bar, saved
from pictures import cutout, letter, save
from remeshed import repaint
from support import activate, world

from planar_deform.scene.motion import point_cache
from planar_deform.scene.storage import paths


def test_paths_lead_to_where_blender_finds_the_files(tmp_path):
    saved(tmp_path)
    (tmp_path / "tex").mkdir()
    file = save(tmp_path / "tex", "hero.png", letter())
    for path in (
        "//tex/hero.png",
        "//tex\\hero.png",
        "//..\\" + tmp_path.name + "\\tex\\hero.png",
        str(file),
    ):
        image = bpy.data.images.new("Drawing", 1, 1)
        image.source, image.filepath = "FILE", path
        image.reload()
        assert tuple(image.size) == (80, 120)
        assert paths.absolute(path) == file


def test_paths_in_a_library_begin_at_it(tmp_path):
    file = save(tmp_path, "hero.png", letter())
    folder = tmp_path / "assets" / "heroes"
    folder.mkdir(parents=True)
    image = bpy.data.images.load(str(file))
    image.use_fake_user = True
    image.filepath = "//..\\..\\hero.png"
    bpy.data.libraries.write(str(folder / "hero.blend"), {image}, path_remap="NONE")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    saved(tmp_path)
    with bpy.data.libraries.load(str(folder / "hero.blend"), link=True) as (there, here):
        here.images = there.images
    (image,) = here.images
    image.library.filepath = "//assets\\heroes\\hero.blend"
    assert paths.absolute(image.filepath, image.library) == file


def test_a_drawing_whose_file_was_saved_on_windows_is_read_again(tmp_path):
    (tmp_path / "tex").mkdir()
    path = save(tmp_path / "tex", "hero.png", letter())
    obj = cutout(path)
    saved(tmp_path)
    bpy.data.images[0].filepath = "//tex\\hero.png"
    before = world(obj)
    repaint(path, letter()[:, :50])
    assert bpy.ops.planar.remesh(reload=True) == {"FINISHED"}
    assert np.ptp(world(obj), axis=0)[0] < 0.95 * np.ptp(before, axis=0)[0]


def test_a_cache_that_was_baked_on_windows_is_replaced_where_it_is(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    (tmp_path / "caches").mkdir()
    bake(obj, "POINT_CACHE", filepath="//caches/one.pc2")
    obj.modifiers[0].filepath = "//caches\\one.pc2"
    (tmp_path / "caches" / "one.pc2").write_bytes(b"old")
    assert not point_cache.is_foreign(obj, point_cache.default_path(obj))
    activate(obj)
    bake(obj, "POINT_CACHE")
    assert obj.modifiers[0].filepath == "//caches/one.pc2"
    assert (tmp_path / "caches" / "one.pc2").stat().st_size > 32
    assert [path.name for path in (tmp_path / "caches").iterdir()] == ["one.pc2"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["caches", "shot.blend"]


def test_a_cache_on_a_drive_of_another_system_is_put_beside_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    obj = keyed_bar()
    saved(tmp_path)
    bake(obj, "POINT_CACHE")
    obj.modifiers[0].filepath = "Q:\\shots\\caches\\one.pc2"
    assert point_cache.default_path(obj) == "//Cutout_planar.pc2"
