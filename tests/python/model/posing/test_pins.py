# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh points, and pins as the handles a solver gets."""

import math

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.plane.locate import at, barycentric, nearest_point
from planar_deform.model.posing import pins
from planar_deform.model.posing.pins import Holder, rotation


def every(cutout):
    return np.arange(len(cutout.triangles), dtype=np.int32)


def test_a_place_inside_is_found_exactly():
    cutout = grid_cutout(7, 5)
    for place in np.random.default_rng(0).uniform(0, 1, (50, 2)) * [7, 5]:
        point = nearest_point(cutout.rest, cutout.triangles, place, every(cutout))
        assert point.distance == 0.0
        assert point.weights.min() >= 0.0
        assert point.weights.sum() == pytest.approx(1.0)
        assert at(cutout.rest, cutout.triangles, point) == pytest.approx(place, abs=1e-12)


def test_places_on_vertices_and_edges_count_as_inside():
    cutout = grid_cutout(7, 5)
    for place in ([3.0, 2.0], [3.5, 2.0], [0.0, 0.0], [7.0, 2.5]):
        assert nearest_point(cutout.rest, cutout.triangles, np.array(place), every(cutout)).distance == 0.0


def test_a_place_outside_goes_to_the_nearest_point_of_the_border():
    cutout = grid_cutout(7, 5)
    rng = np.random.default_rng(1)
    for place in rng.uniform(-4, 12, (50, 2)):
        nearest = np.clip(place, 0, [7, 5])
        point = nearest_point(cutout.rest, cutout.triangles, place, every(cutout))
        assert at(cutout.rest, cutout.triangles, point) == pytest.approx(nearest, abs=1e-9)
        assert point.distance == pytest.approx(np.linalg.norm(place - nearest), abs=1e-9)


def test_only_the_triangles_told_are_looked_at():
    cutout = grid_cutout(7, 5)
    point = nearest_point(cutout.rest, cutout.triangles, np.array([6.5, 4.5]), np.array([0], np.int32))
    assert point.triangle == 0
    assert nearest_point(cutout.rest, cutout.triangles, np.zeros(2), np.empty(0, np.int32)) is None


def test_triangles_without_area_are_no_trap():
    corners = np.array([[[0.0, 0], [1, 0], [2, 0]]])
    assert np.isneginf(barycentric(corners, np.array([1.0, 0.0]))).all()
    points = corners[0]
    triangles = np.array([[0, 1, 2], [0, 0, 0]], np.int32)
    point = nearest_point(points, triangles, np.array([1.5, 3.0]), np.array([0, 1], np.int32))
    assert at(points, triangles, point) == pytest.approx([1.5, 0.0])


def test_groups_within_one_triangle_give_their_weights_exactly():
    cutout = grid_cutout(4, 4)
    for rows, weights in (([6], [0.3]), ([6, 7], [0.25, 0.75]), (cutout.triangles[9], [0.5, 0.2, 0.3])):
        holder = Holder(pin(rows, weights=weights), cutout)
        share = np.array(weights) / np.sum(weights)
        assert holder.place(cutout.rest) == pytest.approx(share @ cutout.rest[rows], abs=1e-15)


def test_a_patch_hands_over_all_its_vertices_and_turns_their_targets():
    cutout = grid_cutout(4, 4)
    rows = [6, 7, 8, 11, 12]
    holder = Holder(pin(rows, kind="PATCH", weights=[1, 1, 1, 1, 2]), cutout)
    triangles, weights = holder.handle_vertices()
    held = np.einsum("ki,kid->kd", weights, cutout.rest[cutout.triangles[triangles]])
    assert np.array_equal(held, cutout.rest[rows])
    centre = holder.place(cutout.rest)
    targets = holder.handle_targets(centre + np.array([2.0, 1.0]), 0.7)
    assert targets == pytest.approx((cutout.rest[rows] - centre) @ rotation(0.7).T + centre + [2.0, 1.0])


@pytest.mark.parametrize("angle", [0.0, 1.0, -3.0, math.pi])
def test_the_fitted_angle_is_that_of_a_rigid_motion(angle):
    cutout = grid_cutout(4, 4)
    holder = Holder(pin([0, 3, 12, 18], kind="PATCH", weights=[1, 2, 3, 4]), cutout)
    moved = cutout.rest @ rotation(angle).T + [5.0, -2.0]
    assert math.remainder(holder.fitted_angle(moved) - angle, 2 * math.pi) == pytest.approx(0.0, abs=1e-12)


def test_a_patch_of_one_vertex_has_no_turn_of_its_own():
    cutout = grid_cutout(2, 2)
    holder = Holder(pin([4], kind="PATCH", angle=0.8), cutout)
    assert holder.fitted_angle(cutout.rest) == 0.8


@pytest.mark.parametrize("kind", ["POINT", "PATCH"])
def test_a_pin_with_other_settings_is_held_where_it_was_and_anything_else_is_looked_up(kind, monkeypatch):
    cutout, moved = grid_cutout(4, 4), grid_cutout(4, 4)
    rows = [0, 3, 12, 18]
    holder = Holder(pin(rows, kind=kind, weights=[1, 2, 3, 4]), cutout)
    looked = []
    monkeypatch.setattr(pins, "nearest_point", lambda *of: looked.append(of) or nearest_point(*of))
    again = holder.holding(pin(rows, kind=kind, weights=[1, 2, 3, 4], angle=0.5), cutout)
    assert again.pin.angle == 0.5
    assert holder.pin.angle == 0.0, "the old one stays what it is"
    assert not looked
    for other, where in (
        (pin([0, 3, 12, 19], kind=kind, weights=[1, 2, 3, 4]), cutout),
        (pin(rows, kind=kind, weights=[1, 2, 3, 5]), cutout),
        (pin(rows[:3], kind=kind, weights=[1, 2, 3]), cutout),
        (pin(rows, kind={"POINT": "PATCH", "PATCH": "POINT"}[kind], weights=[1, 2, 3, 4]), cutout),
        (pin(rows, kind=kind, weights=[1, 2, 3, 4]), moved),
    ):
        held, anew = holder.holding(other, where), Holder(other, where)
        assert np.array_equal(held.place(where.rest), anew.place(where.rest))
        for mine, theirs in zip(held.handle_vertices(), anew.handle_vertices(), strict=True):
            assert np.array_equal(mine, theirs)
