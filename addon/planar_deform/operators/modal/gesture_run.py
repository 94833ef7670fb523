# SPDX-License-Identifier: GPL-3.0-or-later
"""A gesture of the mouse that chooses something, under way in a window."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import bpy

from ...errors import ObjectGone
from ...scene.view import gesture
from . import reports, running
from .session import put_away, put_up


class GestureRun:
    """What is running, see running.Run. Nothing is changed before it is confirmed."""

    def __init__(self, context: bpy.types.Context, keys: str, cursor: str):
        """`keys` says in the status bar what the user can press."""
        running.start(self)
        put_up(context, keys, cursor)

    @property
    def on(self) -> bool:
        """Whether nothing has ended it from outside."""
        return running.now() is self

    def show(
        self, context: bpy.types.Context, strips: Iterable[Sequence[tuple[float, float]]], text: str = ""
    ) -> None:
        """Draw these lines in the region at hand, and write this in the view's header."""
        gesture.show(context.region, strips)
        if text:
            context.area.header_text_set(text)

    def end(self) -> None:
        """Show nothing any more, unless something else does by now."""
        if self.on:
            running.ended(self)
            self._leave()

    def give_way(self) -> None:
        """See running.Run."""
        self._leave()

    def let_go(self) -> None:
        """See running.Run."""
        self._leave()

    def _leave(self) -> None:
        gesture.clear()
        put_away()


class GestureOperator:
    """Modal part of an operator with a GestureRun in `_run`, which ends with it.

    A subclass handles all events but those that cancel it in `handle(context, event)`.
    """

    _run: GestureRun
    report: Callable[[set[str], str], None]  # of Blender's operators

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """What an event does, in a subclass."""
        raise NotImplementedError

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        result = {"CANCELLED"}
        if self._run.on and not (event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS"):
            try:
                result = self.handle(context, event)
            except ObjectGone:
                pass  # there is nothing left to choose
            except Exception as error:  # Blender would call again and again
                reports.unexpected(self, error)
        if result & {"FINISHED", "CANCELLED"}:
            self._run.end()
        return result

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator itself: another file is loaded, the window closes."""
        self._run.end()
