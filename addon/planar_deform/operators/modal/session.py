# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that pose while the user watches: a thread solves, a timer shows the newest that there is.

On release the drawing settles, still within the operator, so that it is one undo step. From then on nothing
is taken back, and whatever else the user does ends it with what is shown.
"""

from __future__ import annotations

import contextlib
import time
import traceback
from collections.abc import Callable

import bpy

from ... import native
from ...errors import ObjectGone, Refusal, try_all
from ...model.posing.posing import Sample
from ...model.posing.solving import Solving, StoppedError
from ...model.posing.together import SolvedTogether
from ...scene import follow
from ...scene.view import snapshot
from . import reports, running
from .several_posing import NOTICED, SeveralPosing

RATE = 1 / 120  # seconds between two looks at what the thread has solved
# Seconds that an event may wait for the last sample: mostly it is solved by then, and the window goes on.
PATIENCE = 0.08
# Events that drive the view, and those that are nobody's: they go on to Blender.
PASSED_ON = ("MIDDLEMOUSE", "WHEEL", "TRACKPAD", "NDOF", "MOUSEROTATE", "MOUSESMARTZOOM", "TIMER", "WINDOW")
CONFIRM = ("RET", "NUMPAD_ENTER", "SPACE")  # keys that end a drag with what is shown
# Keys that do nothing yet: they let a drawing settle on.
MODIFIERS = {f"{side}_{key}" for side in ("LEFT", "RIGHT") for key in ("SHIFT", "CTRL", "ALT")} | {"OSKEY"}


class Session:
    """A posing under way in a window, and all that shows there that it is."""

    def __init__(self, context: bpy.types.Context, posing: SeveralPosing, keys: str):
        """`keys` says in the status bar what the user can press."""
        self.posing = posing
        self.shown: SolvedTogether | None = None
        self.released = False
        self.ended = False
        self._solving: Solving[SolvedTogether] | None = None
        self._complete = False  # the last thing asked for is a way that must be gone to its end
        self._asked, self._length = time.perf_counter(), 0  # when that was, and how many samples it has
        self._text = self._told = ""  # the header's, without and with the progress
        self.clock = running.Clock(context, RATE)
        running.start(self)
        put_up(context, keys)

    def ask(self, sample: Sample) -> None:
        """Go to a sample, without those asked for before if there is no time for them.

        Shows it at once where that takes but a moment. Raises as show().
        """
        self._complete = False
        if self._thread.at_once(sample):
            self.show()

    def retrace(self, path: list[Sample], seen: Callable[[SolvedTogether], None] | None = None) -> None:
        """Go along this path from the start instead; the thread tells `seen` of each sample."""
        self._complete = True
        self._asked, self._length = time.perf_counter(), len(path)
        self._thread.retrace(path, seen)

    def release(self) -> None:
        """No more samples will come: settle."""
        self.released = True
        put_away()
        if self._solving is not None:
            self._solving.hurry()
        self.show()
        if self.shown is not None and self.whole:
            self.posing.keep(self.shown)

    def show(self, *, again: bool = False) -> None:
        """Show the newest there is; `again`, even what has been shown.

        Raises what the thread raised, ObjectGone and Refusal.
        """
        solved = None if self._solving is None else self._solving.newest()
        if again:
            solved = solved or self.shown
        if solved is not None:
            self.posing.show(solved)
            self.shown = solved

    @property
    def untouched(self) -> bool:
        """Whether nothing has been asked for."""
        return self._solving is None

    @property
    def settled(self) -> bool:
        """Whether there is nothing left to solve or to show."""
        return self._solving is None or self._solving.settled

    @property
    def whole(self) -> bool:
        """Whether it can end with what is shown: with something, and not on the way to a typed value."""
        return self.shown is not None and not (self._complete and self._thread.owing)

    def catch_up(self) -> bool:
        """Show what was asked for last, if that takes but a moment; whether it can end with what is shown."""
        if self._solving is not None:
            self._solving.wait(PATIENCE)
        self.show()
        return self.whole

    def say(self, context: bpy.types.Context, text: str) -> None:
        """Tell in the header where the drag is."""
        self._text = text
        self.tell_progress(context)

    def tell_progress(self, context: bpy.types.Context) -> None:
        """Tell in the header how far it is on the way to a typed value, if that takes more than a moment."""
        told = "   ".join(part for part in (self._text, self.progress) if part)
        if told != self._told and context.area is not None:
            self._told = told
            context.area.header_text_set(told or None)

    @property
    def progress(self) -> str:
        """How far it is, and what can be pressed meanwhile; empty where nobody has to wait."""
        waited = self.released if self.shown is None else self._complete
        if self.whole or not waited or time.perf_counter() - self._asked < NOTICED:
            return ""
        share = 1.0 - self._thread.left / self._length if self._length else 0.0
        return f"Solving: {share:.0%}" + ("   Esc or RMB: Cancel" if self.released else "")

    def end(self) -> None:
        """Nothing more is solved or shown."""
        if self.ended:
            return
        self.ended = True
        running.ended(self)
        if self._solving is not None:
            self._solving.stop()
        try_all((snapshot.release, put_away))

    def take_back(self) -> None:
        """End it with everything as it was."""
        try:
            self.end()
        finally:
            with contextlib.suppress(ObjectGone):  # then there is nothing to put back
                self.posing.cancel()

    def give_way(self) -> None:
        """See running.Run."""
        with contextlib.suppress(ObjectGone, Refusal, StoppedError, native.SolveError):
            self.show()
        if not self.released or self.shown is None or not self.whole:
            self.take_back()
            return
        self.end()
        with contextlib.suppress(ObjectGone, Refusal):  # that of keying it: it is shown all the same
            self.posing.finish(self.shown)

    def let_go(self) -> None:
        """See running.Run."""
        self.end()

    @property
    def _thread(self) -> Solving[SolvedTogether]:
        if self._solving is None:
            self._solving = Solving(self.posing.model)
        return self._solving


def put_up(context: bpy.types.Context, keys: str, cursor: str = "SCROLL_XY") -> None:
    """Show that a drag is on, and in the status bar what can be pressed."""
    context.window.cursor_modal_set(cursor)
    context.workspace.status_text_set(keys)


def put_away() -> None:
    """Take back what showed that a drag was on."""
    window = bpy.context.window or bpy.context.window_manager.windows[0]
    window.cursor_modal_restore()
    if window.workspace is not None:
        window.workspace.status_text_set(None)
    for area in window.screen.areas:  # the view may be another editor by now
        area.header_text_set(None)


def is_dragged(context: bpy.types.Context, event: bpy.types.Event, press: tuple[float, float]) -> bool:
    """Whether the mouse, pressed there in the window, has gone so far that it drags and does not click."""
    inputs = context.preferences.inputs
    far: float = inputs.drag_threshold_tablet if event.is_tablet else inputs.drag_threshold_mouse
    far *= context.preferences.system.ui_scale
    x, y = press
    return bool(event.type == "MOUSEMOVE" and max(abs(event.mouse_x - x), abs(event.mouse_y - y)) >= far)


def is_taken_back(event: bpy.types.Event) -> bool:
    """Whether an event takes back what is not done yet: Blender's own undo would take back something else."""
    undo: bool = event.type == "Z" and (event.ctrl or event.oskey) and not event.shift
    return undo or event.type in {"ESC", "RIGHTMOUSE"}


