# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user has to be told where no operator reports it, or only until the next thing is done."""

from __future__ import annotations

import bpy

from .storage import redraw

_said = ""


def tell(message: str, *, title: str) -> None:
    """Show a message at the mouse; without a window print it."""
    print(f"Planar Deform: {message}")
    if bpy.app.background:
        return

    def draw(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
        menu.layout.label(text=message)

    bpy.context.window_manager.popup_menu(draw, title=title, icon="ERROR")


def say(message: str) -> None:
    """Show a message in the status bar until the next one is said; an empty one takes it away."""
    global _said
    _said = message
    redraw.views()


def said() -> str:
    """What is shown there."""
    return _said
