# SPDX-License-Identifier: GPL-3.0-or-later
"""The order in which the curve plays the blocks of a sequence."""

import itertools

import numpy as np
import pytest

from planar_deform.model.timing.order_of_time import Entry, even, frames_between, in_order
from planar_deform.model.timing.played_curve import Visit, visits, whole_frames

PLACES = [1024.0, 1032.0, 1040.0]


def ordered(*timeline):
    """Block, first and last frame, and whether it is a copy, of keys (frame, block or place)."""
    keys = [(frame, PLACES[at] if at < len(PLACES) else at) for frame, at in timeline]
    entries = in_order(len(PLACES), visits(np.array(keys, float), PLACES))
    return [(entry.block, entry.first, entry.last, entry.copy) for entry in entries]


def test_one_after_the_other():
    assert ordered((1, 0), (25, 1), (49, 2)) == [(0, 1, 1, False), (1, 25, 25, False), (2, 49, 49, False)]


def test_a_hold_is_one_visit_and_retiming_in_it_is_none():
    keys = (1, 0), (25, 1), (30, 1034.0), (35, 1), (49, 2)
    assert ordered(*keys) == [(0, 1, 1, False), (1, 25, 35, False), (2, 49, 49, False)]


def test_coming_back_is_a_copy():
    keys = (1, 0), (25, 1), (49, 0), (60, 2), (70, 0)
    assert [(block, copy) for block, *_, copy in ordered(*keys)] == [
        *[(0, False), (1, False), (0, True), (2, False), (0, True)]
    ]


def test_crossed_keys_change_the_order():
    assert [block for block, *_ in ordered((25, 1), (30, 0), (49, 2))] == [1, 0, 2]


def test_a_block_without_a_key_is_passed_on_the_way():
    assert ordered((1, 0), (49, 2)) == [(0, 1, 1, False), (1, 25, 25, False), (2, 49, 49, False)]


@pytest.mark.parametrize(("key", "left"), [((1, 1), [(0, None), (1, 1), (2, None)])])
def test_blocks_before_and_behind_all_keys_are_never_played(key, left):
    assert [(block, first) for block, first, *_ in ordered(key)] == left


def test_no_keys_no_times():
    assert in_order(2, []) == [Entry(0, None, None), Entry(1, None, None)]
    assert in_order(0, [Visit(0, 1, 1)]) == [Entry(0, 1, 1)]


@pytest.mark.parametrize(
    ("first", "last", "count"),
    [
        *[(1, 25, 23), (1, 2, 0), (1, 3, 1), (1, 1, 0), (25, 1, 0), (1.5, 3.25, 2), (1.5, 1.7, 0)],
        *[(-3, 3, 5), (-0.5, 0.5, 1), (1.001, 2.999, 1), (1.001, 2.001, 0), (0.9999, 3.0001, 1)],
    ],
)
def test_whole_frames_strictly_between(first, last, count):
    assert whole_frames(first, last) == count
    assert frames_between(Entry(0, 0, first), Entry(1, last, 99)) == count


def test_nothing_is_between_what_is_not_played():
    assert frames_between(Entry(0, None, None), Entry(1, 9, 9)) == 0
    assert frames_between(Entry(0, 1, 1), Entry(1, None, None)) == 0


def test_a_way_through_poses_without_keys_has_as_many_frames_in_each():
    entries = in_order(4, visits(np.array([(1, 0.0), (12, 24.0)]), [0.0, 8.0, 16.0, 24.0]))
    counts = [frames_between(before, after) for before, after in itertools.pairwise(entries)]
    assert counts == [3, 4, 3]
    assert even(counts, entries) == [4, 4, 4]
    assert even([3, 0, 5], entries) == [5, 0, 5]
    keyed = in_order(3, visits(np.array([(1, 0.0), (5, 8.0), (9, 16.0)]), [0.0, 8.0, 16.0]))
    assert even([3, 5], keyed) == [3, 5]
