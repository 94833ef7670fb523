# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints of parts, as they are seen and used in the Pose tool."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, selected, shape, sheet
from harness import Window

JOINT, LEFT = (0.12, 0.0, 0.0), (-1.5, 0.0, 0.0)
BESIDE = (1.5, 0.0, 0.0)  # on the one part alone


def two_parts() -> bpy.types.Object:
    """A sheet and a strip that lies on its right end, as one drawing."""
    left = sheet("Left", columns=10, rows=4, at=(-1.0, 0.0, 0.0))
    right = sheet("Right", columns=10, rows=2, at=(1.25, -0.05, 0.0))
    activate(left)
    right.select_set(True)
    bpy.ops.object.join()
    return left


def seen(window: Window) -> Iterator[None]:
    """They are active, and seen by the Pose tool, in an undo step of their own."""
    activate(two_parts())
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look("FRONT")
    yield from window.use_tool()


def ring(window: Window, where: tuple[int, int]) -> float:
    """How much the colours about a place vary: a ring has a rim."""
    colours = np.array(list(window.colours(where)), float)
    return float(colours.std())


def kinds() -> list[str]:
    return [pin.kind for pin in bpy.context.object.planar.pins]


def test_joints_are_added_seen_selected_and_removed(window: Window) -> Iterator[None]:
    yield from seen(window)
    bare = ring(window, window.pixel(JOINT))
    yield from window.click(window.pixel(JOINT), shift=True, ctrl=True)
    assert kinds() == ["HINGE"]
    yield from window.hover(window.pixel((-1.5, 0.0, -1.5)))
    assert ring(window, window.pixel(JOINT)) > bare + 5.0, "a joint is drawn"
    window.picture("joint")
    yield from window.click(window.pixel(BESIDE), shift=True, ctrl=True)
    assert kinds() == ["HINGE"], "where no other part lies there is no joint"
    yield from window.click(window.pixel(LEFT), ctrl=True)
    assert kinds() == ["HINGE", "POINT"]
    yield from window.click(window.pixel(JOINT))
    assert selected() == [0], "a click selects a joint"
    before = shape()
    yield from window.drag(window.pixel(JOINT), window.pixel((0.5, 0.0, 0.5)))
    assert np.array_equal(shape(), before), "a joint is no handle"
    yield from window.key("X")
    assert kinds() == ["POINT"]
    yield from window.undo()
    assert kinds() == ["HINGE", "POINT"]


def test_a_pin_takes_what_hangs_on_its_part_along(window: Window) -> Iterator[None]:
    yield from seen(window)
    bpy.ops.planar.attach()
    bpy.ops.planar.add_pin(location=LEFT)
    bpy.ops.ed.undo_push(message="Attached")
    yield from window.sidebar()
    bpy.context.object.planar.active_pin = 0
    yield from window.wait(0.3)
    window.picture("joint_in_the_list")
    before = shape()
    yield from window.drag(window.pixel(LEFT), window.pixel((-1.5, 0.0, 0.5)))
    yield from window.wait(0.5)
    moved = shape() - before
    assert np.allclose(moved, moved[0], atol=0.02), "all of it moves as one"
    assert np.linalg.norm(moved[0]) > 0.3
    window.picture("joint_dragged")
    yield from window.undo()
    assert np.array_equal(shape(), before)
