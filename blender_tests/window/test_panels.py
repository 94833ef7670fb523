# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels tell: a coarse mesh, a pose that is not shown, a cache out of date; names have room."""

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import active, pin, ready, shape, sheet
from harness import Window, addon
from poses import LEFT, RIGHT, keyed, large_view


def test_a_coarse_mesh_is_refined_by_the_panel_s_button(window: Window) -> Iterator[None]:
    sheet(columns=1, rows=1, cell=3.0)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.use_tool()
    yield from window.sidebar()
    window.picture("coarse")
    yield from window.push("planar.refine_mesh")
    assert len(active().data.vertices) >= 50
    yield from window.wait(0.3)
    window.picture("refined")
    pin((-1.2, 0.0, 0.0), (1.2, 0.0, 0.0))
    before = shape()
    yield from window.drag(window.pixel((1.2, 0.0, 0.0)), window.pixel((1.2, 0.0, 1.0)))
    assert np.abs(shape() - before).max() > 0.5
    for _ in range(4):
        if len(active().data.vertices) > 4:
            yield from window.undo()
    assert len(active().data.vertices) == 4


def test_what_is_not_shown_and_what_is_out_of_date_is_told(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    for number, name in enumerate(("Hand of the left arm, upper finger", "Tail")):
        active().planar.pins[number].name = name
    keyed((1, 0.3), (12, -0.6), (25, 0.5))
    active().planar.poses[0].name = "Anticipation before the jump"
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(bpy.app.tempdir) / "told.blend"))
    bpy.ops.planar.bake(to="POINT_CACHE")
    active().modifiers[0].show_viewport = False
    bpy.ops.planar.step_poses(step=2)
    yield from window.wait(0.2)
    yield from window.sidebar()
    window.picture("names")
    yield from large_view(window)
    window.picture("told")
    panel, held = addon("ui.panels.poses_panel"), addon("scene.sequence.held").held
    assert "Pose.001 at frame 12 is not shown" in panel._held_note(active(), held(active()))
    assert "Bake to Point Cache again" in panel._cache_note(active())
    bpy.ops.planar.step_poses(step=1)
    assert panel._held_note(active(), held(active())) is None
    assert panel._cache_note(active()) is None, "it shows what was baked again"
