# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking to shapes, a point cache and relative keys shows what the poses showed, and changes nothing else."""

import json
import subprocess
import sys

import bpy
import numpy as np
import pytest
from baking import CLOSE, bake, eased_bar, film, keyed_bar, refused, saved, worst
from outlines import CURVES, MESHES, lines
from sequences import curve_of, go_to, key, same, shown_at, stored, timing, write
from support import activate, bar, coordinates, evaluated


def test_only_meshes_with_poses_are_baked(tmp_path):
    obj = bar()
    saved(tmp_path)
    assert not bpy.ops.planar.bake.poll()
    key(obj, 1)
    assert bpy.ops.planar.bake.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.planar.bake.poll()


# -- shapes


@pytest.mark.parametrize("step", [1, 3])
def test_shapes_have_a_pose_for_each_frame(step):
    obj = eased_bar()
    frames = range(1, 26, step)
    shown = film(obj, frames)
    assert bake(obj, "SHAPES", frame_step=step) == {"FINISHED"}
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shown.items())
    assert [key[0] for key in timing(obj)] == list(frames)
    assert {key[2] for key in timing(obj)[:-1]} == {"LINEAR"}
    assert not curve_of(obj).modifiers
    assert len(obj.planar.poses) == len(frames)
    assert np.abs(shown_at(obj, 1 + step / 2) - (shown[1] + shown[1 + step]) / 2).max() < CLOSE
    go_to(1 + step)
    edited = write(obj, 5)
    assert same(shown_at(obj, 1 + step), edited)
    assert same(shown_at(obj, 1), shown[1])


def test_shapes_in_a_part_of_the_sequence_leave_the_rest_of_it_alone():
    obj = keyed_bar()
    curve = curve_of(obj)
    for point in curve.keyframe_points:
        point.interpolation = "SINE"
    outside = film(obj, [1, 3, 5, 20, 25, 30])
    inside = film(obj, range(5, 13))
    bake(obj, "SHAPES", frame_start=5, frame_end=12)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in inside.items())
    assert [key[0] for key in timing(obj)] == [1, *range(5, 13), 25]
    assert [key[2] for key in timing(obj)] == ["SINE", *["LINEAR"] * 7, "LINEAR", "SINE"]
    for frame in (1, 5, 25, 30):
        assert same(shown_at(obj, frame), outside[frame])
    bpy.ops.planar.clear_poses()
    assert obj.data.shape_keys is None


@pytest.mark.parametrize(("start", "end"), [(5, 12), (6, 6), (9, 25), (-4, 3), (26, 30)])
def test_shapes_among_generated_ones_leave_every_frame_as_it_was(start, end):
    obj = keyed_bar()
    bpy.ops.planar.generate_inbetweens()
    shown = film(obj, range(-6, 32))
    bake(obj, "SHAPES", frame_start=start, frame_end=end)
    assert worst(obj, shown) < CLOSE
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None


def test_a_pose_that_is_shown_elsewhere_too_stays():
    obj = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points.insert(40, curve.keyframe_points[1].co[1]).interpolation = "LINEAR"
    shown = film(obj, [*range(1, 26), 40])
    bake(obj, "SHAPES")
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shown.items())


@pytest.mark.parametrize("to", ["SHAPES", "POINT_CACHE", "RELATIVE_KEYS"])
def test_generated_in_betweens_on_twos_are_baked(tmp_path, to):
    obj = keyed_bar()
    saved(tmp_path)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert bpy.ops.planar.step_poses(step=2) == {"FINISHED"}
    curve_of(obj).keyframe_points[1].co[0] += 4.0
    shown = film(obj, range(1, 26))
    bake(obj, to)
    assert worst(obj, shown) < CLOSE
    if to == "SHAPES":
        assert not bpy.ops.planar.remove_inbetweens.poll()
    if to != "RELATIVE_KEYS":
        bpy.ops.planar.clear_poses()
        assert obj.data.shape_keys is None


