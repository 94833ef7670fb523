# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking to a point cache: the file, the modifier that plays it, and where the file may be."""

import bpy
import numpy as np
import pytest
from baking import CLOSE, bake, eased_bar, film, keyed_bar, read_pc2, refused, saved, worst
from sequences import curve_of, key, shown_at, stored
from support import PLANES, activate, bar, coordinates, make_object


def test_a_point_cache_has_what_was_shown(tmp_path):
    obj = eased_bar()
    saved(tmp_path)
    shown = film(obj, range(1, 26))
    before = stored(obj)
    assert bake(obj, "POINT_CACHE") == {"FINISHED"}
    assert stored(obj) == before
    times, samples = read_pc2(tmp_path / "Cutout_planar.pc2")
    assert times == (1.0, 1.0)
    assert np.abs(samples - np.stack(list(shown.values()))).max() < CLOSE
    assert worst(obj, shown) < CLOSE
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Cutout_planar.pc2", "shot.blend"]


def test_the_cache_itself_is_shown(tmp_path):
    obj = eased_bar()
    saved(tmp_path)
    shown = film(obj, range(-3, 30))
    bake(obj, "POINT_CACHE", free=True)
    assert obj.data.shape_keys is None
    assert not obj.planar.poses
    clamped = {frame: shown[min(max(frame, 1), 25)] for frame in shown}
    assert worst(obj, clamped) < CLOSE


@pytest.mark.parametrize(
    ("start", "end", "step"), [(1, 25, 3), (-7, 20, 4), (9, 9, 1), (1, 1000, 7), (5, 24, 6)]
)
def test_ranges_and_steps(tmp_path, start, end, step):
    obj = eased_bar()
    curve_of(obj).keyframe_points[2].co[0] = 1000.0 if end == 1000 else 25.0
    saved(tmp_path)
    frames = range(start, end + 1, step)
    shown = film(obj, list(frames)[::9] if end == 1000 else frames)
    bake(obj, "POINT_CACHE", frame_start=start, frame_end=end, frame_step=step, free=True)
    times, samples = read_pc2(tmp_path / "Cutout_planar.pc2")
    assert times == (start, step)
    assert len(samples) == len(frames)
    assert worst(obj, shown) < CLOSE


def test_between_frames_samples_are_blended(tmp_path):
    obj = eased_bar()
    saved(tmp_path)
    low, high = shown_at(obj, 6), shown_at(obj, 7)
    bake(obj, "POINT_CACHE")
    assert np.abs(shown_at(obj, 6.25) - (0.75 * low + 0.25 * high)).max() < CLOSE


