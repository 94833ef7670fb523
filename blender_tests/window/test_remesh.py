# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh by hand: of a posed and keyed drawing, with settings changed after that, and of a repainted one."""

import os
import time
from collections.abc import Iterator
from pathlib import Path

import bpy
import imported
import numpy as np
from cutouts import active, pin
from harness import Window, addon
from poses import go_to
from test_cutout import doll, retype
from test_menus import search

SCALE = 600.0  # pixels a unit


def place(pixel: tuple[float, float]) -> tuple[float, float, float]:
    x, y = np.array(pixel) - [imported.WIDTH / 2, imported.HEIGHT / 2]
    return (x / SCALE, 0.0, y / SCALE)


def keyed_doll(window: Window) -> Iterator[None]:
    """A cutout of the doll, with an arm up at frame 13, filled between."""
    bpy.ops.planar.cutout_from_image(filepath=str(doll()), vertices=1500)
    yield from window.look("FRONT", distance=4.5)
    window.area.spaces.active.shading.color_type = "TEXTURE"
    yield from window.use_tool()
    pin(*(place(pixel) for pixel in (imported.HEAD, imported.BELLY, imported.LEFT_HAND, imported.RIGHT_HAND)))
    bpy.ops.planar.key_pose()
    bpy.context.scene.frame_set(13)
    bpy.ops.planar.select_pins(action="SELECT", pin=3)
    bpy.ops.planar.drag_pins(offset=(-0.1, 0.25))
    bpy.ops.planar.key_pose()
    bpy.ops.planar.generate_inbetweens()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.wait(0.3)


def state() -> tuple:
    obj = active()
    names = [(block.name, block.frame) for block in obj.data.shape_keys.key_blocks]
    shapes = []
    for block in obj.data.shape_keys.key_blocks:
        shape = np.empty(3 * len(block.data), np.float32)
        block.data.foreach_get("co", shape)
        shapes.append(shape.tobytes())
    pins = [(one.name, one.group, tuple(one.target)) for one in obj.planar.pins]
    return names, shapes, pins, len(obj.data.polygons)


def held() -> np.ndarray:
    """Where the pins are seen, in the world."""
    addon("scene.view.snapshot").forget()
    seen = addon("scene.view.snapshot").of_active(bpy.context)
    return np.array([one.place for one in seen.pins])


def count() -> int:
    return len(active().data.vertices)


def done(window: Window) -> Iterator[None]:
    for _ in range(600):
        if not window.busy:
            break
        yield
    yield from window.wait(0.3)
    assert bpy.context.window_manager.operators[-1].bl_idname == "PLANAR_OT_remesh", window.reports()


def test_a_keyed_drawing_is_remeshed_changed_and_undone(window: Window) -> Iterator[None]:
    yield from keyed_doll(window)
    before, places, first = state(), held(), count()
    window.picture("remesh_before")
    yield from search(window, "Remesh Cutout")
    yield from done(window)
    made = count()
    assert 1100 < made < 1900, window.reports()
    assert np.abs(held() - places).max() < 2e-3  # of a posed drawing; its size is about 1
    window.picture("remesh_after")
    yield from retype(window, "1500", "500", "remesh_redo")
    yield from window.press("RET")
    yield from window.release("RET")
    yield from window.wait(1.0)
    assert count() < 0.7 * made, window.reports()
    assert [pose.name for pose in active().planar.poses] == ["Pose", "Pose.001"]
    yield from window.move(window.pixel((-1.2, 0.0, 0.3)), steps=12)
    yield from window.key("ESC")  # 5.2 leaves the popup open
    yield from window.wait(0.5)
    window.picture("remesh_coarse")
    bpy.context.scene.frame_set(7)
    yield from window.wait(0.2)
    window.picture("remesh_between")
    bpy.context.scene.frame_set(13)
    yield from window.undo()
    yield from window.wait(0.3)
    assert count() == first
    assert state() == before
    yield from window.redo()
    assert count() < 0.7 * made


def test_a_repainted_drawing_is_offered_and_taken_in(window: Window) -> Iterator[None]:
    yield from keyed_doll(window)
    bpy.context.scene.frame_set(1)
    places, first = held(), count()
    path = Path(bpy.path.abspath(bpy.data.images["doll.png"].filepath))
    picture = imported.painted()
    picture[150:210, 60:420] = (0.9, 0.8, 0.1, 1.0)  # a skirt
    imported.save_png(path, picture)
    later = time.time() + 10.0
    os.utime(path, (later, later))
    yield from window.wait(1.2)  # files are looked at once a second
    yield from window.sidebar()
    bpy.context.scene.frame_set(1)
    yield from window.wait(0.3)
    window.picture("remesh_offered")
    yield from window.push("planar.remesh")
    yield from done(window)
    window.picture("remesh_repainted")
    assert abs(count() / first - 1.0) < 0.3
    assert np.abs(held() - places).max() < 1e-5
    low = active().data.shape_keys.reference_key.data
    assert any(
        abs(point.co.x - place((410, 0))[0]) < 0.02 and point.co.y < place((0, 215))[2] for point in low
    ), "the skirt has a mesh"
    yield from go_to(13)
    window.picture("remesh_repainted_posed")
    assert not addon("scene.image.file_state").is_changed(active())
    assert "Error" not in window.reports()