@pytest.mark.parametrize("to", ["SHAPES", "POINT_CACHE", "RELATIVE_KEYS"])
@pytest.mark.parametrize("kind", [*MESHES, *CURVES])
def test_outlines_are_baked(tmp_path, kind, to):
    from planar_deform.scene.storage import points

    obj = lines(kind)
    for frame in (1, 5, 9):
        key(obj, frame)
        block = points.read_block(obj, obj.active_shape_key)
        block[:, :2] += np.random.default_rng(frame).uniform(-0.1, 0.1, (len(block), 2))
        points.write_block(obj.active_shape_key, block)
    saved(tmp_path)

    def shown():
        result = []
        for frame in range(1, 10):
            go_to(frame)
            bpy.context.view_layer.update()
            mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
            result.append(coordinates(mesh.vertices))
        return np.stack(result)

    before = shown()
    assert np.ptp(before, axis=0).max() > 0.05
    if to == "POINT_CACHE" and kind in CURVES:
        assert "not a mesh" in refused(obj, to)
        return
    assert bake(obj, to, frame_start=1, frame_end=9) == {"FINISHED"}
    assert np.abs(shown() - before).max() < CLOSE


# -- relative keys


@pytest.mark.parametrize("step", [1, 3])
def test_relative_keys_show_what_was_shown(step):
    obj = eased_bar()
    rest = coordinates(obj.data.shape_keys.reference_key.data)
    shown = film(obj, range(1, 26, step))
    assert bake(obj, "RELATIVE_KEYS", frame_start=1, frame_end=25, frame_step=step) == {"FINISHED"}
    keys = obj.data.shape_keys
    assert keys.use_relative
    assert not obj.planar.poses
    assert same(coordinates(keys.reference_key.data), rest)
    assert [block.name for block in keys.key_blocks[1:]] == [f"Frame {frame}" for frame in shown]
    assert worst(obj, shown) < CLOSE
    for frame in shown:
        go_to(frame)
        values = [block.value for block in keys.key_blocks[1:]]
        assert values == [float(other == frame) for other in shown]
    low, high = shown[1], shown[1 + step]
    assert np.abs(shown_at(obj, 1 + 0.25 * step) - (0.75 * low + 0.25 * high)).max() < CLOSE
    assert worst(obj, {-5: shown[1], 40: shown[25]}) < CLOSE


@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_a_drag_after_a_bake_to_relative_keys_changes_its_frame_alone(plane):
    obj = keyed_bar(plane=plane)
    assert bake(obj, "RELATIVE_KEYS") == {"FINISHED"}
    keys = len(obj.data.shape_keys.key_blocks)
    shown = film(obj, range(1, 26))
    go_to(12)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.3)) == {"FINISHED"}
    assert len(obj.data.shape_keys.key_blocks) == keys
    moved = {frame for frame, shape in shown.items() if np.abs(shown_at(obj, frame) - shape).max() > CLOSE}
    assert moved == {12}
    go_to(13)
    assert bpy.ops.planar.drag_pins(offset=(-0.1, 0.1)) == {"FINISHED"}
    assert np.abs(shown_at(obj, 13) - shown[13]).max() > 0.05
    go_to(12)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert shown_at(obj, 12) == pytest.approx(coordinates(obj.data.vertices), abs=1e-6)


def test_between_the_frames_of_a_bake_a_drag_says_where_to_go():
    obj = keyed_bar()
    assert bake(obj, "RELATIVE_KEYS", frame_step=4) == {"FINISHED"}
    shown = film(obj, range(1, 30))
    for frame, where in ((7, "5 or 9"), (27, "25")):
        go_to(frame)
        with pytest.raises(RuntimeError, match=f"go to frame {where}"):
            bpy.ops.planar.drag_pins(offset=(0.1, 0.3))
    assert worst(obj, shown) == 0.0
    obj.shape_key_add(name="Mine").value = 1.0
    obj.active_shape_key_index = len(obj.data.shape_keys.key_blocks) - 1
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.3)) == {"FINISHED"}, "a key that was chosen is posed"


