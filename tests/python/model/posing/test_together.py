# SPDX-License-Identifier: GPL-3.0-or-later
"""Posings of several drawings moved as one."""

import time
from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.plane.frame import frame_across
from planar_deform.model.posing import solver_cache, solving
from planar_deform.model.posing.posing import Posing
from planar_deform.model.posing.solving import Solving
from planar_deform.model.posing.spreading import Spreading, growth
from planar_deform.model.posing.together import Part, Plane, Together

UP, FRONT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
PATH = [(0.1 * step, 0.2 * step, 0.05 * step) for step in range(1, 8)]


@pytest.fixture(autouse=True)
def _no_solvers():
    yield
    solving.halt()
    solver_cache.clear()


def posing(key, moving=(1,), model=Posing, nx=8):
    cutout = grid_cutout(nx, 3)
    pins = [pin([0], key=0), pin([nx], key=1), pin([2 * (nx + 1)], key=2)]
    make = partial(solver_cache.poser_for, key, cutout, "hold", cutout.rest)
    return model(cutout, cutout.rest, pins, moving, make)


def frame(normal=UP, turn=None):
    return frame_across(normal, np.eye(3) if turn is None else turn)


def test_one_alone_moves_as_it_does_by_itself_to_the_bit():
    alone, both = posing(1), Together([Part(posing(2))])
    for sample in [*PATH, PATH[-1]]:
        alone.move(*sample)
        both.move(*sample)
    (solved,) = both.solved().each
    assert np.array_equal(solved.positions, alone.positions)
    assert solved.path == alone.path == both.path


@pytest.mark.parametrize("turn", [0.0, 0.7, np.pi])
def test_drawings_turned_in_a_plane_go_the_same_way_in_the_world(turn):
    c, s = np.cos(turn), np.sin(turn)
    told, own = frame(), frame(turn=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    first, second = posing(1), posing(2)
    both = Together([Part(first), Part(second, Plane.of(own, told))])
    both.move(0.3, 0.5, 0.0)
    du, dv, _ = second.path[-1]
    assert own.lift(np.array([[du, dv]]))[0] == pytest.approx(told.lift(np.array([[0.3, 0.5]]))[0], abs=1e-6)


def test_a_plane_seen_from_behind_turns_the_other_way():
    told = frame()
    plane = Plane.of(told.mirrored(), told)
    assert plane is not None
    assert Posing.seen_in((0.25, 0.5, 0.125), plane.axes, plane.side) == (0.25, -0.5, -0.125)


def test_planes_with_the_same_axes_see_samples_to_the_bit_and_those_across_do_not_turn():
    assert Plane.of(frame(), frame()) is None
    across = Plane.of(frame(FRONT), frame())
    assert across is not None
    assert across.side == 0.0


def test_spreading_is_the_same_in_all_planes():
    c, s = np.cos(0.4), np.sin(0.4)
    axes = np.array([[c, s], [-s, c]])
    assert Spreading.seen_in(growth(0.3), axes, 1.0) == growth(0.3)
    along = np.array(Spreading.seen_in(growth(0.5, (1.0, 0.0)), axes, 1.0))
    assert along == pytest.approx(growth(0.5, (c, -s)))


def test_patches_that_spread_with_pins_of_another_drawing_are_not_alone():
    one = posing(1, model=Spreading)
    assert one.movers == 1
    patch = pin([0, 1, 9, 10], key=0, kind="PATCH")
    cutout = grid_cutout(8, 3)
    make = partial(solver_cache.poser_for, 3, cutout, "hold", cutout.rest)
    for companions, scale in ((0, 1.5), (1, 1.0)):
        spread = Spreading(cutout, cutout.rest, [patch, pin([8], key=1)], {0}, make)
        spread.companions = companions
        spread.move(*growth(0.5))
        assert spread.results()[0].scale == scale


def test_each_goes_its_own_way_again_to_the_bit():
    """Of a thread, too, which leaves out samples and refines in between."""
    both = Together([Part(posing(1)), Part(posing(2, nx=12))])
    task = Solving(both)
    for sample in PATH:
        task.ask(sample)
        time.sleep(0.005)
    task.hurry()
    until = time.monotonic() + 20.0
    solved = None
    while not task.settled:
        solved = task.newest() or solved
        assert time.monotonic() < until
    task.end()
    assert solved is not None
    assert both.settled
    again = Together([Part(posing(1)), Part(posing(2, nx=12))])
    for _ in again.again(solved.path, [one.path for one in solved.each]):
        pass
    for one, other in zip(again.solved().each, solved.each, strict=True):
        assert np.array_equal(one.positions, other.positions)
    assert again.path == solved.path


def test_one_that_has_settled_rests_while_others_are_refined():
    quick, slow = posing(1, moving=()), posing(2)
    both = Together([Part(quick), Part(slow)])
    both.move(*PATH[-1])
    while not both.settled:
        both.move(*both.path[-1])
    assert len(quick.path) < len(slow.path) == len(both.path)


def test_an_error_tells_whose_it_is_and_the_only_one_has_no_name():
    class Broken(Posing):
        def move(self, *_sample):
            raise native.SolveError("it broke")

    for parts, text in (
        ([Part(posing(1), name="Body"), Part(posing(2, model=Broken), name="Arm")], "'Arm': it broke"),
        ([Part(posing(2, model=Broken))], "it broke"),
    ):
        with pytest.raises(native.SolveError) as caught:
            Together(parts).move(*PATH[0])
        assert str(caught.value) == text


def test_from_the_start_again_all_are_there():
    both = Together([Part(posing(1)), Part(posing(2))])
    before = [one.positions for one in both.posings]
    both.move(*PATH[-1])
    both.restart()
    assert both.path == []
    for one, positions in zip(both.posings, before, strict=True):
        assert np.array_equal(one.positions, positions)
