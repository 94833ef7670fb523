# SPDX-License-Identifier: GPL-3.0-or-later
"""Dragging in all kinds of views, and while the view changes."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin, place, ready, selected, shape, sheet
from harness import Window, addon
from mathutils import Euler, Quaternion, Vector

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def off(window: Window, index: int, pixel: tuple[int, int]) -> float:
    """How many pixels a pin is from where the mouse took it."""
    return float(np.hypot(*np.subtract(window.pixel(place(index)), pixel)))


def test_a_pin_follows_the_mouse_after_the_view_was_turned(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.5)))
    turns = {
        "seen askew": (Euler((1.0, 0.0, 0.6)).to_quaternion(), "ORTHO"),
        "in perspective": (Euler((1.2, 0.0, -0.4)).to_quaternion(), "PERSP"),
        "from behind": (Euler((1.5, 0.0, 2.9)).to_quaternion(), "PERSP"),
        "upside down": (Euler((-1.4, 0.0, 0.3)).to_quaternion(), "ORTHO"),
    }
    for name, (turn, perspective) in turns.items():
        window.view.view_rotation, window.view.view_perspective = turn, perspective
        yield from window.wait(0.1)
        start = window.pixel(place(1))
        end = (start[0] + 40, start[1] + 30)
        yield from window.drag(start, end)
        assert selected() == [1]
        assert off(window, 1, end) < 3.0, name
        assert np.all(shape()[:, 1] == 0.0), "it stays in its plane"


def test_a_camera_view(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    sheet_object = active()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (2.0, -9.0, 1.0), Euler((1.45, 0.1, 0.2))
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.objects.active = sheet_object
    bpy.ops.ed.undo_push(message="Camera")
    window.view.view_perspective = "CAMERA"
    yield from window.wait(0.1)
    start = window.pixel(RIGHT)
    end = (start[0] - 30, start[1] + 50)
    yield from window.drag(start, end)
    assert off(window, 1, end) < 3.0


def test_a_turned_stretched_object(window: Window) -> Iterator[None]:
    obj = sheet()
    obj.rotation_euler, obj.scale, obj.location = (0.4, 0.7, 1.9), (1.5, 1.0, 0.5), (0.3, -0.2, 0.4)
    bpy.context.view_layer.update()
    spot = obj.matrix_world @ Vector((1.5, 0.0, 0.5))
    pin(obj.matrix_world @ Vector(LEFT), spot)
    bpy.ops.ed.undo_push(message="Test Scene")
    window.view.view_rotation = obj.matrix_world.to_quaternion() @ Quaternion((0.7071068, 0.7071068, 0, 0))
    window.view.view_perspective, window.view.view_distance = "ORTHO", 9.0
    window.view.view_location = obj.location
    yield from window.use_tool()
    start = window.pixel(spot)
    end = (start[0] + 20, start[1] + 60)
    yield from window.drag(start, end)
    assert off(window, 1, end) < 3.0
    assert np.abs(shape()[:, 1]).max() < 1e-6, "written back through the object's own transform"


def test_a_layer_behind_the_first_in_perspective(window: Window) -> Iterator[None]:
    back = sheet("Back", columns=8, rows=4, at=(0.0, 3.0, 1.5))
    front = sheet("Front", columns=8, rows=4)
    back.select_set(True)
    with window.context():
        bpy.ops.object.join("EXEC_DEFAULT", True)
    pin((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), (-0.5, 3.0, 1.5), (0.5, 3.0, 1.5))
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look(distance=5.0)
    window.view.view_perspective = "PERSP"
    yield from window.use_tool()
    start = window.pixel((0.5, 3.0, 1.5))
    end = (start[0] + 30, start[1] - 50)
    yield from window.drag(start, end)
    assert selected() == [3]
    assert off(window, 3, end) < 3.0, "the mouse moves in the plane of the pressed pin's layer"
    assert np.allclose(place(1), (0.5, 0.0, 0.0), atol=1e-3)
    assert active() == front


def test_a_mouse_beyond_the_horizon_moves_nothing(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    window.view.view_rotation = Euler((0.26, 0.0, 0.0)).to_quaternion()  # 15 degrees to the plane
    window.view.view_perspective, window.area.spaces.active.lens = "PERSP", 18.0
    yield from window.wait(0.1)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    region = window.region()
    x, y = window.mouse
    yield from window.move((x + 10, y + 10), steps=2)
    yield from window.settled()
    before = shape()
    horizon = 0
    for end in (region.y + 5, region.y + region.height - 40):
        yield from window.move((x + 10, end))
        yield from window.settled()
        horizon += np.array_equal(shape(), before)
        yield from window.move((x + 10, y + 10))
        yield from window.settled()
        before = shape()
    yield from window.key("ESC")
    yield from window.release()
    assert horizon == 1, "one end of the screen is beyond the horizon, and only one"


def test_an_edge_on_view_is_refused(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, (0.0, 0.0, 0.7))
    yield from window.look("RIGHT")
    before = shape()
    yield from window.drag(window.pixel((0.0, 0.0, 0.7)), window.pixel((0.0, 0.5, 0.3)))
    assert window.busy == []
    assert np.array_equal(shape(), before)
    yield from window.key("A")
    yield from window.key("G")
    assert window.busy == []
    yield from window.look("FRONT")
    yield from window.drag(window.pixel((0.0, 0.0, 0.7)), window.pixel((0.2, 0.0, 0.9)))
    assert moved(before, shape()) > 0.1


def test_navigating_during_a_drag_moves_nothing_by_itself(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel((1.5, 0.0, 0.5)), steps=4)
    yield from window.settled()
    halfway, distance, turn = shape(), window.view.view_distance, window.view.view_rotation.copy()
    x, y = window.mouse
    yield from window.press("MIDDLEMOUSE")
    assert window.busy[0] == "VIEW3D_OT_rotate", window.busy
    yield from window.move((x + 60, y + 30), steps=4)
    yield from window.release("MIDDLEMOUSE")
    yield from window.event("WHEELUPMOUSE", "PRESS")
    assert window.busy == ["PLANAR_OT_drag_pins"]
    assert window.view.view_rotation.rotation_difference(turn).angle > 0.05
    assert window.view.view_distance < distance
    assert np.array_equal(shape(), halfway)
    yield from window.move((x + 61, y + 30))
    yield from window.settled()
    assert moved(halfway, shape()) < 0.02, "the drag goes on from where it was"
    pixel = window.pixel(place(1))
    x, y = window.mouse
    yield from window.move((x + 20, y + 20), steps=3)
    yield from window.settled()
    assert off(window, 1, (pixel[0] + 20, pixel[1] + 20)) < 5.0
    yield from window.key("ESC")
    yield from window.release()
    assert np.array_equal(shape(), before)


def test_two_windows_show_and_drag_their_own_drawings(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    with window.context():
        bpy.ops.wm.window_new_main()
    yield from window.wait(0.3)
    second = bpy.context.window_manager.windows[1]
    second.scene = bpy.data.scenes.new("Second")
    with bpy.context.temp_override(window=second):
        other = sheet("Other", columns=6, rows=4, at=(0.0, 0.0, 1.0))
        pin((0.5, 0.0, 1.0))
    yield from window.wait(0.3)
    untouched = shape(other)
    views = [
        (each, next(area for area in each.screen.areas if area.type == "VIEW_3D"))
        for each in (window.window, second)
    ]

    def seen() -> list[list[np.ndarray]]:
        """Where each window shows pins, after both have been drawn."""
        shown = []
        for each, area in views:
            with bpy.context.temp_override(window=each, area=area):
                shown.append(
                    [mark.place for mark in addon("scene.view.snapshot").of_active(bpy.context).pins]
                )
        return shown

    def check() -> None:
        first, others = seen()
        assert len(first) == 2
        assert len(others) == 1, "while one is dragged, the other window is drawn as well"
        assert np.allclose(others[0], (0.5, 0.0, 1.0), atol=1e-5), others

    check()
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    end = window.pixel((1.7, 0.0, 0.5))
    for share in (0.25, 0.5, 0.75, 1.0):
        x, y = window.pixel((1.5 + 0.2 * share, 0.0, 0.5 * share))
        yield from window.move((x, y))
        for _, area in views:
            area.tag_redraw()
        yield from window.settled()
        check()
    yield from window.release()
    yield from window.settled()
    assert off(window, 1, end) < 3.0
    check()
    assert np.array_equal(shape(other), untouched)
    with bpy.context.temp_override(window=second):
        bpy.ops.wm.window_close()
    yield from window.wait(0.2)
