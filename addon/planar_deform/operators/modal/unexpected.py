# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that nobody has thought of, in something that runs: Blender would call it again and again."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Protocol


class _Reporting(Protocol):
    report: Callable[[set[str], str], None]  # of Blender's operators


def tell(operator: _Reporting, error: Exception) -> None:
    """Report it, with its traceback in the console. The caller ends what runs."""
    traceback.print_exception(error)
    operator.report({"ERROR"}, f"Unexpected error, see the console: {error}")
