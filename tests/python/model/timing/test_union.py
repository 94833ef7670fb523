# SPDX-License-Identifier: GPL-3.0-or-later
"""The timing of several sequences made one."""

import numpy as np
import pytest

from planar_deform.model.timing.played_curve import Rows
from planar_deform.model.timing.union import Track, is_same, union


def track(keys, at=None, interpolation=0.0):
    """Keys (frame, eval_time), linear between; of the shapes at these eval_times the keyed ones are poses."""
    keys = np.array(keys, float)
    at = np.unique(keys[:, 1]) if at is None else np.array(at, float)
    count = len(keys)
    zero = np.zeros((count, 2), np.float32)
    rows = Rows(
        keys.astype(np.float32), zero, zero, np.zeros((count, 2), np.int32), np.zeros(count, np.float32)
    )
    ways = np.full((count, 4), interpolation)
    frames, values = keys.T
    return Track(
        at,
        np.unique(values),
        rows,
        ways,
        np.zeros(count, bool),
        frames,
        values,
        lambda frame: float(np.interp(frame, frames, values)),
    )


def test_a_stop_wherever_one_of_them_has_a_pose():
    stops = union([track([(1, 0), (13, 8)]), track([(5, 0), (20, 8)])])
    assert [stop.frame for stop in stops] == [1, 5, 13, 20]
    assert stops[1].values == pytest.approx([8 * 4 / 12, 0.0])
    assert [stop.passed for stop in stops] == [None] * 4, "straight lines stay straight"


def test_frames_that_are_the_same_to_blender_are_one_stop():
    assert len(union([track([(1, 0), (13, 8)]), track([(1.004, 0), (13, 8)])])) == 2


def test_the_way_of_one_that_moves_alone_stays_with_what_is_generated_on_it():
    moving = track([(1, 0), (5, 32)], at=range(0, 40, 8), interpolation=3.0)
    still = track([(9, 0), (12, 8)])
    stops = union([still, moving])
    assert stops[0].like == (1, 0)
    assert stops[0].passed == [[0.0, 8.0], [0.0, 16.0], [0.0, 24.0]]
    assert [stop.held for stop in stops] == [False, False, True, False]


def test_ways_that_differ_are_played_out_at_whole_frames():
    stops = union([track([(1, 0), (5, 8)], interpolation=3.0), track([(1, 0), (3, 32)], at=range(0, 40, 8))])
    assert [stop.frame for stop in stops] == [1, 3, 5]
    assert stops[0].like is None
    assert stops[0].passed == [[2.0, 16.0]]


def test_what_is_the_same():
    assert is_same(track([(1, 0), (5, 8)]), track([(1, 0), (5, 8)]))
    assert not is_same(track([(1, 0), (5, 8)]), track([(1, 0), (6, 8)]))
    assert not is_same(track([(1, 0), (5, 8)]), track([(1, 0), (5, 8)], interpolation=3.0))
    assert not is_same(track([(1, 0), (5, 8)]), track([(1, 0), (5, 8), (9, 8)]))
