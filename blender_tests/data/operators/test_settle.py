# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving the present pose again, from scripts."""

import bpy
import numpy as np
import pytest
from support import add_pins, bar, coordinates, measured


def bent():
    """A bar held at both ends and in the middle, its right end pulled up."""
    obj = bar(nx=24, ny=4)
    add_pins(obj, range(0, 125, 25), [62], range(24, 125, 25))
    assert bpy.ops.planar.drag_pins(offset=(-0.2, 0.8)) == {"FINISHED"}
    return obj


def settle():
    return bpy.ops.planar.settle_pose()


def test_a_settled_pose_stays():
    obj = bent()
    posed = coordinates(obj.data.vertices)
    assert settle() == {"FINISHED"}
    assert np.abs(coordinates(obj.data.vertices) - posed).max() < 1e-3


def test_a_pin_turned_off_lets_go_and_holds_again_when_it_is_on():
    obj = bent()
    posed = coordinates(obj.data.vertices)
    obj.planar.pins[1].enabled = False
    assert settle() == {"FINISHED"}
    free = coordinates(obj.data.vertices)
    assert np.linalg.norm(free[62] - posed[62]) > 0.05
    assert np.linalg.norm(free[74] - posed[74]) < 5e-3, "the others hold"
    obj.planar.pins[1].enabled = True
    assert settle() == {"FINISHED"}
    assert np.linalg.norm(coordinates(obj.data.vertices)[62] - free[62]) < 5e-3, "it holds where it is now"
    assert measured(obj).flipped == 0


def test_another_method_and_weight_are_taken_up():
    obj = bent()
    obj.planar.pins[1].weight = 0.001
    posed = coordinates(obj.data.vertices)
    assert settle() == {"FINISHED"}
    assert np.abs(coordinates(obj.data.vertices) - posed).max() > 1e-3
    obj.planar.method = "AKVF"
    assert settle() == {"FINISHED"}


def test_no_pin_that_holds_is_refused():
    obj = bent()
    for pin in obj.planar.pins:
        pin.enabled = False
    posed = coordinates(obj.data.vertices)
    with pytest.raises(RuntimeError, match="enable one"):
        settle()
    assert np.array_equal(coordinates(obj.data.vertices), posed)
