# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Info editor tells of what hands have done: short lines that can be used in a script."""

from collections.abc import Generator, Iterator

import bpy
import numpy as np
from cutouts import active, ready, shape
from harness import Window, addon
from poses import LEFT, RIGHT


def told(window: Window) -> Generator[None, None, list[str]]:
    """The lines about our operators, from the Info editor."""
    area = min(window.window.screen.areas, key=lambda area: area.width * area.height)
    before, area.type = area.type, "INFO"
    yield from window.wait(0.1)
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window.window, area=area, region=region):
        bpy.ops.info.select_all(action="SELECT")
        bpy.ops.info.report_copy()
    area.type = before
    lines = bpy.context.window_manager.clipboard.splitlines()
    return [line for line in lines if line.startswith("bpy.ops.planar")]


def test_a_drag_is_a_short_line_and_the_redo_panel_still_takes_its_way(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    active().planar.method = "AKVF"  # whose pose depends on the way
    bpy.ops.ed.undo_push(message="Method")
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    for corner in ((1.5, 0.0, 0.9), (0.6, 0.0, 0.9), (1.2, 0.0, 0.4)):
        yield from window.move(window.pixel(corner), steps=8)
        yield from window.settled()
    yield from window.release()
    yield from window.settled()
    dragged = shape()
    lines = yield from told(window)
    assert lines[-1].startswith("bpy.ops.planar.drag_pins(")
    assert "offset=" in lines[-1]
    assert "path" not in lines[-1]
    assert len(lines[-1]) < 200, lines[-1]
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)  # as with nothing changed in the redo panel
    yield
    assert np.abs(shape() - dragged).max() < 1e-6, "the redo panel went another way"
    yield from window.undo()
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.planar.drag_pins(offset=(-0.3, 0.4))
    assert np.abs(shape() - dragged).max() > 1e-3, "the way makes no difference: the test says nothing"


def test_a_recording_is_a_short_line_and_can_be_recorded_again(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    with window.context():
        bpy.ops.planar.record_pins("INVOKE_DEFAULT", True)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    x, y = window.mouse
    scene = bpy.context.scene
    first = scene.frame_current
    while scene.frame_current < first + 8:
        yield from window.move((x, y + 8 * (scene.frame_current - first)))
    yield from window.release()
    while addon("operators.modal.running").now() is not None:
        yield
    yield
    poses = len(active().planar.poses)
    assert poses >= 9
    lines = yield from told(window)
    assert lines[-1].startswith("bpy.ops.planar.record_pins(")
    assert "path" not in lines[-1]
    assert len(lines[-1]) < 200, lines[-1]
    bpy.context.window_manager.operators[-1].properties.frame_step = 4
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)
    assert 2 < len(active().planar.poses) < poses
