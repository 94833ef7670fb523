# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths of pins, spread over a drawing."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.posing.depths import depth_of, spread, told_depth
from planar_deform.model.posing.pins import Holder


def held(cutout, *pins):
    return [Holder(one, cutout) for one in pins]


def test_other_pins_keep_their_depths_and_nothing_is_beyond_them():
    cutout = grid_cutout(9, 4)
    holders = held(cutout, pin([0], key=0), pin([9], key=1), pin([24], key=2))
    once = spread(0, cutout, holders, {1: 4.0}, np.zeros(50))
    again = spread(0, cutout, holders, {2: -2.0}, once)
    assert [depth_of(one, again) for one in holders] == pytest.approx([0.0, 4.0, -2.0])
    assert again.min() == pytest.approx(-2.0)
    assert again.max() == pytest.approx(4.0)


def test_a_patch_is_level():
    cutout = grid_cutout(9, 4)
    patch = [8, 9, 18, 19]
    holders = held(cutout, pin([0], key=0), pin(patch, key=1, kind="PATCH"))
    assert spread(0, cutout, holders, {1: 3.0}, np.zeros(50))[patch] == pytest.approx([3.0] * 4)


def test_pins_that_are_off_hold_nothing():
    cutout = grid_cutout(9, 4)
    holders = held(cutout, pin([0], key=0, enabled=False), pin([9], key=1))
    assert spread(0, cutout, holders, {1: 3.0}, np.zeros(50)) == pytest.approx(np.full(50, 3.0))


def test_without_pins_all_stays():
    depths = np.arange(50.0)
    assert np.array_equal(spread(0, grid_cutout(9, 4), [], {}, depths), depths)


def test_rounding_is_no_depth():
    cutout = grid_cutout(9, 4)
    (holder,) = held(cutout, pin([0], key=0))
    assert told_depth(holder, np.full(50, -4e-4)) == 0.0
    assert told_depth(holder, np.full(50, -4e-2)) == pytest.approx(-4e-2)
