# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins on what a lattice deforms, as points that lead its in-betweens."""

import numpy as np
import pytest

from planar_deform import native
from planar_deform.model.lattice.cells import cells_across, halves
from planar_deform.model.lattice.pin_places import LedMotion, PinPlaces
from planar_deform.model.posing.pins import rotation

COUNTS = (6, 5, 1)


def case():
    """Points at rest, and pins each of which hangs on four points with some offset of its own."""
    rest = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0)), axis=-1).reshape(-1, 2)
    shares = np.zeros((2, 30))
    shares[0, [7, 8, 13, 14]] = [0.4, 0.3, 0.2, 0.1]
    shares[1, [21, 22, 27, 28]] = 0.2  # a strength of 0.8
    return rest, PinPlaces([0, 1], np.array([[0.0, 0.0], [0.7, 0.5]]), shares)


def test_places_follow_the_points_and_stand_behind_them():
    rest, places = case()
    moved = rest + np.array([2.0, -1.0])
    np.testing.assert_allclose(places.of(moved) - places.of(rest), [[2.0, -1.0], [1.6, -0.8]])
    np.testing.assert_array_equal(places.extended(moved), np.concatenate([moved, places.of(moved)]))
    frames = np.stack([rest, moved])
    np.testing.assert_array_equal(places.of(frames)[1], places.of(moved))


def test_each_place_is_joined_to_the_corners_of_its_cell():
    rest, places = case()
    joined = places.triangles(rest, cells_across(COUNTS, 2))
    assert joined.shape == (8, 3)
    assert set(joined[:4].ravel()) == {30, 7, 8, 13, 14}
    assert set(joined[4:, 0]) == {31}


@pytest.mark.parametrize("leading", [[0], [0, 1]])
def test_the_mean_of_the_leading_pins_is_where_the_solver_has_it(leading):
    rest, places = case()
    key = rest @ rotation(1.9).T
    key[:, 0] += 0.1 * rest[:, 1] ** 2
    key += (places.of(rest) - places.of(key))[0]
    cells = cells_across(COUNTS, 2)
    motion = native.Inbetweens(
        np.stack([places.extended(rest), places.extended(key)]),
        triangles=np.concatenate([halves(cells), places.triangles(rest, cells)]),
        rest=places.extended(rest),
        key_times=[0.0, 8.0],
        anchor=[30 + np.array(leading, np.int32)],
    )
    led = LedMotion(motion, places, [0.0, 8.0], [np.array(leading)], [np.array([], int)])
    frames = led.at([0.0, 2.0, 4.0, 6.0, 8.0])
    wanted = motion.at([0.0, 2.0, 4.0, 6.0, 8.0])[:, 30 + np.array(leading)].mean(axis=1)
    np.testing.assert_allclose(places.of(frames)[:, leading].mean(axis=1), wanted, atol=1e-12)
    np.testing.assert_allclose(frames[0], rest, atol=1e-12)
    np.testing.assert_allclose(frames[-1], key, atol=1e-12)
    assert frames.shape == (5, 30, 2)


def test_held_pins_are_where_the_solver_has_them_each():
    rest, places = case()
    key = rest @ rotation(0.4).T
    extended = [places.extended(rest), places.extended(key)]
    extended[1][30:] = extended[0][30:]  # places that the points do not have
    cells = cells_across(COUNTS, 2)
    motion = native.Inbetweens(
        np.stack(extended), triangles=np.concatenate([halves(cells), places.triangles(rest, cells)])
    )
    both = np.array([0, 1])
    led = LedMotion(motion, places, [0.0, 1.0], [both], [both])
    times = np.linspace(0.0, 1.0, 4)
    np.testing.assert_allclose(places.of(led.at(times)), motion.at(times)[:, 30:], atol=1e-12)
