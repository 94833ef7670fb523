# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints of two parts: what they hold, and how the solver is told."""

from functools import partial

import numpy as np
import pytest
from cutouts import pin, rectangles

from planar_deform.model.posing import joints, solver_cache
from planar_deform.model.posing.posing import Posing

BODY, ARM = (0.0, 0.0, 2.0, 4.0), (1.4, 3.0, 5.0, 3.4)
SHOULDER = np.array([1.63, 3.21])


@pytest.fixture
def figure():
    return rectangles(BODY, ARM)


def hinge(cutout, place=SHOULDER, **options):
    rows, weights = joints.hinge_binding(cutout, (0, 1), place)
    return joints.bound(5, "HINGE", rows, weights, cutout, **options)


def near(cutout, place, radius):
    return np.flatnonzero(np.linalg.norm(cutout.rest - place, axis=1) <= radius).astype(np.int32)


def weld(cutout, radius=0.3):
    rows = near(cutout, SHOULDER, radius)
    return joints.bound(6, "WELD", rows, np.ones(len(rows)), cutout)


def test_a_hinge_is_in_its_place_and_hardly_holds_anything_else(figure):
    joint = hinge(figure)
    assert joint.parts == (0, 1)
    assert joint.shares[0] == 1.0
    assert 0.0 < joint.shares[1:].sum() < 1e-4
    for place in (*joint.places(figure.rest, figure.triangles), joint.place(figure.rest, figure.triangles)):
        np.testing.assert_allclose(place, SHOULDER, atol=1e-12)


def test_a_weld_ties_each_vertex_to_what_it_lies_on(figure):
    joint = weld(figure)
    pairs = [
        np.einsum("kc,kcd->kd", weights, figure.rest[figure.triangles[of]])
        for of, weights in (joint.first, joint.second)
    ]
    np.testing.assert_allclose(pairs[0], pairs[1], atol=1e-9)
    assert len(pairs[0]) > 4


def test_a_group_of_one_part_waits(figure):
    rows = near(figure, (0.5, 0.5), 0.5)
    assert joints.bound(0, "HINGE", rows, np.ones(len(rows)), figure) is None
    assert joints.bound(0, "WELD", rows, np.ones(len(rows)), figure) is None
    apart = np.array([0, len(figure.rest) - 1], np.int32)  # corners that lie on nothing
    assert joints.bound(0, "WELD", apart, np.ones(2), figure) is None
    assert joints.bound(0, "HINGE", np.empty(0, np.int32), np.empty(0), figure) is None


def test_of_three_parts_those_with_most_weight_count():
    cutout = rectangles(BODY, ARM, (1.5, 3.1, 2.5, 3.3))
    rows = np.array([0, int(np.flatnonzero(cutout.parts == 1)[0]), int(np.flatnonzero(cutout.parts == 2)[0])])
    assert joints.two_parts(rows, np.array([1.0, 0.1, 0.5]), cutout.parts) == (0, 2)


def test_the_pairs_of_a_weld_share_its_weight_and_what_is_off_counts_nothing(figure):
    small, large = weld(figure), weld(figure, radius=0.5)
    for joint in (small, large):
        assert joints.ties_of([joint]).strength.sum() == pytest.approx(1.0)
    both = joints.ties_of([hinge(figure, weight=3.0), small])
    assert both.strength[0] == 3.0
    assert both.strength[-1] == small.shares[-1]
    assert joints.ties_of([hinge(figure, enabled=False)]) is None
    assert joints.ties_of([]) is None


def posed(cutout, pins, moving, sample, *used):
    make = partial(solver_cache.poser_for, 77, cutout, "hold", cutout.rest, joints.ties_of(used))
    posing = Posing(cutout, cutout.rest, pins, moving, make)
    for step in range(1, 13):
        posing.move(*(step / 12 * value for value in sample))
    return posing.settle()


@pytest.mark.parametrize("make", [hinge, weld])
def test_what_hangs_on_a_part_comes_along(figure, make):
    joint = make(figure)
    body = np.flatnonzero(figure.parts == 0)
    positions = posed(figure, [pin(body[:5], kind="PATCH")], {0}, (1.0, 2.0, 0.5), joint)
    one, other = joint.places(positions, figure.triangles)
    assert np.linalg.norm(one - other) < 1e-6 * figure.diagonal
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    before, now = ((shape[figure.parts == 1] - shape[0]) for shape in (figure.rest, positions))
    np.testing.assert_allclose(now, before @ turn.T, atol=1e-4)


def test_a_solver_is_kept_while_the_joints_are_the_same(figure):
    used = joints.ties_of([hinge(figure)])
    first = solver_cache.poser_for(78, figure, "hold", figure.rest, used)
    again = joints.ties_of([hinge(figure)])
    assert solver_cache.poser_for(78, figure, "hold", figure.rest, again) is first
    assert solver_cache.poser_for(78, figure, "hold", figure.rest) is not first


def test_a_hinge_is_bound_anew_where_its_place_is_on_another_mesh(figure):
    finer = rectangles(BODY, ARM, cell=0.07)
    rows, weights = joints.hinge_binding(finer, (0, 1), SHOULDER)
    joint = joints.bound(0, "HINGE", rows, weights, finer)
    np.testing.assert_allclose(joint.place(finer.rest, finer.triangles), SHOULDER, atol=1e-12)
