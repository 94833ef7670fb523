# SPDX-License-Identifier: GPL-3.0-or-later
"""Dragging pins: hover, press, drag, click, several pins, undo and redo."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin_data, place, ready, selected, shape
from harness import Window

LEFT, RIGHT, MIDDLE = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.1, 0.0, 0.05)


def test_a_drag_moves_the_pin_and_the_drawing_follows(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 1.0)))
    after = shape()
    assert selected() == [1]
    assert np.allclose(place(1), (1.5, 0.0, 1.0), atol=0.05), place(1)
    assert np.allclose(place(0), LEFT, atol=0.05), place(0)
    assert 0.5 < moved(before, after) < 2.0
    assert np.all(after[:, 1] == before[:, 1]), "the depth is kept to the bit"
    assert bpy.context.window_manager.operators[-1].bl_idname == "PLANAR_OT_drag_pins"
    window.picture("drag")


def test_undo_and_redo(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, MIDDLE)
    shapes, pins = [shape()], [pin_data()]
    for index, (dx, dz) in enumerate(((0.3, 0.6), (-0.5, -0.4), (0.2, 0.5))):
        x, _, z = place(index)
        yield from window.drag(window.pixel((x, 0, z)), window.pixel((x + dx, 0, z + dz)))
        shapes.append(shape())
        pins.append(pin_data())
        assert moved(shapes[-2], shapes[-1]) > 0.1
    for step in (2, 1, 0):
        yield from window.undo()
        assert np.array_equal(shape(), shapes[step]), f"undo to {step}"
        assert pin_data() == pins[step]
    for step in (1, 2, 3):
        yield from window.redo()
        assert np.array_equal(shape(), shapes[step]), f"redo to {step}"
        assert pin_data() == pins[step]
    x, _, z = place(1)  # pins answer after undo and redo
    yield from window.drag(window.pixel((x, 0, z)), window.pixel((x, 0, z - 0.5)))
    assert moved(shapes[3], shape()) > 0.1


def test_escape_and_right_mouse_restore_every_bit(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.7, 0.0, 0.6)))
    start = place(1)
    before, pins_before = shape(), pin_data()
    for way_out in ("ESC", "RIGHTMOUSE"):
        yield from window.hover(window.pixel(LEFT))
        yield from window.press()
        yield from window.move(window.pixel((-1.0, 0.0, 1.0)), steps=5)
        assert moved(before, shape()) > 0.3
        yield from window.key(way_out)
        yield from window.release()
        assert np.array_equal(shape(), before)
        assert pin_data() == pins_before
        assert active().planar.active_pin == 1
    yield from window.undo()
    assert not np.allclose(place(1), start, atol=0.1), "the cancelled drags are no undo steps"
