# SPDX-License-Identifier: GPL-3.0-or-later
"""What is running: a drag, a recording, a breakdown, a job, a settling. One at a time, in all windows.

Whatever begins ends what is running: what settles (a drag that was released, painted stiffness) is kept as it
is shown, everything else is taken back, as Esc does it. So does turning the add-on off. Only Record, pressed
once more, begins nothing: it ends the recording.

Undo and another file take the data away: what is running ends, and leaves them alone.
"""

from __future__ import annotations

from typing import Protocol

import bpy


class Run(Protocol):
    """Something that is running. Ended from here, its operator ends with the next event that it gets.

    With a Clock that is soon.
    """

    def give_way(self) -> None:
        """End at once: something else begins, or the add-on is turned off."""

    def let_go(self) -> None:
        """End at once: the data are about to be replaced."""


_now: Run | None = None


def now() -> Run | None:
    """What is running."""
    return _now


def start(run: Run) -> None:
    """This is running now; whatever was has ended."""
    global _now
    end()
    _now = run


def end() -> None:
    """End what is running: something else begins, or the add-on is turned off."""
    run = _now
    if run is not None:
        ended(run)
        run.give_way()


def let_go() -> None:
    """End what is running: undo or another file comes."""
    run = _now
    if run is not None:
        ended(run)
        run.let_go()


def ended(run: Run) -> None:
    """This has ended by itself."""
    global _now
    if _now is run:
        _now = None


class Clock:
    """Gives a window's operators an event every so often, until the one that it is for has ended itself."""

    def __init__(self, context: bpy.types.Context, seconds: float):
        self._timer = context.window_manager.event_timer_add(seconds, window=context.window)
        _clocks.add(self)

    def stop(self) -> None:
        """No more events. May be called again."""
        if self in _clocks:
            _clocks.remove(self)
            bpy.context.window_manager.event_timer_remove(self._timer)


_clocks: set[Clock] = set()


def stop_clocks() -> None:
    """Another file, or the add-on turned off: operators end without having an event."""
    for clock in tuple(_clocks):
        clock.stop()
