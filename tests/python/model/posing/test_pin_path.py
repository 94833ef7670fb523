# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths of pins: where they are at which share of the time."""

import numpy as np
import pytest

from planar_deform.model.posing.pin_path import EASES, KINDS, PinPath, bezier, is_closed, turn_of

START, END = np.array([1.0, 2.0]), np.array([4.0, -1.0])
SHARES = np.linspace(0.0, 1.0, 9)
WAVE = np.stack([np.linspace(0, 2, 40), np.sin(np.linspace(0, 5, 40))], axis=1)
CIRCLE = np.stack([np.cos(np.linspace(0, 2 * np.pi, 97)), np.sin(np.linspace(0, 2 * np.pi, 97))], axis=1)


@pytest.mark.parametrize("kind", [kind for kind, *_ in KINDS])
@pytest.mark.parametrize("ease", [ease for ease, *_ in EASES])
@pytest.mark.parametrize("turn", [0.0, 1e-9, 1.2, -3.0])
def test_every_path_leads_from_pose_to_pose(kind, ease, turn):
    places = PinPath(kind, ease, WAVE).at(START, END, turn, SHARES)
    np.testing.assert_allclose(places[[0, -1]], [START, END], atol=1e-9)
    assert np.isfinite(places).all()


def test_an_arc_is_the_circle_of_a_rigid_turn():
    pivot, arm = np.array([0.3, -0.2]), np.array([2.0, 0.5])
    rotations = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in 2.5 * SHARES]
    places = pivot + np.array([rotation @ arm for rotation in rotations])
    found = PinPath("ARC", "LINEAR").at(places[0], places[-1], 2.5, SHARES)
    np.testing.assert_allclose(found, places, atol=1e-12)


def test_timing_is_slow_where_it_says():
    steps = {ease: np.diff(PinPath("STRAIGHT", ease).at(START, END, 0.0, SHARES)[:, 0]) for ease, *_ in EASES}
    np.testing.assert_allclose(steps["LINEAR"], 3.0 / 8)
    assert steps["EASE"][0] < steps["EASE"][3] > steps["EASE"][-1]
    assert steps["EASE_IN"][0] < steps["EASE_IN"][-1]
    assert steps["EASE_OUT"][0] > steps["EASE_OUT"][-1]
    assert all((step > 0.0).all() for step in steps.values())


def test_a_curve_is_gone_along_evenly_and_brought_to_the_poses():
    uneven = np.concatenate([WAVE[:20:7], WAVE[20:]])
    places = PinPath("CURVE", "LINEAR", WAVE).at(WAVE[0], WAVE[-1], 0.0, np.linspace(0, 1, 200))
    speeds = np.hypot(*np.diff(places, axis=0).T)
    assert speeds.max() < 1.02 * speeds.min()
    turned = PinPath("CURVE", "LINEAR", WAVE @ [[0, 3], [-3, 0]] + 7.0).at(WAVE[0], WAVE[-1], 0.0, SHARES)
    np.testing.assert_allclose(turned, PinPath("CURVE", "LINEAR", WAVE).at(WAVE[0], WAVE[-1], 0.0, SHARES))
    assert np.isfinite(PinPath("CURVE", "EASE", uneven).at(START, END, 0.0, SHARES)).all()


def test_a_closed_curve_comes_back_at_its_own_size():
    assert is_closed(CIRCLE)
    assert not is_closed(WAVE)
    places = PinPath("CURVE", "LINEAR", CIRCLE).at(START, START, 0.0, SHARES)
    np.testing.assert_allclose(places, START - [1.0, 0.0] + CIRCLE[::12], atol=1e-6)


def test_bezier_curves():
    k = 0.5522847498
    points = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    along = k * np.array([[0.0, 1, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 0]])
    circle = bezier(points - along, points, points + along, closed=True)
    np.testing.assert_allclose(np.hypot(*circle[:, :2].T), 1.0, atol=3e-4)
    np.testing.assert_array_equal(circle[0], circle[-1])
    half = bezier(points - along, points, points + along, closed=False)
    np.testing.assert_array_equal(half[[0, -1]], points[[0, 3]])
    assert bezier(points[:1], points[:1], points[:1], closed=False).shape == (1, 3)


def test_turns():
    rng = np.random.default_rng(1)
    points = rng.normal(size=(8, 2))
    rotation = np.array([[np.cos(2.0), -np.sin(2.0)], [np.sin(2.0), np.cos(2.0)]])
    assert turn_of(points, 1.3 * points @ rotation.T + 5.0) == pytest.approx(2.0)
