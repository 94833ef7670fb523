# SPDX-License-Identifier: GPL-3.0-or-later
"""Actions: pins and paths in, positions and results out; equal input gives equal bits."""

import math
import subprocess
import sys
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.plane.cutout import stiffness_of
from planar_deform.model.posing import solver_cache
from planar_deform.model.posing.posing import RAMP_SAMPLES, Posing, carried_path


@pytest.fixture(autouse=True)
def _no_solvers():
    solver_cache.clear()


def posing(cutout, pins, moving, positions=None, key=1, **options):
    positions = cutout.rest if positions is None else positions
    return Posing(
        cutout,
        positions,
        pins,
        moving,
        partial(solver_cache.poser_for, key, cutout, "akvf", positions),
        **options,
    )


def test_the_moving_pin_follows_and_the_other_holds():
    cutout = grid_cutout(10, 3)
    posed = posing(cutout, [pin([0], key=0), pin([43], key=7)], {7})
    for step in range(1, 11):
        posed.move(0.0, 0.1 * step, 0.0)
    posed.settle()
    held, moved = posed.results()
    assert (held.key, moved.key) == (0, 7)
    assert moved.target == pytest.approx([10.0, 4.0], abs=1e-6)
    assert moved.reached == pytest.approx([10.0, 4.0], abs=1e-2)
    assert held.reached == pytest.approx([0.0, 0.0], abs=1e-2)
    assert posed.solved().report.flipped == 0


def test_samples_are_rounded_to_float32_and_kept():
    posed = posing(grid_cutout(4, 4), [pin([0]), pin([24], key=1)], {1})
    posed.move(0.1, 1 / 3, 0.2)
    assert posed.path == [(float(np.float32(0.1)), float(np.float32(1 / 3)), float(np.float32(0.2)))]


def test_the_same_samples_give_the_same_bits_whatever_the_solver_did_before():
    cutout = grid_cutout(12, 5)
    pins = [pin([0, 1, 14], kind="PATCH"), pin([77], key=1), pin([40], key=2)]
    path = [(0.1 * k, math.sin(k / 3), 0.05 * k) for k in range(12)]
    results = []
    for before in ((), [(3.0, 1.0, 0.0)] * 3, [(-2.0, 2.0, 0.3)]):
        warm = posing(cutout, pins[:2], {0, 1})
        for sample in before:
            warm.move(*sample)
        posed = posing(cutout, pins, {1, 2})
        for sample in path:
            posed.move(*sample)
        results.append(posed.settle())
    assert np.array_equal(results[0], results[1])
    assert np.array_equal(results[0], results[2])


def test_pins_turn_about_the_mean_of_their_points():
    cutout = grid_cutout(6, 2)
    posed = posing(cutout, [pin([0]), pin([20], key=1)], {0, 1})
    assert posed.pivot == pytest.approx([3.0, 1.0])
    posed.move(0.0, 0.0, math.pi / 2)
    assert posed.results()[0].target == pytest.approx([4.0, -2.0], abs=1e-6)


def test_a_patch_alone_turns_about_its_centre_and_keeps_its_turns():
    cutout = grid_cutout(8, 8)
    patch = pin([30, 31, 39, 40], kind="PATCH", angle=6.0, target=np.array([3.5, 3.5]))
    posed = posing(cutout, [patch], {0})
    assert posed.pivot == pytest.approx([3.5, 3.5])
    posed.move(0.0, 0.0, 1.0)
    assert posed.results()[0].angle == pytest.approx(7.0)


def test_stored_targets_hold_and_missing_ones_are_where_the_mesh_is():
    cutout = grid_cutout(6, 2)
    pins = [pin([0], target=np.array([-0.5, 0.25])), pin([20], key=1), pin([6], key=2, enabled=False)]
    posed = posing(cutout, pins, {1}, positions=cutout.rest + np.array([0.0, 3.0]))
    posed.move(0.0, 0.0, 0.0)
    assert [tuple(result.target) for result in posed.results()] == [(-0.5, 0.25), (6.0, 5.0)]


def test_a_pin_that_weighs_more_gives_way_less():
    cutout = grid_cutout(10, 3)
    gaps = []
    for weight in (0.01, 1.0, 100.0):
        posed = posing(cutout, [pin([0], weight=weight), pin([43], key=1)], {1})
        posed.move(2.0, 0.0, 0.0)
        gaps.append(np.linalg.norm(posed.results()[0].reached - posed.results()[0].target))
    assert gaps[0] > 3 * gaps[1] > 9 * gaps[2]


def test_nothing_that_holds_is_an_error():
    cutout = grid_cutout(3, 3)
    with pytest.raises(ValueError, match="enabled"):
        posing(cutout, [pin([0], enabled=False)], {0})


