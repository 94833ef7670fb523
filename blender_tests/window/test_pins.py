# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins under the mouse: hover, selecting, adding, deleting, and keys when there is nothing to act on."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, moved, pin, place, ready, selected, shape, sheet
from harness import Window

LEFT, RIGHT, TOP = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.7)
EMPTY = (3.0, 0.0, -2.0)


def white(window: Window, where: tuple[int, int]) -> int:
    return sum(min(colour) > 245 for colour in window.colours(where))


def test_a_pin_lights_up_under_the_mouse(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    left, right = window.pixel(LEFT), window.pixel(RIGHT)
    yield from window.hover(window.pixel(EMPTY))
    assert white(window, left) == white(window, right) == 0
    yield from window.hover(left)
    assert white(window, left) > 20
    assert white(window, right) == 0
    yield from window.hover(right)
    assert white(window, left) == 0
    assert white(window, right) > 20


def test_a_pin_grows_with_the_interface(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    view = bpy.context.preferences.view
    for scale, lit in ((1.0, False), (2.0, True)):
        view.ui_scale = scale
        try:
            yield from window.wait(0.3)
            x, y = window.pixel(LEFT)
            yield from window.hover((x, y + 18))  # beyond the reach of 12 pixels, within that of 24
            assert (white(window, (x, y)) > 20) == lit, f"at a scale of {scale}"
        finally:
            view.ui_scale = 1.0
    yield from window.wait(0.3)


def test_clicks_select(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    before = shape()
    yield from window.click(window.pixel(LEFT))
    assert selected() == [0]
    yield from window.click(window.pixel(RIGHT), shift=True)
    assert selected() == [0, 1]
    yield from window.click(window.pixel(LEFT), shift=True)
    assert selected() == [1]
    yield from window.click(window.pixel(TOP))
    assert selected() == [2]
    yield from window.undo()
    assert selected() == [1], "a click that selects is an undo step"
    yield from window.undo()
    assert selected() == [0, 1]
    yield from window.redo()
    assert selected() == [1]
    yield from window.key("A")
    assert selected() == [0, 1, 2]
    yield from window.click(window.pixel(EMPTY), shift=True)
    assert selected() == [0, 1, 2]
    yield from window.click(window.pixel(EMPTY))
    assert selected() == []
    yield from window.undo()
    assert selected() == [0, 1, 2]
    yield from window.click(window.pixel((0.75, 0.0, -0.5)))
    assert selected() == [], "the mesh beside the pins is nothing, too"
    assert np.array_equal(shape(), before)


def test_what_is_selected_and_switched_off_is_drawn_at_once(window: Window) -> Iterator[None]:
    """Blender draws nothing anew for what a script sets of pins."""
    yield from ready(window, LEFT, RIGHT)
    yield from window.sidebar()
    yield from window.hover(window.pixel((0.0, 0.0, -2.0)))
    yield from window.wait(0.3)
    right, plain = window.pixel(RIGHT), window.colours(window.pixel(RIGHT))
    yield from window.key("A")
    yield from window.wait(0.2)
    chosen = window.colours(right)
    assert chosen != plain, "by a key, with the mouse far away"
    yield from window.key("H")
    yield from window.wait(0.2)
    assert window.colours(right) != chosen, "it is off"
    region = window.region("UI")
    names = (region.x + region.width // 3, region.y + region.height - 70)  # of the list of pins
    bare = window.colours(names, 50)
    yield from window.click(window.pixel(LEFT))
    yield from window.wait(0.2)
    assert window.colours(names, 50) != bare, "the list tells which one is active"


def test_a_pressed_pin_takes_the_selected_ones_along(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    yield from window.click(window.pixel(LEFT))
    yield from window.click(window.pixel(RIGHT), shift=True)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.5)))
    assert selected() == [0, 1]
    assert abs(place(0)[2] - 0.5) < 0.1, place(0)
    assert abs(place(1)[2] - 0.5) < 0.1, place(1)
    yield from window.drag(window.pixel(TOP), window.pixel((0.2, 0.0, 0.9)))
    assert selected() == [2], "a pin that is not selected moves alone"
    assert abs(place(0)[2] - 0.5) < 0.1


def test_ctrl_click_adds_a_pin_inside_a_face(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    spot = (0.61, 0.0, 0.33)
    yield from window.click(window.pixel(spot), ctrl=True)
    assert len(active().planar.pins) == 2
    assert selected() == [1]
    assert np.allclose(place(1), spot, atol=0.03), place(1)
    yield from window.drag(window.pixel(spot), window.pixel((0.61, 0.0, 1.0)))
    assert np.allclose(place(1), (0.61, 0.0, 1.0), atol=0.1), place(1)
    yield from window.undo()
    yield from window.undo()
    assert len(active().planar.pins) == 1
    assert len(active().vertex_groups) == 1
    yield from window.redo()
    assert len(active().planar.pins) == 2
    yield from window.drag(window.pixel(spot), window.pixel((0.61, 0.0, 0.7)))
    assert np.allclose(place(1), (0.61, 0.0, 0.7), atol=0.1), "a pin that came back by redo is dragged"
    yield from window.click(window.pixel(EMPTY), ctrl=True)
    assert len(active().planar.pins) == 2, "there is no mesh there"


def test_x_deletes_pins_and_nothing_else(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    name = active().name
    yield from window.click(window.pixel(RIGHT))
    yield from window.key("X")
    assert [item.name for item in active().planar.pins] == ["Pin", "Pin.002"]
    assert len(active().vertex_groups) == 2
    yield from window.key("X")  # nothing is selected now
    yield from window.key("DEL")
    assert name in bpy.data.objects
    assert len(active().planar.pins) == 2
    yield from window.click(window.pixel(LEFT))
    yield from window.key("DEL")
    yield from window.click(window.pixel(TOP))
    yield from window.key("X")
    assert len(active().planar.pins) == 0
    for key in ("X", "DEL"):  # no pins at all
        yield from window.key(key)
        assert name in bpy.data.objects, key
    bpy.ops.object.camera_add("EXEC_DEFAULT", True)  # True: with an undo step, as from a menu
    camera = active().name
    for key in ("X", "DEL"):  # and no mesh
        yield from window.key(key)
        assert camera in bpy.data.objects, key
    yield from window.undo()
    assert camera not in bpy.data.objects


def test_g_and_r_without_selected_pins_move_nothing(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.hover(window.pixel(EMPTY))
    before = shape()
    for key in ("G", "R"):
        yield from window.key(key)
        assert window.busy == [], f"{key} has started {window.busy}"
        yield from window.move(window.pixel((2.0, 0.0, 1.0)), steps=2)
    assert np.array_equal(shape(), before)
    assert tuple(active().location) == (0, 0, 0)
    assert tuple(active().rotation_euler) == (0, 0, 0)
    bpy.ops.object.camera_add("EXEC_DEFAULT", True)
    yield from window.key("G")
    assert window.busy == []


def test_a_click_on_another_layer_makes_it_active(window: Window) -> Iterator[None]:
    back = sheet("Back", at=(0.0, 1.0, 0.0))
    pin((-1.5, 1.0, 0.0))
    front = sheet("Front", columns=4, rows=4, at=(1.0, 0.0, 1.0))
    pin((1.0, 0.0, 1.0))
    activate(back)
    yield from window.look()
    yield from window.use_tool()
    yield from window.click(window.pixel((1.2, 0.0, 1.2)))
    assert active() == front
    assert [obj.name for obj in bpy.context.view_layer.objects if obj.select_get()] == ["Front"]
    before = shape()
    yield from window.drag(window.pixel((1.0, 0.0, 1.0)), window.pixel((1.5, 0.0, 1.0)))
    assert moved(before, shape()) > 0.4, "the pins of the layer that was clicked are there to be dragged"
    yield from window.click(window.pixel((-1.0, 0.0, -0.5)))
    assert active().name == "Back"
    yield from window.undo()
    assert active().name == "Front"
    bpy.data.objects["Back"].hide_select = True
    yield from window.click(window.pixel((-1.0, 0.0, -0.5)))
    assert active().name == "Front", "a layer that cannot be selected is not clicked"
