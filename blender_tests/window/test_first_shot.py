# SPDX-License-Identifier: GPL-3.0-or-later
"""A first shot, as docs/first_shot.md has it: an imported drawing, an orthographic camera, mouse and keys."""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import bpy
import imported
import numpy as np
from cutouts import active, selected
from harness import Window, addon
from mathutils import Vector
from poses import pin_place, shown

UNITS = 0.01  # of a pixel of the drawing
LAST = 240  # frame: ten seconds
BELLY, HEAD, LEFT, RIGHT, LEFT_FOOT, RIGHT_FOOT = range(6)  # the pins, in the order in which they are added


def on_stage(window: Window) -> Iterator[None]:
    """What is there before the work begins: the drawing as it was imported, scaled, and the shot's camera."""
    bpy.context.scene.frame_end = LAST
    obj = imported.import_doll(Path(tempfile.mkdtemp()))
    obj.scale = (UNITS,) * 3
    obj.location = (-imported.WIDTH / 2 * UNITS, 0.0, 0.0)
    data = bpy.data.cameras.new("Camera")
    data.type, data.ortho_scale = "ORTHO", 14.0
    camera = bpy.data.objects.new("Camera", data)
    camera.location, camera.rotation_euler = (0.0, -20.0, 3.6), (np.pi / 2, 0.0, 0.0)
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    shading = window.area.spaces.active.shading
    shading.light, shading.color_type = "FLAT", "TEXTURE"
    bpy.ops.ed.undo_push(message="Stage")
    yield from window.wait(0.3)


def at(obj: bpy.types.Object, pixel: Sequence[float]) -> tuple[float, float, float]:
    """A pixel of the drawing in the world."""
    x, y, z = obj.matrix_world @ Vector((*pixel[:2], 0.0))
    return (x, y, z)


