# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that were solved are not solved again, and only where everything is the same."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.posing import solved_shapes
from planar_deform.model.posing.pin_follow import Goal, PinFollow
from planar_deform.model.posing.pins import Holder


@pytest.fixture(autouse=True)
def _none_kept():
    solved_shapes.clear()
    yield
    solved_shapes.clear()


class Counting(native.Poser):
    """Counts what it is asked to solve."""

    moves = 0

    def move(self, targets):
        self.moves += 1
        return super().move(targets)


CUTOUT = grid_cutout(10, 3)


def follow(poser, offset=(0.5, 1.0), weight=1.0, start=CUTOUT.rest):
    pins = [pin([0], weight=weight), pin([43], key=1)]
    goal = Goal(Holder(pins[1], CUTOUT).place(CUTOUT.rest) + np.array(offset))

    def make():
        poser.reset(start)
        return poser

    posing = PinFollow(CUTOUT, start, pins, {1: goal}, make)
    before = poser.moves
    posing.run()
    return posing, poser.moves - before


def test_the_same_once_more_is_not_solved_and_has_the_same_bits():
    poser = Counting(CUTOUT.rest, CUTOUT.triangles)
    first, moves = follow(poser)
    again, none = follow(poser)
    assert moves > 0
    assert none == 0
    assert np.array_equal(again.positions, first.positions)
    for one, other in zip(first.results(), again.results(), strict=True):
        np.testing.assert_array_equal((one.target, one.reached), (other.target, other.reached))


def test_whatever_is_another_one_is_solved():
    poser = Counting(CUTOUT.rest, CUTOUT.triangles)
    follow(poser)
    moved = CUTOUT.rest + 1e-9
    for options in ({"offset": (0.5, 1.001)}, {"weight": 2.0}, {"start": moved}):
        assert follow(poser, **options)[1] > 0
        assert follow(poser, **options)[1] == 0
    stiff = Counting(CUTOUT.rest, CUTOUT.triangles, stiffness=np.full(len(CUTOUT.triangles), 2.0))
    assert follow(stiff)[1] > 0, "another solver"


def test_the_oldest_shapes_go_where_there_is_no_room(monkeypatch):
    monkeypatch.setattr(solved_shapes, "ROOM", 2 * CUTOUT.rest.nbytes)
    poser = Counting(CUTOUT.rest, CUTOUT.triangles)
    for offset in ((0.1, 0.0), (0.2, 0.0), (0.3, 0.0)):
        follow(poser, offset)
    assert follow(poser, (0.3, 0.0))[1] == 0
    assert follow(poser, (0.1, 0.0))[1] > 0
