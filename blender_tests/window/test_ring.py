# SPDX-License-Identifier: GPL-3.0-or-later
"""The ring about selected pins, by which they are turned."""

import math
from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin_data, place, ready, selected, shape
from harness import Window

LEFT, RIGHT, TOP = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.7)
RADIUS = 36  # pixels at a UI scale of 1, as the add-on draws it


def on_ring(centre: tuple[int, int], degrees: float) -> tuple[int, int]:
    angle = math.radians(degrees)
    return round(centre[0] + RADIUS * math.cos(angle)), round(centre[1] + RADIUS * math.sin(angle))


def white(window: Window, where: tuple[int, int]) -> int:
    return sum(min(colour) > 245 for colour in window.colours(where, 6))


def orange(window: Window, where: tuple[int, int]) -> int:
    return sum(r > 220 and 90 < g < 190 and b < 90 for r, g, b in window.colours(where, 6))


def turn(window: Window, centre: tuple[int, int], degrees: float, start: float = 90.0) -> Iterator[None]:
    """Press the ring and lead the mouse round its centre, well outside of it; the button stays down."""
    yield from window.hover(on_ring(centre, start))
    yield from window.press()
    for step in range(1, 9):
        angle = math.radians(start + degrees * step / 8)
        place = centre[0] + 90 * math.cos(angle), centre[1] + 90 * math.sin(angle)
        yield from window.move((round(place[0]), round(place[1])))


def patch(window: Window) -> Iterator[None]:
    """A sheet held at the left, with a selected patch of four vertices about (1, 0, 0)."""
    yield from ready(window, LEFT)
    obj = active()
    rows = [v.index for v in obj.data.vertices if abs(v.co.x - 1.0) < 0.3 and abs(v.co.z) < 0.3]
    group = obj.vertex_groups.new(name="Hand")
    group.add(rows, 1.0, "REPLACE")
    bpy.ops.planar.add_pin_from_group(group="Hand", kind="PATCH")
    bpy.ops.ed.undo_push(message="Patch")
    yield from window.wait(0.2)


def test_a_patch_is_turned_by_its_ring(window: Window) -> Iterator[None]:
    yield from patch(window)
    assert selected() == [1]
    centre = window.pixel((1.0, 0.0, 0.0))
    before, pins_before = shape(), pin_data()
    yield from turn(window, centre, 50.0)
    assert window.busy == ["PLANAR_OT_rotate_pins"]
    window.picture("ring-turning")
    yield from window.release()
    yield from window.wait(0.5)
    assert window.busy == []
    assert abs(math.degrees(active().planar.pins[1].angle) - 50.0) < 3.0
    assert moved(before, shape()) > 0.1
    assert np.allclose(place(1), (1.0, 0.0, 0.0), atol=0.05), "it is turned about its centre"
    yield from window.undo()
    assert np.array_equal(shape(), before), "it is one undo step"
    assert pin_data() == pins_before


def test_escape_restores_every_bit(window: Window) -> Iterator[None]:
    yield from patch(window)
    before, pins_before = shape(), pin_data()
    yield from turn(window, window.pixel((1.0, 0.0, 0.0)), 30.0)
    yield from window.wait(0.2)
    assert moved(before, shape()) > 0.05
    yield from window.key("ESC")
    yield from window.release()
    assert window.busy == []
    assert np.array_equal(shape(), before)
    assert pin_data() == pins_before


def test_a_click_on_the_ring_changes_nothing(window: Window) -> Iterator[None]:
    yield from patch(window)
    before, pins_before = shape(), pin_data()
    yield from window.click(on_ring(window.pixel((1.0, 0.0, 0.0)), 200.0))
    assert window.busy == []
    assert np.array_equal(shape(), before)
    assert pin_data() == pins_before


def test_the_selection_is_turned_as_a_whole(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    yield from window.click(window.pixel(LEFT))
    yield from window.click(window.pixel(RIGHT), shift=True)
    centre = window.pixel((0.0, 0.0, 0.0))
    yield from turn(window, centre, 20.0)
    yield from window.release()
    yield from window.wait(0.5)
    angle = math.radians(20.0)
    expected = 1.5 * np.array((math.cos(angle), 0.0, math.sin(angle)))
    assert np.allclose(place(1), expected, atol=0.1), place(1)
    assert np.allclose(place(0), -expected, atol=0.1), place(0)
    assert selected() == [0, 1]


def test_the_ring_is_there_for_what_can_be_turned(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    top = on_ring(window.pixel((0.0, 0.0, 0.0)), 90.0)
    own = on_ring(window.pixel(RIGHT), 90.0)
    yield from window.click(window.pixel(RIGHT))
    assert orange(window, own) == 0, "a point alone cannot be turned"
    yield from window.click(window.pixel(LEFT), shift=True)
    yield from window.hover(window.pixel((3.0, 0.0, -2.0)))
    assert orange(window, top) > 20
    assert white(window, top) == 0
    yield from window.hover(top)
    assert white(window, top) > 20, "it lights up under the mouse"
    active().planar.pins[0].enabled = False
    window.area.tag_redraw()
    yield from window.hover(window.pixel((3.0, 0.0, -2.0)))
    assert orange(window, top) == 0, "pins that are off are not turned"


def test_pins_go_before_the_ring(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    centre = window.pixel((0.0, 0.0, 0.0))
    below = on_ring(centre, -90.0)
    spot = (0.0, 0.0, -(centre[1] - below[1]) * 1.5 / (window.pixel(RIGHT)[0] - centre[0]))
    bpy.ops.planar.add_pin(location=spot)
    bpy.ops.planar.select_pins(action="NONE")
    bpy.ops.ed.undo_push(message="Pin on the Ring")
    yield from window.click(window.pixel(LEFT))
    yield from window.click(window.pixel(RIGHT), shift=True)
    yield from window.drag(window.pixel(spot), window.pixel((0.2, 0.0, -0.6)))
    assert bpy.context.window_manager.operators[-1].bl_idname == "PLANAR_OT_drag_pins"
    assert selected() == [2]
    assert np.allclose(place(2), (0.2, 0.0, -0.6), atol=0.1), place(2)


def test_the_ring_is_pressed_while_the_last_turn_settles(window: Window) -> Iterator[None]:
    yield from patch(window)
    centre = window.pixel((1.0, 0.0, 0.0))
    yield from turn(window, centre, 40.0)
    yield from window.release()
    yield from window.move(on_ring(centre, 200.0))  # at once, so that nothing has lit up
    yield from window.press()
    for degrees in (200.0, 210.0, 220.0, 230.0):
        yield from window.move(on_ring(centre, degrees))
    yield from window.release()
    yield from window.wait(1.0)
    assert selected() == [1]
    assert abs(math.degrees(active().planar.pins[1].angle) - 70.0) < 4.0


def test_the_ring_is_as_large_as_the_interface(window: Window) -> Iterator[None]:
    yield from patch(window)
    view = bpy.context.preferences.view
    view.ui_scale = 2.0
    try:
        yield from window.wait(0.4)
        x, y = window.pixel((1.0, 0.0, 0.0))
        yield from window.hover((x, y + 2 * RADIUS))
        assert white(window, (x, y + 2 * RADIUS)) > 20
        yield from window.hover((x, y + RADIUS))
        assert white(window, (x, y + 2 * RADIUS)) == 0
    finally:
        view.ui_scale = 1.0
    yield from window.wait(0.3)
