# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that draw in every 3D view while the add-on is on."""

from __future__ import annotations

from collections.abc import Callable

import bpy


class InViews:
    """Has a function called as 3D views are drawn: POST_VIEW in the world, POST_PIXEL in pixels."""

    def __init__(self, draw: Callable[[], None], stage: str):
        self._draw, self._stage = draw, stage
        self._handle: object | None = None

    def on(self) -> None:
        """From now on."""
        self._handle = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", self._stage)

    def off(self) -> None:
        """No more, if it was."""
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None
