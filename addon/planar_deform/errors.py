# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong between Blender's data and the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable


class Refusal(Exception):  # noqa: N818 - a word users and operators both read
    """The object cannot be posed as it is; the message says what to do about it."""


class ObjectGone(Exception):  # noqa: N818
    """The object or mesh a posing began with has been deleted, replaced or edited meanwhile."""


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
