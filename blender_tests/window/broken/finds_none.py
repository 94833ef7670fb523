# SPDX-License-Identifier: GPL-3.0-or-later
"""Not a test of the add-on: run.py runs this file after leaves_traces.py, in the same Blender."""

from collections.abc import Iterator

import bpy
from harness import EXTENSION, Window, addon


def test_finds_no_traces(window: Window) -> Iterator[None]:
    yield
    assert EXTENSION in bpy.context.preferences.addons, "the extension is not enabled"
    assert not hasattr(addon("registration"), "trace"), "the add-on's modules are those of the last file"
    assert bpy.context.preferences.view.show_tooltips, "the preferences are those of the last file"
    assert bpy.context.scene.render.fps == 24, "the drawing is that of the last file"
