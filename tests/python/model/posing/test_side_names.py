# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of the two sides are those that Blender flips."""

import pytest

from planar_deform.model.posing.side_names import flipped

PAIRS = [
    ("Hand.L", "Hand.R"),
    ("hand_l", "hand_r"),
    ("Hand-R", "Hand-L"),
    ("Hand L", "Hand R"),
    ("L_Hand", "R_Hand"),
    ("r.hand", "l.hand"),
    ("LeftHand", "RightHand"),
    ("hand left", "hand right"),
    ("HANDLEFT", "HANDRIGHT"),
    ("Hand.L.001", "Hand.R.001"),
    ("rightFoot.012", "leftFoot.012"),
]


@pytest.mark.parametrize(("name", "other"), PAIRS)
def test_sides_are_flipped_to_and_fro(name, other):
    assert flipped(name) == other
    assert flipped(other) == name


@pytest.mark.parametrize("name", ["Pin", "Pin.001", "Tail", "Hall", "Lr", "L", "", ".L001", "upright one"])
def test_what_tells_of_no_side_stays(name):
    assert flipped(name) == name
