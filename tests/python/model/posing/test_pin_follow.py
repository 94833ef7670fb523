# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way to goals."""

from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.posing.pin_follow import Goal, PinFollow
from planar_deform.model.posing.pins import Holder
from planar_deform.model.posing.posing import RAMP_SAMPLES


def following(offset):
    """A bar held at one end whose other end is to go somewhere, and what it has become."""
    cutout = grid_cutout(10, 3)
    pins = [pin([0]), pin([43], key=1)]
    goal = Holder(pins[1], cutout).place(cutout.rest) + offset
    poser = partial(native.Poser, cutout.rest, cutout.triangles, method="hold")
    posing = PinFollow(cutout, cutout.rest, pins, {1: Goal(goal)}, poser)
    posing.run()
    return posing, goal


@pytest.mark.parametrize("offset", [(0.01, 0.02), (-4.0, 6.0)])
def test_pins_come_to_their_goals_whatever_the_way(offset):
    posing, goal = following(offset)
    assert posing.settled
    np.testing.assert_allclose(posing.positions[43], goal, atol=0.02)
    np.testing.assert_allclose(posing.positions[0], (0.0, 0.0), atol=0.02)


def test_what_moves_little_is_there_in_one_step_and_the_rest_in_no_more_than_a_ramp():
    steps = [
        len({sample[0] for sample in following(offset)[0].path}) for offset in ((0.01, 0.02), (-4.0, 6.0))
    ]
    assert steps == [1, RAMP_SAMPLES]


def test_goals_that_are_reached_leave_the_drawing_as_it_is():
    posing, _ = following((0.0, 0.0))
    np.testing.assert_allclose(posing.positions, grid_cutout(10, 3).rest, atol=1e-9)