def take_the_tool(window: Window) -> Iterator[None]:
    """Click the Pose tool in the toolbar."""
    region = window.region("TOOLS")
    for y in range(region.y + region.height - 10, region.y, -12):
        yield from window.move((region.x + region.width // 2, y))
        bpy.context.window_manager.clipboard = ""
        yield from window.key("C", ctrl=True)
        if "planar.pose_tool" in bpy.context.window_manager.clipboard:
            yield from window.release("LEFT_CTRL")
            yield from window.click((region.x + region.width // 2, y))
            return
    raise AssertionError("the toolbar shows no Pose tool")


def go_to(window: Window, frame: int) -> Iterator[None]:
    """Click a frame in the timeline."""
    area = next(area for area in window.window.screen.areas if area.type == "DOPESHEET_EDITOR")
    region = next(region for region in area.regions if region.type == "WINDOW")
    for _ in range(3):  # a pixel of the timeline may be less than a frame
        x = region.x + region.view2d.view_to_region(frame, 0, clip=False)[0]
        yield from window.click((x, region.y + region.height - 12))
        yield from window.wait(0.2)
    now = bpy.context.scene.frame_current
    yield from window.hover(window.pixel((0.0, 0.0, 3.0)))
    for _ in range(abs(frame - now)):
        yield from window.key("RIGHT_ARROW" if frame > now else "LEFT_ARROW")
    assert bpy.context.scene.frame_current == frame


def pulled(window: Window, index: int, dx: float, dz: float) -> Iterator[None]:
    """Drag a pin with the mouse."""
    x, y, z = at(active(), pin_place(index))
    yield from window.drag(window.pixel((x, y, z)), window.pixel((x + dx, y, z + dz)))


def flipped(obj: bpy.types.Object) -> int:
    drawing = addon("scene.objects.cutout_object").read_cutout(obj)
    found = addon("native").distortion(drawing.cutout.rest, drawing.positions, drawing.cutout.triangles)
    return int(found.flipped)


def through_the_camera(window: Window) -> Iterator[None]:
    yield from window.hover(window.pixel((0.0, 0.0, 3.0)))
    yield from window.key("NUMPAD_0")
    yield from window.wait(0.3)


def pins_put(window: Window) -> Iterator[None]:
    """A pin in the belly, the head, both hands and both feet, by Ctrl-click."""
    doll = imported
    for pixel in (doll.BELLY, doll.HEAD, doll.LEFT_HAND, doll.RIGHT_HAND, doll.LEFT_FOOT, doll.RIGHT_FOOT):
        yield from window.click(window.pixel(at(active(), pixel)), ctrl=True)


def arms_up(window: Window) -> Iterator[None]:
    yield from pulled(window, LEFT, 0.5, 1.9)
    yield from pulled(window, RIGHT, -0.4, 2.1)


def squat(window: Window) -> Iterator[None]:
    """The belly goes down, an arm falls, the feet stand."""
    yield from pulled(window, BELLY, 0.0, -0.9)
    yield from pulled(window, LEFT, -0.8, -2.4)


def jump(window: Window, dx: str, dz: str) -> Iterator[None]:
    """All pins at once, by keys and typed numbers."""
    yield from window.key("A")
    for axis, number in (("X", dx), ("Z", dz)):
        yield from window.key("G")
        yield from window.key(axis)
        yield from window.type(number)
        yield from window.confirm()


def nod(window: Window) -> Iterator[None]:
    yield from pulled(window, HEAD, 0.9, -0.3)


def poses_keyed(window: Window) -> Iterator[None]:
    """Five poses, each made at its frame and keyed with I."""
    for frame, pose in (
        (1, arms_up(window)),
        (60, squat(window)),
        (120, jump(window, "1.2", "0.8")),
        (180, nod(window)),
        (LAST, jump(window, "-1.2", "-0.8")),
    ):
        yield from go_to(window, frame)
        yield from pose
        yield from window.key("I")
        assert [item.frame for item in active().planar.poses][-1] == frame


def test_ten_seconds_by_mouse_and_keys(window: Window) -> Iterator[None]:
    yield from on_stage(window)
    obj = active()
    transform, rest = obj.matrix_world.copy(), shown()
    yield from through_the_camera(window)
    assert window.view.view_perspective == "CAMERA"
    yield from take_the_tool(window)
    assert window.tool == "planar.pose_tool"
    yield from pins_put(window)
    assert len(obj.planar.pins) == 6
    yield from poses_keyed(window)
    assert selected() == [0, 1, 2, 3, 4, 5]
    keyed = {}
    for frame in (1, 60, 120, 180, LAST):
        bpy.context.scene.frame_set(frame)
        keyed[frame] = shown()
    assert obj.matrix_world == transform, "nothing fell through to the object"
    yield from window.key("N")
    yield from window.sidebar()
    yield from window.push("planar.generate_inbetweens")
    while window.busy:
        yield from window.wait(0.1)

    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    steps, before = [], keyed[1]
    for frame in range(1, LAST + 1):
        bpy.context.scene.frame_set(frame)
        now = shown()
        assert flipped(obj) == 0, frame
        if frame in keyed:
            assert np.abs(now - keyed[frame]).max() < 1e-5 * size, frame
        steps.append(np.abs(now - before).max() / size)
        before = now
    assert 0.001 < max(steps) < 0.05, "it moves, and never jumps"
    feet = []
    for frame in range(1, 61):
        bpy.context.scene.frame_set(frame)
        feet.append([pin_place(LEFT_FOOT), pin_place(RIGHT_FOOT)])
    assert np.ptp(np.array(feet), axis=0).max() < 0.005 * size, "the feet stand through the squat"
    window.picture("first_shot")

    # Blender plays it.
    yield from go_to(window, 1)
    yield from window.key("SPACE")
    yield from window.wait(1.0)
    yield from window.key("SPACE")
    assert bpy.context.scene.frame_current > 1
    assert window.busy == []
