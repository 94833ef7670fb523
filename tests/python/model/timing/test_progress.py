# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress of a curve from key to key, kept while its values become others."""

import numpy as np

from planar_deform.model.timing.played_curve import Rows
from planar_deform.model.timing.progress import carried, kept, off


def rows(frames, values, left, right):
    """Keys with handles 3 frames to each side, at these values."""
    frames = np.array(frames, float)
    parts = ((frames, values), (frames - 3, left), (frames + 3, right))
    count = len(frames)
    types, amplitude = np.ones((count, 2), np.int32), np.full(count, 0.5, np.float32)
    return Rows(*(np.stack(part, axis=1).astype(np.float32) for part in parts), types, amplitude)


def test_handles_keep_their_share_of_the_way_on_each_side():
    before = rows([0, 12, 24], [1024, 1032, 1024], [1024, 1030, 1025], [1026, 1032, 1024])
    fallback = before.values
    fallback[:, 0] = 1024, 1124, 1324
    after = kept(before, np.ones(3, bool), fallback)
    assert after.keys[:, 1].tolist() == [1024, 1124, 1324]
    assert after.right[0].tolist() == [3, 1049]  # a quarter of the way
    assert after.left[1].tolist() == [9, 1099]
    assert after.right[1].tolist() == [15, 1124]
    assert after.left[2].tolist() == [21, 1299]
    assert after.amplitude.tolist() == [6.25, 12.5, 0.5]


def test_where_a_pose_is_held_handles_go_where_they_are_told():
    before = rows([0, 12], [1024, 1024], [1024, 1026], [1025, 1024])
    after = kept(before, np.ones(2, bool), before.values + np.array([0.0, 5.0, 7.0]))
    assert (after.right[0, 1], after.left[1, 1]) == (1032, 1031)


def test_keys_between_poses_keep_their_share_on_the_way_back_too():
    old = np.array([1024.0, 1028.0, 1032.0, 1030.0, 1024.0, 1024.0, 1026.0, 1040.0])
    known = np.array([True, False, True, False, True, True, False, True])
    fallback = np.array([1024.0, 0.0, 1124.0, 0.0, 1224.0, 1224.0, 0.0, 1384.0])
    assert carried(old, known, fallback).tolist() == [1024, 1074, 1124, 1149, 1224, 1224, 1244, 1384]


def test_only_handles_that_tell_the_way_have_to_be_where_they_should():
    wanted = rows([0, 12, 24], [1024, 1124, 1324], [1024, 1124, 1324], [1024, 1124, 1324])
    found = rows([0, 12, 24], [1024, 1124, 1324], [0, 1124.01, 1324], [1024, 1130, 0])
    assert off(found, wanted, np.array([True, True, True])).tolist() == [False, True, False]
    assert off(found, wanted, np.array([True, False, True])).tolist() == [False, False, False]
