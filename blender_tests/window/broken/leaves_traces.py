# SPDX-License-Identifier: GPL-3.0-or-later
"""Not a test of the add-on: run.py runs this file before finds_none.py, in the same Blender."""

from collections.abc import Iterator

import bpy
from harness import Window, addon


def test_leaves_traces(window: Window) -> Iterator[None]:
    yield
    addon("registration").trace = True
    bpy.context.preferences.view.show_tooltips = False
    bpy.context.scene.render.fps = 7
