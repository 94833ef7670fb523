# SPDX-License-Identifier: GPL-3.0-or-later
"""A gesture of the mouse that chooses something, under way in a window."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from ...scene.view import gesture
from . import running
from .session import put_away, put_up


class GestureRun:
    """What is running, see running.Run. Nothing is changed before it is confirmed."""

    def __init__(self, context: bpy.types.Context, keys: str, cursor: str):
        """`keys` says in the status bar what the user can press."""
        self._area, self._region = context.area, context.region
        running.start(self)
        put_up(context, keys, cursor)

    @property
    def on(self) -> bool:
        """Whether nothing has ended it from outside."""
        return running.now() is self

    def show(self, strips: Iterable[Sequence[tuple[float, float]]], text: str = "") -> None:
        """Draw these lines in its region, and write this in the view's header."""
        gesture.show(self._region, strips)
        if text:
            self._area.header_text_set(text)

    def end(self) -> None:
        """Show nothing any more. May be called again."""
        running.ended(self)
        gesture.clear()
        put_away()

    def give_way(self) -> None:
        """See running.Run."""
        self._leave()

    def let_go(self) -> None:
        """See running.Run."""
        self._leave()

    def _leave(self) -> None:
        gesture.clear()
        put_away()
