# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on their way to goals."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.posing.pin_follow import Goal, PinFollow, nearest_turn
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
    assert posing._poser.report.converged
    np.testing.assert_allclose(posing.positions[43], goal, atol=0.02)
    np.testing.assert_allclose(posing.positions[0], (0.0, 0.0), atol=0.02)


def test_what_moves_little_is_there_in_one_step_and_the_rest_in_a_ramp():
    ways = ((0.01, 0.02), (-1.0, 2.0), (-9.0, 16.0))
    steps = [len({sample[0] for sample in following(offset)[0].path}) for offset in ways]
    assert steps == [1, 3, RAMP_SAMPLES]


def test_goals_that_are_reached_leave_the_drawing_as_it_is():
    posing, _ = following((0.0, 0.0))
    np.testing.assert_allclose(posing.positions, grid_cutout(10, 3).rest, atol=1e-9)


def test_a_dense_drawing_comes_to_rest_on_its_coarse_mesh():
    cutout = replace(grid_cutout(80, 40), cage=400)
    pins = [pin([0]), pin([80 + 81 * 20], key=1)]
    goal = Holder(pins[1], cutout).place(cutout.rest) + np.array((-8.0, 20.0))
    poser = partial(native.Poser, cutout.rest, cutout.triangles, method="hold", cage=400)
    posing = PinFollow(cutout, cutout.rest, pins, {1: Goal(goal)}, poser)
    posing.run()
    assert posing.refines_slowly  # nothing was done on the drawing itself
    np.testing.assert_allclose(posing.positions[80 + 81 * 20], goal, atol=0.02)


def test_a_patch_is_turned_to_the_angle_of_its_goal():
    cutout = grid_cutout(10, 3)
    held, hand = pin([0, 11, 22, 33]), pin([9, 10, 20, 21, 31, 32, 42, 43], key=1, kind="PATCH")
    holder = Holder(hand, cutout)
    goals = {1: Goal(holder.place(cutout.rest) + np.array((-1.0, 2.0)), 1.2)}
    poser = partial(native.Poser, cutout.rest, cutout.triangles, method="hold")
    posing = PinFollow(cutout, cutout.rest, [held, hand], goals, poser)
    posing.run()
    assert holder.fitted_angle(posing.positions) == pytest.approx(1.2, abs=0.02)
    result = next(result for result in posing.results() if result.key == 1)
    assert result.angle == pytest.approx(1.2)
    assert len({sample[0] for sample in posing.path}) == 3, "in steps of half a radian"


@pytest.mark.parametrize(
    ("angle", "to", "nearest"), [(3.0, -3.0, 3.0 - 2 * np.pi), (0.2, 12.6, 0.2 + 4 * np.pi)]
)
def test_of_all_angles_of_a_direction_the_nearest_one_is_taken(angle, to, nearest):
    assert nearest_turn(angle, to) == pytest.approx(nearest)
