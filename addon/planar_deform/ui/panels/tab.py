# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar tab "Planar": what its panels share."""

from __future__ import annotations

import bpy


class PlanarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Planar"


def lines(layout: bpy.types.UILayout, text: str, icon: str, context: bpy.types.Context) -> None:
    """A message as wide as the sidebar."""
    width = max(12, int(context.region.width / (7.0 * context.preferences.system.ui_scale)) - 4)
    words, lines = text.split(), [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    column = layout.column(align=True)
    for number, line in enumerate(lines):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")