def test_the_preview_range_is_the_default_where_it_is_on(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    scene = bpy.context.scene
    scene.use_preview_range, scene.frame_preview_start, scene.frame_preview_end = True, 4, 8
    bake(obj, "POINT_CACHE")
    times, samples = read_pc2(tmp_path / "Cutout_planar.pc2")
    assert times[0] == 4
    assert len(samples) == 5


def test_the_modifier_is_the_first_one_and_is_made_once(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    obj.modifiers.new("Subdivision", "SUBSURF").show_viewport = False
    bake(obj, "POINT_CACHE")
    assert [m.type for m in obj.modifiers] == ["MESH_CACHE", "SUBSURF"]
    assert obj.modifiers[0].filepath == "//Cutout_planar.pc2"
    obj.modifiers.move(0, 1)
    obj.modifiers[1].show_viewport = False
    obj.modifiers[1].frame_start = 3.0
    key(obj, 9, 7)
    shown = film(obj, (1, 9, 25))
    bake(obj, "POINT_CACHE")
    assert [m.type for m in obj.modifiers] == ["MESH_CACHE", "SUBSURF"]
    obj.data.shape_keys.animation_data.action = None  # now only the cache moves
    assert worst(obj, shown) < CLOSE


@pytest.mark.parametrize("plane", ["XZ", "tilted"])
def test_transforms_and_depth_are_respected(tmp_path, plane):
    obj = bar(plane=plane)
    bottom = np.array([[0, 0, 0.4], [1, 0, 0.4], [0, 1, 0.4]])  # a second layer, and a vertex of no face
    vertices = np.concatenate([coordinates(obj.data.vertices), bottom @ PLANES[plane].T, [[3, 3, 3]]])
    faces = [list(face.vertices) for face in obj.data.polygons] + [[65, 66, 67]]
    obj = make_object(vertices, faces, name="Layers")
    obj.location, obj.rotation_euler, obj.scale = (3, -2, 1), (0.3, -0.5, 0.8), (2, 0.5, -1.5)
    for frame in (1, 9, 25):
        key(obj, frame, frame)
    saved(tmp_path)
    shown = film(obj, range(1, 26))
    bake(obj, "POINT_CACHE", frame_start=1, frame_end=25, free=True)
    assert worst(obj, shown) < CLOSE


def test_a_relative_path_moves_with_the_file(tmp_path):
    obj = eased_bar()
    one, two = tmp_path / "one", tmp_path / "zwei Ordner"
    (one / "Schuß 日本").mkdir(parents=True)
    saved(one)
    shown = film(obj, range(1, 26))
    bake(obj, "POINT_CACHE", filepath="//Schuß 日本/ganz.pc2", free=True)
    assert obj.modifiers[0].filepath == "//Schuß 日本/ganz.pc2"
    saved(one)
    one.rename(two)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(two / "shot.blend"))
    assert worst(bpy.data.objects["Cutout"], shown) < CLOSE


def test_an_absolute_path_needs_no_saved_file_and_becomes_relative_in_a_saved_one(tmp_path):
    obj = keyed_bar()
    path = tmp_path / "far" / "x"
    path.parent.mkdir()
    bake(obj, "POINT_CACHE", filepath=str(path))
    assert obj.modifiers[0].filepath == f"{path}.pc2"
    saved(tmp_path)
    bake(obj, "POINT_CACHE", filepath=str(path))
    assert obj.modifiers[0].filepath == "//far/x.pc2"
    assert len(obj.modifiers) == 1


def test_the_default_name_is_made_of_the_objects(tmp_path):
    obj = keyed_bar()
    obj.name = "Hero/left:2"
    saved(tmp_path)
    bake(obj, "POINT_CACHE")
    assert (tmp_path / "Hero_left_2_planar.pc2").is_file()


def test_a_file_made_on_windows_finds_its_cache_elsewhere(tmp_path, monkeypatch):
    obj = keyed_bar()
    saved(tmp_path)
    (tmp_path / "caches").mkdir()
    # What Blender makes of it there.
    monkeypatch.setattr(bpy.path, "relpath", lambda path: "//caches\\one.pc2")
    monkeypatch.setattr("os.sep", "\\")
    bake(obj, "POINT_CACHE", filepath="//caches/one.pc2")
    assert obj.modifiers[0].filepath == "//caches/one.pc2"


def test_where_no_point_cache_can_be(tmp_path):
    obj = keyed_bar()
    assert "save that first" in refused(obj, "POINT_CACHE")
    saved(tmp_path)
    assert "no folder" in refused(obj, "POINT_CACHE", filepath="//nowhere/x.pc2")
    assert "no folder" in refused(obj, "POINT_CACHE", filepath=str(tmp_path / "shot.blend" / "x.pc2"))
    # Too long with what is added while it is written: nobody may write that, on no system.
    assert "cannot be written" in refused(obj, "POINT_CACHE", filepath=f"//{'x' * 240}.pc2")
    assert "add one" in refused(obj, "POINT_CACHE", filepath=f"{tmp_path}/")
    (tmp_path / "dir.pc2").mkdir()
    assert "is a folder" in refused(obj, "POINT_CACHE", filepath="//dir")
    assert "exchange" in refused(obj, "POINT_CACHE", frame_start=5, frame_end=4)


def test_a_file_is_only_replaced_knowingly(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    path = tmp_path / "Cutout_planar.pc2"
    path.write_bytes(b"precious")
    assert "Replace" in refused(obj, "POINT_CACHE")
    path.chmod(0o444)
    assert "write-protected" in refused(obj, "POINT_CACHE", replace=True)
    path.chmod(0o644)
    bake(obj, "POINT_CACHE", replace=True)
    bake(obj, "POINT_CACHE")  # the object's own now
    activate(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    content = path.read_bytes()
    assert "is the point cache of 'Cutout'" in refused(twin, "POINT_CACHE", filepath="//Cutout_planar.pc2")
    bake(twin, "POINT_CACHE")
    assert twin.modifiers[0].filepath == "//Cutout_001_planar.pc2"
    assert path.read_bytes() == content


def test_another_modifier_of_the_name_is_left_alone(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    obj.modifiers.new("Point Cache", "WAVE").show_viewport = False
    bake(obj, "POINT_CACHE")
    bake(obj, "POINT_CACHE", filepath="")
    assert [m.type for m in obj.modifiers] == ["MESH_CACHE", "WAVE"]


def test_a_cache_whose_folder_is_gone_is_put_beside_the_file_again(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    folder = tmp_path / "far"
    folder.mkdir()
    bake(obj, "POINT_CACHE", filepath="//far/x.pc2")
    (folder / "x.pc2").unlink()
    folder.rmdir()
    bake(obj, "POINT_CACHE")
    assert obj.modifiers[0].filepath == "//Cutout_planar.pc2"


def test_a_bake_that_fails_or_is_stopped_leaves_nothing(tmp_path, monkeypatch):
    from planar_deform.errors import Refusal
    from planar_deform.scene.motion import bake as scene_bake
    from planar_deform.scene.sequence import pose_state

    obj = keyed_bar()
    saved(tmp_path)
    bake(obj, "POINT_CACHE")
    bake_on = {
        "SHAPES": lambda: scene_bake.to_shapes(obj, range(1, 9)),
        "POINT_CACHE": lambda: scene_bake.to_point_cache(obj, range(1, 9), "//Cutout_planar.pc2", free=True),
        "RELATIVE_KEYS": lambda: scene_bake.to_relative_keys(obj, range(1, 9)),
    }
    before, content = stored(obj), (tmp_path / "Cutout_planar.pc2").read_bytes()
    real = pose_state.shape_at

    def fail(obj, frame):
        if frame == 7:
            raise Refusal("in the middle")
        return real(obj, frame)

    for to, begin in bake_on.items():
        running = begin()
        assert 0.0 < next(running) < 1.0
        for _ in range(9 if to == "SHAPES" else 1):  # of shapes, well into their writing
            next(running)
        running.close()
        assert stored(obj) == before
        monkeypatch.setattr(pose_state, "shape_at", fail)
        assert "in the middle" in refused(obj, to)
        monkeypatch.undo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Cutout_planar.pc2", "shot.blend"]
    assert (tmp_path / "Cutout_planar.pc2").read_bytes() == content


def test_no_pose_is_made_under_a_shown_cache(tmp_path):
    obj = keyed_bar()
    saved(tmp_path)
    bake(obj, "POINT_CACHE")
    before = stored(obj)
    with pytest.raises(RuntimeError, match="hide it in the viewport"):
        bpy.ops.planar.drag_pins(offset=(0.1, 0.0))
    assert not bpy.ops.planar.reset_to_rest.poll()
    assert stored(obj) == before
    obj.modifiers[0].show_viewport = False
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.0)) == {"FINISHED"}
    obj.modifiers[0].show_viewport = True
    assert bake(obj, "POINT_CACHE") == {"FINISHED"}