def test_a_solver_is_kept_while_mesh_rest_and_stiffness_are_the_same():
    cutout = grid_cutout(3, 3)
    first = solver_cache.poser_for(1, cutout, "akvf", cutout.rest)
    same = grid_cutout(3, 3)
    assert solver_cache.poser_for(1, same, "akvf", same.rest + 1.0) is first
    assert np.array_equal(first.positions, same.rest + 1.0)
    other = grid_cutout(3, 3)
    other.rest[5] += 1e-9
    second = solver_cache.poser_for(1, other, "akvf", other.rest)
    assert second is not first
    painted = np.full(len(other.rest), 0.5)
    stiff = replace(other, stiffness=stiffness_of(painted, other.triangles))
    third = solver_cache.poser_for(1, stiff, "akvf", other.rest)
    assert third is not second
    painted[0] = 0.75
    stiffer = replace(other, stiffness=stiffness_of(painted, other.triangles))
    fourth = solver_cache.poser_for(1, stiffer, "akvf", other.rest)
    assert fourth is not third
    same = replace(stiffer, stiffness=stiffer.stiffness.copy())
    assert solver_cache.poser_for(1, same, "akvf", other.rest) is fourth
    assert solver_cache.poser_for(2, same, "akvf", other.rest) is not fourth


def test_solvers_of_many_small_drawings_are_kept_and_few_of_large_ones(monkeypatch):
    cutout = grid_cutout(3, 3)
    monkeypatch.setattr(solver_cache, "ROOM", 30 * len(cutout.triangles))
    solver_cache.clear()
    first = solver_cache.poser_for(0, cutout, "akvf", cutout.rest)
    for key in range(1, 30):
        solver_cache.poser_for(key, cutout, "akvf", cutout.rest)
    assert solver_cache.poser_for(0, cutout, "akvf", cutout.rest) is first
    large = grid_cutout(30, 30)
    large_one = solver_cache.poser_for(30, large, "akvf", large.rest)
    assert solver_cache.poser_for(0, cutout, "akvf", cutout.rest) is first, "the last ones stay"
    for key in range(14):
        solver_cache.poser_for(key, cutout, "akvf", cutout.rest)
    assert solver_cache.poser_for(30, large, "akvf", large.rest) is large_one
    for key in range(16):
        solver_cache.poser_for(key, cutout, "akvf", cutout.rest)
    assert solver_cache.poser_for(30, large, "akvf", large.rest) is not large_one


PATH = [(0.25, 0.0, 0.0), (0.5, 0.25, 0.0), (0.5, 0.75, 0.0)]


def test_a_path_that_ends_where_it_is_asked_to_is_left_alone():
    assert carried_path(PATH, offset=(0.5, 0.75)) == PATH
    assert carried_path(PATH) == PATH
    loop = [*PATH, (0.0, 0.0, 0.0)]
    assert carried_path(loop, offset=(0.0, 0.0)) == loop
    turns = [(0.0, 0.0, 0.5), (0.0, 0.0, 0.25)]
    assert carried_path(turns, angle=0.25) == turns


def test_an_edited_end_carries_the_whole_path_along():
    doubled = carried_path(PATH, offset=(1.0, 1.5))
    assert np.array(doubled) == pytest.approx(2 * np.array(PATH))
    quarter = carried_path(PATH, offset=(-0.75, 0.5))
    assert np.array(quarter)[:, :2] == pytest.approx(np.array(PATH)[:, :2] @ [[0, 1], [-1, 0]])
    assert doubled[-1][:2] == (1.0, 1.5)
    turns = carried_path([(0.0, 0.0, 0.5), (0.0, 0.0, -1.0)], angle=2.0)
    assert turns == [(0.0, 0.0, -1.0), (0.0, 0.0, 2.0)]


def test_an_edited_long_path_is_thinned_and_loses_its_rests():
    angles = np.repeat(np.linspace(0.0, 3.0, 100), 3)
    path = [(math.cos(a) - 1.0, math.sin(a), 0.0) for a in angles]
    end = (2.0 * path[-1][0], 2.0 * path[-1][1])
    carried = carried_path(path, offset=end)
    assert len(carried) == RAMP_SAMPLES
    assert carried[-1][:2] == pytest.approx(end)
    assert len(set(carried)) == RAMP_SAMPLES
    half = np.array(carried)[:, :2] / 2.0 + [1.0, 0.0]
    assert np.linalg.norm(half, axis=1) == pytest.approx(np.ones(RAMP_SAMPLES)), "on the way as recorded"


@pytest.mark.parametrize("path", [[], [(0.3, 0.3, 0.0), (0.0, 0.0, 0.0)]])
def test_a_path_without_an_end_runs_straight(path):
    ramp = carried_path(path, offset=(1.0, -2.0))
    assert len(ramp) == RAMP_SAMPLES
    assert ramp[-1] == (1.0, -2.0, 0.0)
    assert ramp[RAMP_SAMPLES // 2 - 1] == (0.5, -1.0, 0.0)
    assert carried_path(path, angle=1.5)[-1] == (0.0, 0.0, 1.5)


def test_the_model_never_touches_blender():
    block = "import sys; sys.modules['bpy'] = sys.modules['mathutils'] = None; sys.path[:0] = sys.argv[1:]\n"
    names = ["plane.rest", "plane.locate", "posing.solver_cache", "posing.posing", "input.drag"]
    code = block + "".join(f"import planar_deform.model.{name}\n" for name in names)
    subprocess.run([sys.executable, "-c", code, *sys.path], check=True)
