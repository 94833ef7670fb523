# SPDX-License-Identifier: GPL-3.0-or-later
"""Quads are cut so that no half is turned over, and all that are convex alike."""

import numpy as np
import pytest

from planar_deform.model.plane.quads import cut

QUAD = np.array([[0, 1, 2, 3]], np.int32)


def halves(points):
    points = np.column_stack([points, np.zeros(len(points))])
    return cut(QUAD, points), points


def areas(triangles, points):
    a, b, c = (points[corner] for corner in triangles.reshape(-1, 3).T)
    return np.cross(b - a, c - a)[:, 2] / 2.0


def test_a_grid_is_cut_from_first_to_third_corners_whatever_rounding_says():
    x, y = np.meshgrid(np.linspace(0.1, 4.1, 40), np.linspace(-2.3, 1.7, 40))
    points = np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()]).astype(np.float32)
    first = (np.arange(39)[:, None] * 40 + np.arange(39)).ravel()
    quads = np.stack([first, first + 1, first + 41, first + 40], axis=1).astype(np.int32)
    assert np.array_equal(cut(quads, points).reshape(-1, 6), quads[:, [0, 1, 2, 0, 2, 3]])


@pytest.mark.parametrize("inner", range(4))
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_a_concave_quad_is_cut_at_its_inner_corner(inner, turn):
    points = np.roll([[0.4, 0.4], [2.0, 0.0], [0.0, 0.0], [0.0, 2.0]], inner, axis=0) * [turn, 1.0]
    triangles, points = halves(points)
    signs = areas(triangles, points)
    assert abs(signs.sum()) == pytest.approx(np.abs(signs).sum()), "no half is turned over"
    assert (np.abs(signs) > 0.1).all()


def test_a_quad_without_area_is_cut_all_the_same():
    triangles, _ = halves(np.zeros((4, 2)))
    assert triangles.tolist() == [[[0, 1, 2], [0, 2, 3]]]
