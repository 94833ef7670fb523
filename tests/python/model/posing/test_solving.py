# SPDX-License-Identifier: GPL-3.0-or-later
"""The solving thread: the newest sample wins, rest refines, errors surface, nothing hangs."""

import threading
from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.plane.cutout import make_cutout
from planar_deform.model.posing import solver_cache, solving
from planar_deform.model.posing.posing import Posing, carried_path
from planar_deform.model.posing.solving import Solving, StoppedError

SECONDS = 30.0  # that a loaded machine may take for what takes milliseconds


@pytest.fixture(autouse=True)
def _nothing_goes_on():
    solver_cache.clear()
    yield
    solving.halt()


def pose_action(make_poser=None):
    cutout = grid_cutout(12, 4)
    make_poser = make_poser or partial(solver_cache.poser_for, 1, cutout, "hold", cutout.rest)
    return Posing(cutout, cutout.rest, [pin([26], key=0), pin([38], key=1)], {1}, make_poser)


class Gate:
    """A solver that can be held up in the middle of a step."""

    def __init__(self, poser):
        self.poser = poser
        self.entered, self.open = threading.Semaphore(0), threading.Semaphore(0)
        self.moves = 0

    def __getattr__(self, name):
        return getattr(self.poser, name)

    def move(self, targets):
        self.moves += 1
        self.entered.release()
        assert self.open.acquire(timeout=SECONDS)
        return self.poser.move(targets)


@pytest.fixture
def gated():
    """A solving whose every new sample waits for the gate."""
    cutout = grid_cutout(12, 4)
    gate = Gate(solver_cache.poser_for(1, cutout, "hold", cutout.rest))

    def make_poser(*, progress=None):
        gate.poser.reset(cutout.rest)
        return gate

    yield Solving(pose_action(make_poser)), gate
    gate.open.release(1000)


def entered(gate):
    assert gate.entered.acquire(timeout=SECONDS)


def until_settled(task):
    """Everything there is to see, in order."""
    task.hurry()
    seen = []
    clock = threading.Event()
    for _ in range(int(SECONDS / 0.005)):
        solved = task.newest()
        if solved is not None:
            seen.append(solved)
        if task.settled:
            return seen
        clock.wait(0.005)
    raise AssertionError("it does not settle")


def test_samples_overtaken_before_their_turn_are_never_solved(gated):
    task, gate = gated
    task.ask((0.1, 0.0, 0.0))
    entered(gate)
    for du in (0.2, 0.3, 0.4):
        task.ask((du, 0.0, 0.0))
    gate.open.release(2)
    last = until_settled(task)[-1]
    moves = [
        sample for sample, before in zip(last.path, [None, *last.path], strict=False) if sample != before
    ]
    assert moves == [(np.float32(0.1), 0.0, 0.0), (np.float32(0.4), 0.0, 0.0)]
    assert last.results[1].target == pytest.approx([12.4, 2.0], abs=1e-6)


def test_rest_refines_and_the_path_gives_the_same_bits_again():
    task = Solving(pose_action())
    for step in range(1, 5):
        task.ask((0.0, 1.5 * step, 0.0))
        assert task.wait(SECONDS)
    last = until_settled(task)[-1]
    assert last.path.count(last.path[-1]) > 1
    again = pose_action()
    for sample in last.path:
        again.move(*sample)
    assert np.array_equal(again.positions, last.positions)


def test_a_resting_mouse_needs_no_hurry():
    task = Solving(pose_action())
    task.ask((0.0, 2.0, 0.0))
    clock = threading.Event()
    for _ in range(int(SECONDS / 0.01)):
        task.newest()
        if task.settled:
            break
        clock.wait(0.01)
    assert task.settled


def test_a_way_is_gone_with_all_its_samples_and_ends_as_a_script_does(gated):
    task, gate = gated
    task.ask((0.5, 0.5, 0.0))
    entered(gate)
    path = carried_path([], offset=(0.0, 1.5))
    task.retrace(path[:3])
    task.retrace(path)
    gate.open.release(1 + len(path))
    last = until_settled(task)[-1]
    script = pose_action()
    for sample in path:
        script.move(*sample)
    script.settle()
    assert last.path == script.path
    assert np.array_equal(last.positions, script.positions)


def test_what_is_shown_never_changes_afterwards():
    task = Solving(pose_action())
    task.ask((0.0, 0.5, 0.0))
    assert task.wait(SECONDS)
    first = task.newest()
    kept = first.positions.copy(), list(first.path)
    task.ask((0.0, 1.5, 0.0))
    until_settled(task)
    assert np.array_equal(first.positions, kept[0])
    assert first.path == kept[1]


@pytest.mark.parametrize("place", ["make", "move"])
def test_errors_of_the_thread_surface_and_it_ends(place):
    def broken(*_, **_options):
        raise RuntimeError("no solver today")

    task = Solving(pose_action(broken))
    if place == "move":
        cutout = grid_cutout(12, 4)
        gate = Gate(solver_cache.poser_for(1, cutout, "hold", cutout.rest))
        gate.move = broken
        task = Solving(pose_action(lambda **_options: gate))
    task.ask((0.1, 0.0, 0.0))
    assert task.wait(SECONDS)
    for _ in range(2):
        with pytest.raises(RuntimeError, match="no solver today"):
            task.newest()
    assert not task.settled
    task.end()


def test_stopping_does_not_wait_and_shows_nothing_more(gated):
    task, gate = gated
    task.ask((0.1, 0.0, 0.0))
    entered(gate)
    task.stop()
    with pytest.raises(StoppedError):
        task.newest()
    gate.open.release()
    task.end()
    assert gate.moves == 1
    with pytest.raises(StoppedError):
        task.newest()