class Interactive:
    """Modal part of an operator with a Session in `_session`.

    A subclass handles the events up to the release in `handle(context, event)`, and keeps its result in its
    properties in `keep_result(solved)`.
    """

    _session: Session
    report: Callable[[set[str], str], None]  # of Blender's operators

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """What an event before the release does, in a subclass."""
        raise NotImplementedError

    def keep_result(self, solved: SolvedTogether) -> None:
        """Let the properties say what it has come to, in a subclass."""
        raise NotImplementedError

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.guarded(lambda: self._go_on(context, event))

    def guarded(self, step: Callable[[], set[str]]) -> set[str]:
        """Take a step. Whatever goes wrong in it is told, and ends the operator with everything as it was."""
        try:
            try:
                if self._session.ended:
                    raise StoppedError("something else has begun")
                return step()
            except (ObjectGone, StoppedError):
                self.leave()
                return {"CANCELLED"}
            except Refusal as refusal:
                self.report({"WARNING"}, str(refusal))
                return self.stop()
            except native.SolveError as error:
                self.report({"ERROR"}, str(error))
                return self.stop()
        except Exception as error:  # Blender would call again and again; nothing may be left half done
            reports.unexpected(self, error)
        for undo in (self._session.take_back, self._session.clock.stop):
            try:
                undo()
            except Exception:
                traceback.print_exc()
        return {"CANCELLED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator itself: another file is loaded, the window closes."""
        self.stop()

    def _go_on(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """What an event does."""
        session = self._session
        if not session.posing.visible:
            return self.stop()
        session.show()
        if not session.released:
            return self.handle(context, event)
        if event.value == "PRESS" and not event.type.startswith(PASSED_ON) and event.type not in MODIFIERS:
            if session.catch_up():
                return self.finish() | {"PASS_THROUGH"}
            # What there is to see of it is not what was asked for: it goes on to that, or not at all.
            return self.stop() if is_taken_back(event) else {"RUNNING_MODAL"}
        if event.type == "TIMER":
            session.tell_progress(context)
        return self.finish() if session.settled else {"PASS_THROUGH"}

    def release(self) -> set[str]:
        """The user is done: let the drawing settle."""
        self._session.release()
        return {"RUNNING_MODAL"}

    def stop(self) -> set[str]:
        """End it early: taken back, unless it has been released."""
        session = self._session
        if not session.ended:
            if session.released and session.whole:
                with contextlib.suppress(ObjectGone):
                    return self.finish()
            session.take_back()
        self.leave()
        return {"CANCELLED"}

    def finish(self) -> set[str]:
        """End it with what is shown."""
        session = self._session
        assert session.shown is not None  # something has been asked for, and was waited for
        told = session.posing.finish(session.shown)
        self.keep_result(session.shown)
        self.leave()
        for posing in session.posing.posings:
            obj = bpy.data.objects.get(posing.drawing.object_name)
            if obj is not None:
                follow.match(obj)  # what Blender has told of it was put off by the drag
        reports.inform(self, told)
        return {"FINISHED"}

    def leave(self) -> None:
        """End it, whatever is shown, unless it has been ended."""
        self._session.end()
        self._session.clock.stop()
