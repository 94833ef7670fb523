# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators report, beside refusals."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Protocol

Tell = Callable[[str], None]  # takes what the user is to be told in the end


def counted(count: int, noun: str) -> str:
    """As "2 hinges"."""
    return f"{count} {noun}" + "s" * (count != 1)


def telling(told: list[str], name: str | None) -> Tell:
    """Takes what the user is to be told of an object, with its name where there are several."""
    return lambda text: told.append(text if name is None else f"'{name}': {text}")


class _Reporting(Protocol):
    report: Callable[[set[str], str], None]  # of Blender's operators


def inform(operator: _Reporting, told: str | None) -> None:
    """Report what was done otherwise than one may think; None: nothing was."""
    if told is not None:
        operator.report({"INFO"}, told)


def unexpected(operator: _Reporting, error: Exception) -> None:
    """Report an error that nobody has thought of, with its traceback in the console.

    The caller ends what runs: Blender would call it again and again.
    """
    traceback.print_exception(error)
    operator.report({"ERROR"}, f"Unexpected error, see the console: {error}")