def test_relative_keys_replace_the_key_pose_before_the_sequence():
    obj = bar()
    obj.shape_key_add(name="Basis")
    block = obj.shape_key_add(name="Pose")
    block.value = 1.0
    key(obj, 1)
    key(obj, 5, 1)
    rest = coordinates(obj.data.shape_keys.reference_key.data)
    shown = film(obj, range(1, 6))
    bake(obj, "RELATIVE_KEYS", frame_start=1, frame_end=5)
    assert len(obj.data.shape_keys.key_blocks) == 6
    assert same(coordinates(obj.data.vertices), rest)
    assert worst(obj, shown) < CLOSE


def test_relative_keys_are_shown_at_once_saved_and_copied(tmp_path):
    obj = eased_bar()
    shown = film(obj, range(1, 26))
    go_to(8)
    bake(obj, "RELATIVE_KEYS")
    assert np.abs(evaluated(obj) - shown[8]).max() < CLOSE
    saved(tmp_path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    obj = bpy.data.objects["Cutout"]
    assert worst(obj, shown) < CLOSE
    assert obj.data.shape_keys.animation_data.action.name == "Cutout Frames"
    assert [action.name for action in bpy.data.actions] == ["Cutout Frames"]
    activate(obj)
    bpy.ops.object.duplicate()
    assert worst(bpy.context.object, shown) < CLOSE


@pytest.mark.parametrize("to", ["SHAPES", "POINT_CACHE", "RELATIVE_KEYS"])
def test_one_step_of_undo(tmp_path, to):
    obj = eased_bar()
    saved(tmp_path)
    shown = film(obj, range(1, 26))
    go_to(1)
    before = stored(obj)
    bpy.ops.ed.undo_push(message="Before")
    assert bake(obj, to, free=True) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Baked")
    after = stored(bpy.data.objects["Cutout"])
    assert bpy.ops.ed.undo() == {"FINISHED"}
    obj = bpy.data.objects["Cutout"]
    assert stored(obj) == before
    assert not obj.modifiers
    assert worst(obj, shown) < CLOSE
    go_to(1)
    assert bpy.ops.ed.redo() == {"FINISHED"}
    obj = bpy.data.objects["Cutout"]
    assert stored(obj) == after
    assert worst(obj, shown) < CLOSE


# In a process of its own, which ends at once: with that add-on, even disabled, the bpy module crashes when it
# ends by itself.
EXPORT = """
import os, sys
import bpy, addon_utils  # the second one comes with the first one
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
addon_utils.enable("io_scene_gltf2")
result = bpy.ops.export_scene.gltf(
    filepath=sys.argv[2], export_format="GLTF_SEPARATE", export_optimize_animation_size=False
)
os._exit(0 if result == {"FINISHED"} else 1)
"""


def test_relative_keys_are_exported(tmp_path):
    obj = eased_bar()
    frames = range(1, 26)
    bake(obj, "RELATIVE_KEYS")
    path = saved(tmp_path) / "bar.gltf"
    subprocess.run([sys.executable, "-c", EXPORT, tmp_path / "shot.blend", path], check=True)
    scene = json.loads(path.read_text())
    (mesh,) = scene["meshes"]
    assert mesh["extras"]["targetNames"] == [f"Frame {frame}" for frame in frames]
    (animation,) = scene["animations"]
    (channel,) = animation["channels"]
    assert channel["target"]["path"] == "weights"
    weights = scene["accessors"][animation["samplers"][channel["sampler"]]["output"]]
    view = scene["bufferViews"][weights["bufferView"]]
    numbers = np.frombuffer(
        (tmp_path / scene["buffers"][0]["uri"]).read_bytes(), "<f4", weights["count"], view["byteOffset"]
    )
    assert np.array_equal(numbers.reshape(25, 25), np.eye(25))
