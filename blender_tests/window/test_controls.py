# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel sets while drawings are posed: pins on and off, their weights, the method."""

from collections.abc import Iterator

import numpy as np
from cutouts import active, moved, place, ready, shape
from harness import Window

LEFT, RIGHT, MIDDLE = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.0)


def settled(window: Window) -> Iterator[None]:
    """Wait until no drag is on."""
    for _ in range(100):
        yield from window.wait(0.1)
        if not window.busy:
            return
    raise AssertionError(window.busy)


def sidebar(window: Window) -> Iterator[None]:
    window.area.spaces.active.show_region_ui = True
    yield from window.wait(0.5)
    window.region("UI").active_panel_category = "Planar"
    window.region("UI").tag_redraw()
    yield from window.wait(0.3)


def in_list(window: Window, row: int, from_right: int) -> tuple[int, int]:
    """A place in a row of the pin list, so many pixels from the sidebar's right edge."""
    region = window.region("UI")
    return region.x + region.width - from_right, region.y + region.height - 51 - 21 * row


def test_a_pin_is_switched_off_and_weighed_in_the_list(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, MIDDLE, RIGHT)
    yield from sidebar(window)
    window.picture("controls-list")
    yield from window.click(in_list(window, 1, 86))
    pins = active().planar.pins
    assert [pin.enabled for pin in pins] == [True, False, True], "the second row's pin icon"
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.0, 0.0, 1.2)))
    yield from settled(window)
    free = place(1)
    assert np.linalg.norm(free - MIDDLE) > 0.1, "a pin that is off holds nothing"
    yield from window.click(in_list(window, 1, 86))
    assert active().planar.pins[1].enabled
    yield from window.drag(window.pixel(place(2)), window.pixel((1.4, 0.0, 0.4)))
    yield from settled(window)
    assert np.allclose(place(1), free, atol=0.02), "on again, it holds where the drawing is"
    yield from window.undo()
    yield from window.undo()
    assert not active().planar.pins[1].enabled, "switching is undone like any setting"


def test_a_light_pin_gives_way(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, MIDDLE, RIGHT)
    pull, gaps = (2.4, 0.0, 0.0), []
    for weight in (1.0, 0.001):
        active().planar.pins[2].weight = weight
        yield from window.drag(window.pixel(place(2)), window.pixel(pull))
        yield from settled(window)
        gaps.append(float(np.linalg.norm(place(2) - pull)))
        yield from window.undo()
    assert gaps[1] > 2.0 * gaps[0] + 0.01, gaps


def test_the_method_is_changed_between_drags(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, MIDDLE, RIGHT)
    rest = shape()
    yield from window.drag(window.pixel(RIGHT), window.pixel((0.9, 0.0, 1.2)), steps=12)
    yield from settled(window)
    held = shape()
    active().planar.method = "AKVF"
    yield from window.drag(window.pixel(place(2)), window.pixel((1.2, 0.0, -0.8)), steps=12)
    yield from settled(window)
    assert moved(held, shape()) > 0.5
    active().planar.method = "HOLD"
    yield from window.drag(window.pixel(place(2)), window.pixel(RIGHT), steps=12)
    yield from settled(window)
    # The mouse is led to a pixel, 0.02 wide here.
    assert moved(rest, shape()) < 0.06, "pins that are back bring the drawing back"
