# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user has to be told where no operator runs that could report it."""

from __future__ import annotations

import bpy


def tell(message: str, *, title: str) -> None:
    """Show a message at the mouse; without a window print it."""
    print(f"Planar Deform: {message}")
    if bpy.app.background:
        return

    def draw(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
        menu.layout.label(text=message)

    bpy.context.window_manager.popup_menu(draw, title=title, icon="ERROR")
