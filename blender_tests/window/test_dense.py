# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawing of a hundred thousand vertices is dragged as any other."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, pin, pin_data, place, shape, sheet
from harness import Window

SIDE = 317  # vertices
LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def test_a_drag_at_a_hundred_thousand_vertices(window: Window) -> Iterator[None]:
    sheet(columns=SIDE - 1, rows=SIDE - 1, cell=4.0 / (SIDE - 1))
    pin(LEFT, RIGHT)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.use_tool()
    before, pins_before = shape(), pin_data()
    start, end = window.pixel(RIGHT), window.pixel((1.2, 0.0, 0.8))

    yield from window.hover(start)
    yield from window.press()
    yield from window.move(end, steps=6)
    yield from window.settled(60.0)
    held, dragged = (np.argmin(np.linalg.norm(before - at, axis=1)) for at in (LEFT, RIGHT))
    during = shape()
    assert np.linalg.norm(during[dragged] - (1.2, 0.0, 0.8)) < 0.06, "the pin is at the mouse"
    assert np.linalg.norm(during[held] - LEFT) < 0.03
    assert (np.linalg.norm(during - before, axis=1) > 0.05).mean() > 0.5, "all of the drawing follows"
    window.picture("dense")
    yield from window.key("ESC")
    yield from window.release()
    assert np.array_equal(shape(), before)
    assert pin_data() == pins_before

    yield from window.drag(start, end)
    after = shape()
    assert np.allclose(place(1), (1.2, 0.0, 0.8), atol=0.06), place(1)
    assert np.all(after[:, 1] == before[:, 1]), "the depth is kept to the bit"
    assert active().planar.pins[1].has_target
    yield from window.undo()
    assert np.array_equal(shape(), before)
    yield from window.redo()
    assert np.array_equal(shape(), after)
