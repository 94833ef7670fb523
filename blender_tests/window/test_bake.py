# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking in the window: the panel's buttons, Esc in the middle, files that are there already."""

import struct
from collections.abc import Generator, Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import active, sheet
from harness import Window, addon


def shot(window: Window, *, last: int) -> Generator[None, None, Path]:
    """A sheet with two poses in a saved file whose timeline plays so many frames; the file's folder."""
    sheet()
    for frame, share in ((1, 0.0), (25, 0.5)):
        drawing = addon("scene.objects.cutout_object").begin(bpy.context)
        addon("scene.objects.any_object").key_poses(drawing, {frame: drawing.cutout.rest * (1.0 + share)})
    bpy.context.scene.frame_end = last
    folder = Path(bpy.app.tempdir)
    for path in folder.glob("*.pc2"):
        path.unlink()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.sidebar()
    return folder


def press(window: Window, to: str) -> set[str]:
    """As the panel's button does."""
    with window.context("UI"):
        return bpy.ops.planar.bake("INVOKE_DEFAULT", True, to=to)


def samples(path: Path) -> int:
    return struct.unpack("<12siiffi", path.read_bytes()[:32])[5]


def evaluated() -> np.ndarray:
    mesh = active().evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    coordinates = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return coordinates


def test_a_point_cache_plays_and_is_undone(window: Window) -> Iterator[None]:
    folder = yield from shot(window, last=25)
    bpy.context.scene.frame_set(13)
    before = evaluated()
    assert press(window, "POINT_CACHE") == {"FINISHED"}
    yield from window.wait(0.3)
    assert samples(folder / "Sheet_planar.pc2") == 25
    assert [modifier.type for modifier in active().modifiers] == ["MESH_CACHE"]
    assert np.abs(evaluated() - before).max() < 2e-6
    bpy.context.scene.frame_set(25)
    assert np.abs(evaluated() - before).max() > 0.1
    window.picture("baked")
    with window.context():  # what a change in the redo panel does
        bpy.context.window_manager.operators[-1].frame_step = 2
        assert bpy.ops.ed.undo_redo() == {"FINISHED"}
    assert samples(folder / "Sheet_planar.pc2") == 13
    assert len(active().modifiers) == 1
    yield from window.undo()
    assert not active().modifiers


def test_escape_leaves_no_file(window: Window) -> Iterator[None]:
    folder = yield from shot(window, last=200_000)
    assert press(window, "POINT_CACHE") == {"RUNNING_MODAL"}
    yield from window.wait(0.3)
    assert window.busy == ["PLANAR_OT_bake"]
    assert len([path for path in folder.iterdir() if ".pc2" in path.name]) == 1  # under another name
    window.picture("baking")
    yield from window.key("ESC")
    assert window.busy == []
    assert not [path for path in folder.iterdir() if ".pc2" in path.name]
    assert not active().modifiers


def test_another_file_is_replaced_only_when_that_is_confirmed(window: Window) -> Iterator[None]:
    folder = yield from shot(window, last=25)
    path = folder / "Sheet_planar.pc2"
    path.write_bytes(b"precious")
    for answer, replaced in (("ESC", False), ("RET", True)):
        yield from window.hover(window.pixel((0, 0, 0)))
        press(window, "POINT_CACHE")
        yield from window.wait(0.5)
        assert path.read_bytes() == b"precious"
        window.picture("replace")
        yield from window.key(answer)
        yield from window.wait(0.5)
        assert (path.read_bytes() != b"precious") == replaced, answer
    assert samples(path) == 25


def test_a_long_bake_over_another_file_runs_on_and_can_be_ended(window: Window) -> Iterator[None]:
    """Once Replace is confirmed: with progress, Esc, and one undo step in the end."""
    folder = yield from shot(window, last=200_000)
    path = folder / "Sheet_planar.pc2"
    path.write_bytes(b"precious")
    yield from window.hover(window.pixel((0, 0, 0)))
    press(window, "POINT_CACHE")
    yield from window.wait(0.5)
    yield from window.key("RET")
    yield from window.wait(0.3)
    assert window.busy == ["PLANAR_OT_bake"]
    window.picture("replacing")
    yield from window.key("ESC")
    assert window.busy == []
    assert path.read_bytes() == b"precious"
    assert not active().modifiers
    bpy.context.scene.frame_end = 2000
    press(window, "POINT_CACHE")
    yield from window.wait(0.5)
    yield from window.key("RET")
    while window.busy:
        yield
    assert samples(path) == 2000
    assert addon("operators.modal.running").now() is None
    with window.context():  # what a change in the redo panel does
        operator = bpy.context.window_manager.operators[-1]
        assert operator.bl_idname == "PLANAR_OT_bake"
        operator.frame_step = 2
        assert bpy.ops.ed.undo_redo("EXEC_DEFAULT", True) == {"FINISHED"}
    assert window.busy == []
    assert samples(path) == 1000
    yield from window.wait(0.3)
    yield from window.undo()
    yield from window.wait(0.3)
    assert not active().modifiers
    yield from window.redo()
    yield from window.wait(0.3)
    assert len(active().modifiers) == 1


def test_relative_keys_are_one_undo_step(window: Window) -> Iterator[None]:
    yield from shot(window, last=25)
    assert press(window, "RELATIVE_KEYS") == {"FINISHED"}
    assert len(active().data.shape_keys.key_blocks) == 26
    yield from window.wait(0.3)
    yield from window.undo()
    assert len(active().planar.poses) == 2
    yield from window.redo()
    assert len(active().data.shape_keys.key_blocks) == 26
