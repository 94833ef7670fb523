# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted weights become factors of stiffness."""

import numpy as np
from cutouts import grid_cutout

from planar_deform.model.plane.cutout import make_cutout, signed_areas, stiffness_of


def test_painted_weights_become_factors_from_a_hundredth_to_a_hundred():
    triangles = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]], np.int32)
    np.testing.assert_array_equal(stiffness_of(np.full(5, 0.5), triangles), [1.0, 1.0, 1.0])
    np.testing.assert_allclose(stiffness_of(np.ones(5), triangles), 100.0, rtol=1e-15)
    np.testing.assert_allclose(stiffness_of(np.zeros(5), triangles), 0.01, rtol=1e-15)
    # Means 0.5, 0.75 and 1: equal steps of weight are equal ratios of stiffness.
    painted = np.array([0.0, 0.5, 1.0, 0.75, 1.25])
    np.testing.assert_allclose(stiffness_of(painted, triangles), [1.0, 10.0, 100.0], rtol=1e-14)


def test_each_triangle_keeps_its_factor_when_it_is_turned_for_the_solve():
    cutout = grid_cutout(2, 2)
    clockwise = cutout.triangles[:, [0, 2, 1]].copy()
    painted = np.linspace(0.0, 1.0, len(cutout.rest))
    made = make_cutout(cutout.rest, clockwise, cutout.parts, painted)
    assert (signed_areas(made.rest, made.triangles) > 0.0).all()
    np.testing.assert_allclose(made.stiffness, 100.0 ** (2.0 * painted[clockwise].mean(axis=1) - 1.0))
    assert make_cutout(cutout.rest, clockwise, cutout.parts).stiffness is None
