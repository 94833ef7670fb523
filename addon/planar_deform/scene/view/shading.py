# SPDX-License-Identifier: GPL-3.0-or-later
"""How the 3D views are shaded."""

from __future__ import annotations

import bpy


def show_textures(window: bpy.types.Window) -> None:
    """Solid views that show the material's colour, as Blender's do at first, show its texture instead."""
    for area in window.screen.areas:
        if area.type == "VIEW_3D" and area.spaces.active.shading.color_type == "MATERIAL":
            area.spaces.active.shading.color_type = "TEXTURE"
