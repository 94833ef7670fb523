# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong between Blender's data and the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager


class Refusal(Exception):  # noqa: N818 - a word users and operators both read
    """The object cannot be posed as it is; the message says what to do about it."""


class NothingToDo(Refusal):
    """The object needs nothing of this: where several are chosen, the others get it."""


class ObjectGone(Exception):  # noqa: N818
    """The object or mesh a posing began with has been deleted, replaced or edited meanwhile."""


class RestartNeeded(ImportError):  # noqa: N818
    """The compiled module in memory is of another version than the files of the add-on."""


@contextmanager
def naming(name: str | None) -> Iterator[None]:
    """A refusal of one of several objects tells whose it is; None: it is of the only one."""
    try:
        yield
    except Refusal as refusal:
        if name is None or f"'{name}'" in str(refusal):
            raise
        raise type(refusal)(f"'{name}': {refusal}") from refusal


class Refusals:
    """Those of several things, told together."""

    def __init__(self) -> None:
        self._reasons: list[str] = []

    @contextmanager
    def noting(self) -> Iterator[None]:
        """A refusal of one of them ends this one alone."""
        try:
            yield
        except Refusal as refusal:
            self._reasons.append(str(refusal))

    def tell(self) -> None:
        """Raises Refusal, with every reason once, where there are any."""
        if self._reasons:
            raise Refusal("; ".join(dict.fromkeys(self._reasons)))


def try_all(steps: Iterable[Callable[[], object]]) -> None:
    """Take every step, also after one that has failed, and raise in the end what went wrong."""
    errors: list[Exception] = []
    for step in steps:
        try:
            step()
        except Exception as error:
            errors += error.exceptions if isinstance(error, ExceptionGroup) else [error]
    if errors:
        raise ExceptionGroup("Not everything could be done", errors)
