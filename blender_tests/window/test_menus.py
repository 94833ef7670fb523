# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on found as anything in Blender is found: by F3 and in the Object menu, with any tool."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, ready, selected, shape
from harness import EXTENSION, Window
from poses import LEFT, RIGHT


def search(window: Window, text: str) -> Iterator[None]:
    """F3, the words, Enter."""
    yield from window.hover(window.pixel((0.0, 0.0, 1.5)))
    yield from window.key("F3")
    yield from window.wait(0.3)
    x, y = window.mouse
    for letter in text:
        kind = "SPACE" if letter == " " else letter.upper()
        shift = letter.isupper()
        window.window.event_simulate(type=kind, value="PRESS", unicode=letter, x=x, y=y, shift=shift)
        yield
        yield from window.release(kind)
    yield from window.wait(0.3)
    window.picture("search")
    yield from window.key("RET")
    yield from window.wait(0.2)


def test_operators_are_found_by_f3_with_any_tool(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.use_tool("builtin.select_box")
    yield from search(window, "Select All Pins")
    assert selected() == [0, 1]
    yield from search(window, "Key Pose")
    assert len(active().planar.poses) == 1
    yield from search(window, "Bake to Relative")
    assert not active().planar.poses
    assert len(active().data.shape_keys.key_blocks) > 1
    yield from search(window, "Add Pin at")
    assert len(active().planar.pins) == 3


def test_pins_are_dragged_from_the_menu_without_the_pose_tool(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.use_tool("builtin.select_box")
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    before = shape()
    yield from search(window, "Move Pins")
    assert window.busy == ["PLANAR_OT_drag_pins"]
    x, y = window.mouse
    yield from window.move((x, y + 60), steps=4)
    yield from window.confirm()
    assert np.abs(shape() - before).max() > 0.2


def test_pins_look_as_the_preferences_say(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    place = window.pixel(LEFT)
    yield from window.hover(window.pixel((0.0, 0.0, 1.5)))
    yield from window.wait(0.3)
    preferences = bpy.context.preferences.addons[EXTENSION].preferences

    def green() -> int:
        return sum(g > 200 and r < 60 and b < 60 for r, g, b in window.colours(place, 14))

    assert green() == 0
    preferences.pin_colour = (0.0, 1.0, 0.0, 1.0)
    yield from window.wait(0.3)
    small = green()
    assert small > 20
    preferences.pin_size = 10.0
    yield from window.wait(0.3)
    assert green() > 1.8 * small
    window.picture("large_pins")
    for name in ("pin_colour", "pin_size"):
        preferences.property_unset(name)
