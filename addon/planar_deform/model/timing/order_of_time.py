# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a pose sequence in the order in which the curve plays them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from .played_curve import SAME_FRAME, Visit, whole_frames


@dataclass(frozen=True)
class Entry:
    """A block in the order of time."""

    block: int  # index of the block among those there are
    first: float | None  # the frames at which it is reached and left; None: never played
    last: float | None
    copy: bool = False  # the block is there already: it is come back to
    passed: bool = False  # no key stands at it: it is played on the way


def in_order(count: int, visits: Sequence[Visit]) -> list[Entry]:
    """`count` blocks in the order of the visits to them.

    A block that the curve comes back to is there once more. One that no key stands at is played on the way
    through it: it stays behind the one before it, at times that are even between the keys.
    """
    visited = {visit.pose for visit in visits}
    behind: dict[int, list[int]] = {}
    latest = -1
    for block in range(count):
        if block in visited:
            latest = block
        else:
            behind.setdefault(latest, []).append(block)
    entries = [Entry(block, None, None) for block in behind.pop(-1, [])]
    there: set[int] = set()
    for number, visit in enumerate(visits):
        passed = behind.pop(visit.pose, [])
        entries.append(Entry(visit.pose, visit.first, visit.last, visit.pose in there))
        there.add(visit.pose)
        if number + 1 == len(visits):
            entries += [Entry(block, None, None) for block in passed]
            continue
        step = (visits[number + 1].first - visit.last) / (len(passed) + 1)
        for index, block in enumerate(passed, 1):
            frame = visit.last + step * index
            entries.append(Entry(block, frame, frame, passed=True))
    return entries


def durations(entries: Sequence[Entry]) -> list[float]:
    """How long the way from each of these entries to the next takes, in frames; all of them are played."""
    found = []
    for before, after in itertools.pairwise(entries):
        assert before.last is not None
        assert after.first is not None
        found.append(max(after.first - before.last, SAME_FRAME))
    return found


def frames_between(before: Entry, after: Entry) -> int:
    """How many whole frames are strictly between leaving one and reaching the other; 0 if never played."""
    if before.last is None or after.first is None:
        return 0
    return whole_frames(before.last, after.first)


def even(counts: list[int], entries: Sequence[Entry]) -> list[int]:
    """Counts of what is between the entries, made equal where one way of the curve leads through several.

    Then the curve is at any share of the way when it was. Where there is nothing, there is nothing.
    """
    result = list(counts)
    first = 0
    for last in range(1, len(entries)):
        if not entries[last].passed:
            most = max(counts[first:last])
            result[first:last] = [most if count else 0 for count in counts[first:last]]
            first = last
    return result
