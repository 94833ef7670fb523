# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that take longer than a blink: a thread solves, and what it comes to is written bit by bit.

In a window the operator is modal meanwhile: the status bar tells how far it is, the view can be turned, the
timeline plays on, and Esc ends it with everything as it was. From scripts, in background and in the redo
panel the same is done in one go. Either way it is one undo step.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

import bpy

from ... import native
from ...errors import ObjectGone, Refusal
from ...model.work import Progress, Work
from ..posing_operator import ShapeOperator
from . import reports, running
from .session import PASSED_ON, is_taken_back

RATE = 1 / 60  # seconds between two looks
SLICE = 0.01  # seconds of writing at a look
INSTANT = 0.1  # seconds for which Blender may be kept waiting at the start: then most jobs are done


@dataclass(frozen=True)
class Job:
    """Something that is solved, then written."""

    # Takes what `solve` returned, writes a little at each step and yields the share done. Closed before its
    # end, or ended by an error, it has put everything back as it was, to the bit.
    write: Callable[[Any], Generator[float, None, None]]
    # Runs in a thread, so without Blender's data. Told False by `progress`, it may raise native.Cancelled.
    # None: nothing is to be solved, and `write` is given None.
    solve: Callable[[Progress], Any] | None = None
    # What to tell the user in the end, from what `solve` returned.
    summary: Callable[[Any], str] | None = None


class LongRun:
    """A job under way."""

    def __init__(self, job: Job):
        self._job = job
        self._work = Work(job.solve or (lambda _: None))
        self._writing: Generator[float, None, None] | None = None
        self._written = 0.0
        self.stopped = False

    @property
    def share(self) -> float:
        """Done, 0 to 1; solving and writing are half of it each."""
        if self._job.solve is None:
            return self._written
        return 0.5 * (self._work.share if self._writing is None else 1.0 + self._written)

    @property
    def summary(self) -> str | None:
        """What to tell of a complete one."""
        return None if self._job.summary is None else self._job.summary(self._work.result())

    def advance(self, wait: float, write: float) -> bool:
        """Wait for so many seconds at most, then write for about as many as told; whether all is done.

        Raises what solving and writing raise.
        """
        if self._writing is None:
            if not self._work.wait(wait):
                return False
            self._writing = self._job.write(self._work.result())
        until = time.perf_counter() + write
        for share in self._writing:
            self._written = share
            # What is left when all can no longer go wrong, see playback.together(), is not drawn half done.
            if share < 1.0 and time.perf_counter() >= until:
                return False
        return True

    def stop(self) -> None:
        """End it; everything is as it was before it was written."""
        self.stopped = True
        self._work.stop()
        if self._writing is not None:
            self._writing.close()

    def give_way(self) -> None:
        """See running.Run."""
        try:
            self.stop()
        finally:
            _status(None)

    def let_go(self) -> None:
        """See running.Run. Ended, what writes puts everything back, as long as it is there."""
        self.give_way()


class LongOperator(ShapeOperator):
    """Has a job to do, which `job(context)` reads the scene for."""

    bl_label: str  # of Blender's operators

    def job(self, context: bpy.types.Context) -> Job:
        """What there is to do, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError

    def apply(self, context: bpy.types.Context) -> None:
        manager = context.window_manager
        run = LongRun(self.job(context))
        manager.progress_begin(0, 100)
        try:
            while not run.advance(RATE, RATE):
                manager.progress_update(int(100 * run.share))
        except (ObjectGone, native.SolveError) as error:
            raise Refusal(str(error)) from error
        finally:
            manager.progress_end()
            run.stop()
        self._tell(run)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.window is None:  # in background
            return self.execute(context)
        return self.start(context)

    def start(self, context: bpy.types.Context) -> set[str]:
        """Do it while the window goes on."""
        running.end()
        try:
            self._run = LongRun(self.job(context))
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        running.start(self._run)
        self._clock: running.Clock | None = None
        result = self._look(INSTANT, INSTANT)
        if result == {"RUNNING_MODAL"}:
            self._clock = running.Clock(context, RATE)
            context.window_manager.modal_handler_add(self)
        return result

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self._run.stopped:
            return self._end({"CANCELLED"})
        if event.value == "PRESS" and is_taken_back(event):
            return self._end({"CANCELLED"})
        if event.type == "TIMER":
            result = self._look(0.0, SLICE)
            return {"PASS_THROUGH"} if result == {"RUNNING_MODAL"} else result
        return {"PASS_THROUGH"} if event.type.startswith(PASSED_ON) else {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator itself: another file is loaded, the window closes."""
        self._end({"CANCELLED"})

    def _look(self, wait: float, write: float) -> set[str]:
        """Go on a little."""
        done = False
        try:
            done = self._run.advance(wait, write)
            if not done:
                _status(f"{self.bl_label}: {self._run.share:.0%}   Esc or RMB: Cancel")
                return {"RUNNING_MODAL"}
            self._tell(self._run)
            return self._end({"FINISHED"})
        except (Refusal, ObjectGone, native.SolveError) as error:
            self.report({"ERROR"}, str(error))
            return self._end({"CANCELLED"})
        except Exception as error:  # Blender would call again and again; nothing may be left half done
            reports.unexpected(self, error)
            return self._end({"FINISHED"} if done else {"CANCELLED"})

    def _tell(self, run: LongRun) -> None:
        if run.summary is not None:
            self.report({"INFO"}, run.summary)

    def _end(self, result: set[str]) -> set[str]:
        """End it in any way; nothing is left of it but what was written completely."""
        run = self._run
        del self._run  # Blender keeps operators that are done, and this has all that was solved
        running.ended(run)
        if self._clock is not None:
            self._clock.stop()
        try:
            if not run.stopped:
                run.give_way()
        except Exception as error:  # it could not put everything back
            reports.unexpected(self, error)
        return result


def _status(text: str | None) -> None:
    window = bpy.context.window or bpy.context.window_manager.windows[0]
    if window.workspace is not None:
        window.workspace.status_text_set(text)