def test_waiting_gives_up_in_time(gated):
    task, gate = gated
    task.ask((0.1, 0.0, 0.0))
    entered(gate)
    assert not task.wait(0.01)
    assert task.newest() is None
    gate.open.release()
    assert task.wait(SECONDS)
    assert task.newest() is not None


def test_the_next_thread_waits_for_the_step_of_the_one_before(gated):
    """Both have the same solver: a stray step would move it under the next posing."""
    task, gate = gated
    task.ask((0.1, 0.0, 0.0))
    entered(gate)
    task.stop()
    other = Solving(pose_action())
    other.ask((0.0, 1.0, 0.0))
    assert not other.wait(0.05)
    gate.open.release()
    last = until_settled(other)[-1]
    alone = pose_action()
    for sample in last.path:
        alone.move(*sample)
    assert np.array_equal(alone.positions, last.positions)


def test_another_action_ends_the_one_that_is_on():
    threads = threading.active_count()
    task = Solving(pose_action())
    task.ask((0.0, 1.0, 0.0))
    solving.interrupt()
    with pytest.raises(StoppedError):
        task.newest()
    solving.halt()
    assert threading.active_count() == threads
    solving.halt()


def test_nothing_asked_for_is_settled_and_makes_no_thread():
    before = threading.active_count()
    task = Solving(pose_action())
    assert task.settled
    assert task.newest() is None
    assert task.wait(0.0)
    task.end()
    assert threading.active_count() == before


def test_a_quick_solver_is_waited_for_and_a_slow_one_is_not(gated, monkeypatch):
    task, gate = gated
    monkeypatch.setattr(solving, "MOMENT", SECONDS)
    gate.open.release(2)
    assert not task.at_once((0.1, 0.0, 0.0)), "nothing is known of it yet"
    assert task.wait(SECONDS)
    assert task.at_once((0.2, 0.0, 0.0)), "as quick as the last one"
    assert task.newest().path[-1] == pytest.approx((0.2, 0.0, 0.0))
    monkeypatch.setattr(solving, "MOMENT", 1e-9)
    assert not task.at_once((0.3, 0.0, 0.0)), "it goes on alone"
    gate.open.release()
    assert task.wait(SECONDS)


def dense_posing():
    """Of a drawing that is solved on a coarse mesh, until it settles."""
    coarse = grid_cutout(60, 20)
    cutout = make_cutout(coarse.rest, coarse.triangles, coarse.parts, None, 200)
    make_poser = partial(solver_cache.poser_for, 1, cutout, "hold", cutout.rest)
    return Posing(cutout, cutout.rest, [pin([0], key=0), pin([len(cutout.rest) - 1], key=1)], {1}, make_poser)


def at_rest(task):
    clock = threading.Event()
    for _ in range(int(SECONDS / 0.005)):
        solved = task.newest()
        if solved is not None:
            last = solved
        if task.settled:
            return last
        clock.wait(0.005)
    raise AssertionError("it does not come to rest")


def test_a_dense_drawing_is_solved_itself_only_when_no_more_samples_will_come():
    posing = dense_posing()
    task = Solving(posing)
    task.ask((0.0, 8.0, 0.0))
    resting = at_rest(task)
    assert resting.report.coarse_settled
    assert not resting.report.converged
    task.ask((0.0, 9.0, 0.0))  # the drag goes on
    resting = at_rest(task)
    assert resting.report.coarse_settled
    assert not resting.report.converged
    task.hurry()
    last = at_rest(task)
    assert last.report.converged
    script = dense_posing()
    for sample in last.path:
        script.move(*sample)
    assert script.settled
    assert np.array_equal(script.positions, last.positions)


@pytest.mark.parametrize("stop", [True, False])
def test_whoever_wants_something_else_never_waits_for_a_dense_drawing(stop):
    posing = dense_posing()
    task = Solving(posing)
    task.ask((0.0, 8.0, 0.0))
    resting = at_rest(task)
    asked, answer = threading.Semaphore(0), threading.Semaphore(0)
    goes_on = posing.progress

    def progress(share):
        asked.release()
        assert answer.acquire(timeout=SECONDS)
        return goes_on(share)

    posing.progress = progress
    task.hurry()
    assert asked.acquire(timeout=SECONDS)
    if stop:
        task.stop()
    else:
        task.ask((0.0, 9.0, 0.0))
    answer.release(1000)
    if stop:
        task.end()
        assert np.array_equal(posing.positions, resting.positions)
        assert posing.path == resting.path
    else:
        last = at_rest(task)
        assert last.report.converged
        assert last.path[: len(resting.path)] == resting.path
        assert last.path[len(resting.path)] == (0.0, 9.0, 0.0)


def test_a_solver_that_takes_long_to_make_is_made_for_newer_samples_and_not_for_nobody():
    asked, answer = threading.Semaphore(0), threading.Semaphore(0)
    cutout = grid_cutout(12, 4)
    made = []

    def make_poser(*, progress):
        made.append(None)
        for _ in range(2):
            asked.release()
            assert answer.acquire(timeout=SECONDS)
            if not progress(0.5):
                raise native.Cancelled
        return solver_cache.poser_for(1, cutout, "hold", cutout.rest, progress=progress)

    task = Solving(pose_action(make_poser))
    task.ask((0.1, 0.0, 0.0))
    assert asked.acquire(timeout=SECONDS)
    task.ask((0.2, 0.0, 0.0))
    answer.release()
    assert asked.acquire(timeout=SECONDS)
    assert len(made) == 1
    task.stop()
    answer.release()
    task.end()
    with pytest.raises(StoppedError):
        task.newest()
