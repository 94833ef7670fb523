# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat patches in their places."""

import numpy as np

from planar_deform.model.flatten.layout import fitted_unit, nearest_motion, side_by_side, size_ratio

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_patches_lie_apart_in_rows_about_the_middle():
    random = np.random.default_rng(5)
    patch = np.repeat(np.arange(13, dtype=np.int32), 4)
    flat = np.concatenate([SQUARE * random.uniform(0.1, 3, 2) - random.uniform(-5, 5, 2) for _ in range(13)])
    placed = side_by_side(flat, patch)
    boxes = [(placed[patch == i].min(axis=0), placed[patch == i].max(axis=0)) for i in range(13)]
    for i, (low, high) in enumerate(boxes):
        before = flat[patch == i]
        assert np.allclose(placed[patch == i] - placed[patch == i][0], before - before[0])
        for other_low, other_high in boxes[:i]:
            assert ((low > other_high) | (other_low > high)).any()
    assert np.allclose(placed.min(axis=0) + placed.max(axis=0), 0.0)
    width, height = np.ptp(placed, axis=0)
    assert 0.3 < width / height < 4.0


def test_a_shape_fills_the_unit_square_in_one_scale():
    unit = fitted_unit(SQUARE * (4.0, 2.0) + 7.0)
    placed = unit.of(SQUARE * (4.0, 2.0) + 7.0)
    assert np.allclose(placed.min(axis=0), (0.0, 0.25))
    assert np.allclose(placed.max(axis=0), (1.0, 0.75))
    assert fitted_unit(np.ones((3, 2))).scale == 1.0


def test_a_motion_is_found_and_goes_back():
    turn = np.array([[np.cos(2.0), np.sin(2.0)], [-np.sin(2.0), np.cos(2.0)]])
    goals = SQUARE @ turn + (5.0, -3.0)
    motion = nearest_motion(SQUARE, goals)
    assert np.allclose(motion.of(SQUARE), goals)
    assert np.allclose(motion.back(goals), SQUARE)
    one = nearest_motion(SQUARE[:1], goals[:1])
    assert np.allclose(one.of(SQUARE), SQUARE + goals[0])


def test_sizes_are_compared_by_their_spread():
    assert np.isclose(size_ratio(SQUARE * 3.0, SQUARE), 3.0)
    assert size_ratio(SQUARE, SQUARE * 0.0) is None
