# SPDX-License-Identifier: GPL-3.0-or-later
"""Views that are to be drawn again, where Blender does not know it by itself."""

from __future__ import annotations

import bpy


def views() -> None:
    """All 3D views, in all windows."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
