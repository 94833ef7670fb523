# SPDX-License-Identifier: GPL-3.0-or-later
"""A long calculation in a thread of its own, which is asked now and then how far it has come."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Result = TypeVar("Result")
Progress = Callable[[float], bool]  # takes the share done; False from it: nobody waits any more


def part_of(progress: Progress, number: int, count: int) -> Progress:
    """That of one of several that are solved one behind the other, by its number from 0."""
    return lambda share: progress((number + share) / count)


class Work(Generic[Result]):
    """Runs `solve(progress)` at once. Stopped, it ends by itself, and nobody waits for that.

    But Python does when it exits: a daemon thread would be torn from native code then, and abort the process.
    """

    def __init__(self, solve: Callable[[Progress], Result]):
        self.share = 0.0  # done, 0 to 1
        self._stopped = False
        self._done = threading.Event()
        self._results: list[Result] = []
        self._error: BaseException | None = None
        threading.Thread(target=self._run, args=(solve,)).start()

    def wait(self, seconds: float) -> bool:
        """Until it has ended, or for so long; whether it has."""
        return self._done.wait(seconds)

    def result(self) -> Result:
        """What it has come to. Raises what it raised. Only when it has ended."""
        if self._error is not None:
            raise self._error
        return self._results[0]

    def stop(self) -> None:
        """Nobody waits any more."""
        self._stopped = True

    def _run(self, solve: Callable[[Progress], Result]) -> None:
        try:
            self._results.append(solve(self._progress))
        except BaseException as error:  # for result() to raise, where somebody can be told
            self._error = error
        finally:
            self._done.set()

    def _progress(self, share: float) -> bool:
        self.share = share
        return not self._stopped
