# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving in a thread of its own, so that a window never waits for it.

One thread at a time: a new one first waits, in itself, for the one before, which may be in the middle of a
step on the same solver. Whoever asks gets the newest that there is; nothing here waits but `wait` and `halt`.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from ... import native
from ..work import Progress
from .posing import Sample

SolvedT = TypeVar("SolvedT")
SolvedT_co = TypeVar("SolvedT_co", covariant=True)

# Seconds that the mouse has to rest before the drawing is refined: a refinement under way would keep the next
# movement of the mouse waiting.
REST = 0.03


# Seconds for which an event may wait for its own shape, where that comes as quickly as the last one did: a
# redraw, which would keep it waiting, mostly takes longer.
MOMENT = 0.025


class StoppedError(RuntimeError):
    """Another posing has begun meanwhile."""


class Movable(Protocol[SolvedT_co]):
    """What a thread asks of a posing: one, or several together. `SolvedT_co`: what it comes to."""

    progress: Progress | None
    path: list[Sample]

    @property
    def settled(self) -> bool: ...

    @property
    def refines_slowly(self) -> bool: ...

    def restart(self) -> None: ...

    def move(self, du: float, dv: float, angle: float) -> object: ...

    def solved(self) -> SolvedT_co: ...


class Solving(Generic[SolvedT]):
    """Moves a posing to the newest sample asked for, and refines it when there is none.

    Samples that are overtaken before their turn are never solved, and are not in the posing's path. Between
    the first `ask` and `halt` the posing belongs to the thread.
    """

    def __init__(self, posing: Movable[SolvedT]):
        self._posing = posing
        self._changed = threading.Condition()
        self._route: deque[Sample] = deque()  # to be taken sample by sample, before anything newer
        self._newest: Sample | None = None
        self._restart = False
        self._owing = False  # something that was asked for is not solved
        self._idle = True  # nor is there anything to refine
        self._hurried = False
        self._stopped = False
        self._error: Exception | None = None
        self._solved: SolvedT | None = None  # not yet shown
        self._took = float("inf")  # seconds that the last sample took
        self._seen: Callable[[SolvedT], None] | None = None
        self._thread: threading.Thread | None = None
        posing.progress = self._goes_on

    # ---- for Blender's thread

    def ask(self, sample: Sample) -> None:
        """Go to this sample next, whatever else was asked for and has not been begun."""
        with self._changed:
            self._newest = sample
            self._wake()

    def retrace(self, path: list[Sample], seen: Callable[[SolvedT], None] | None = None) -> None:
        """Go back to the start, and along this path with all of its samples.

        `seen`, called in the thread, gets all that is solved from then on.
        """
        with self._changed:
            self._route, self._newest, self._restart, self._seen = deque(path), None, True, seen
            self._wake()

    def hurry(self) -> None:
        """Refine at once from now on, dense drawings to the end: no more samples will come."""
        with self._changed:
            self._hurried = True
            self._idle = self._thread is None  # it may have come to rest before that end
            self._changed.notify_all()

    def newest(self) -> SolvedT | None:
        """The newest there is, unless it was given before. Raises the thread's error, and StoppedError."""
        with self._changed:
            if self._error is not None:
                raise self._error
            if self._stopped:
                raise StoppedError("another posing has begun")
            solved, self._solved = self._solved, None
            return solved

    @property
    def owing(self) -> bool:
        """Whether something that was asked for is not solved."""
        with self._changed:
            return self._owing

    def at_once(self, sample: Sample) -> bool:
        """As ask(), and wait for it where that takes but a moment; whether it is solved."""
        self.ask(sample)
        return self._took < MOMENT and self.wait(MOMENT)

    @property
    def left(self) -> int:
        """How many samples of a path have not been begun."""
        with self._changed:
            return len(self._route)

    @property
    def settled(self) -> bool:
        """Whether everything that was asked for is solved, refined, and given by `newest`."""
        with self._changed:
            return self._idle and self._solved is None and self._error is None

    def wait(self, timeout: float | None = None) -> bool:
        """Until what was asked for is solved, or something is wrong; whether it came to that in time."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._owing or self._stopped, timeout)

    def stop(self) -> None:
        """Do nothing more. A step under way ends by itself, and nobody will see it."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()

    # ---- the thread

    def _wake(self) -> None:
        global _last
        self._owing, self._idle = True, False
        self._changed.notify_all()
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, args=(_last,), daemon=True)
            _last = self
            self._thread.start()

    def _run(self, before: Solving[Any] | None) -> None:
        if before is not None:
            before.end()
        try:
            while (sample := self._next()) is not None:
                began = time.perf_counter()
                try:
                    self._posing.move(*sample)
                except native.Cancelled:  # there is something newer to do
                    continue
                solved = self._posing.solved()
                with self._changed:
                    self._took = time.perf_counter() - began
                    if self._seen is not None and not self._restart:
                        self._seen(solved)
                    self._solved = solved
                    self._owing = self._restart or bool(self._route) or self._newest is not None
                    self._changed.notify_all()
        except Exception as error:  # for newest() to raise, where somebody can be told
            with self._changed:
                self._error, self._owing = error, False
                self._changed.notify_all()

    def _next(self) -> Sample | None:
        """The next sample to go to, once there is one; None to end."""
        with self._changed:
            rested = False
            while not self._stopped:
                if self._restart:
                    self._restart = False
                    self._posing.restart()
                if self._route:
                    return self._route.popleft()
                if self._newest is not None:
                    sample, self._newest = self._newest, None
                    return sample
                path = self._posing.path
                # A drawing itself takes longer to refine than a hand rests in the middle of a drag.
                enough = self._posing.settled or (self._posing.refines_slowly and not self._hurried)
                if not path or enough:
                    self._idle, self._owing = True, False
                    self._changed.notify_all()
                    self._changed.wait()
                elif rested or self._hurried or path[-2:-1] == path[-1:]:
                    return path[-1]
                else:
                    rested = not self._changed.wait(REST)
            return None

    def _goes_on(self, _share: float) -> bool:
        """Whether what is under way is still wanted. A solver being made is for newer samples, too."""
        with self._changed:
            if not self._posing.path:
                return not self._stopped
            newer = self._restart or bool(self._route) or self._newest is not None
            return not self._stopped and not newer

    def end(self) -> None:
        """Stop, and wait for the step under way."""
        self.stop()
        if self._thread is not None:
            self._thread.join()


_last: Solving[Any] | None = None


def interrupt() -> None:
    """Stop whatever is being solved in a thread: another posing begins."""
    if _last is not None:
        _last.stop()


def halt() -> None:
    """The same, and wait for it: the caller needs the solvers for itself."""
    global _last
    last, _last = _last, None
    if last is not None:
        last.end()
