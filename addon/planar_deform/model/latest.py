# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of the objects that were asked for last."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import TypeVar

LEAST = 16  # that are kept, however large

K = TypeVar("K")
V = TypeVar("V")


def make_room(entries: OrderedDict[K, V], room: int, size: Callable[[V], int]) -> None:
    """Drop the oldest entries, which are the first, until the others have no more than `room` together.

    A character of many small objects is kept as a whole, of large ones the last LEAST.
    """
    total = sum(map(size, entries.values())) if len(entries) > LEAST else 0
    while total > room and len(entries) > LEAST:
        total -= size(entries.popitem(last=False)[1])
