# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane of points joined by edges alone."""

import numpy as np
import pytest

from planar_deform.model.plane.outline import plane_normal

ONE = np.zeros(5, np.int32)
STICK = np.arange(5.0)[:, None]


def across(normal, expected):
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    assert abs(normal @ np.array(expected, float)) / np.linalg.norm(expected) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e12])
def test_points_of_a_plane_at_any_size_and_place(size):
    rng = np.random.default_rng(3)
    u, v = np.array([2.0, -1.0, 0.5]), np.array([0.3, 1.0, 1.0])
    points = rng.normal(size=(5, 2)) @ np.stack([u, v]) + 7.0
    across(plane_normal(size * points, [], ONE), np.cross(u, v))


def test_parts_in_parallel_planes():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    points = np.concatenate([square, square * 0.3 + [9, 9, 4]])
    across(plane_normal(points, [], np.repeat([0, 1], 4).astype(np.int32)), [0, 0, 1])


def test_a_straight_line_lies_where_its_other_shapes_do():
    bent = STICK * [1.0, 0.0, 0.0] + (STICK - 2.0) ** 2 * [0.0, 0.6, 0.8]
    across(plane_normal(STICK * [1.0, 0.0, 0.0], [bent], ONE), [0.0, -0.8, 0.6])
    turned = STICK * [0.0, 0.0, 1.0]  # straight, too
    across(plane_normal(STICK * [1.0, 0.0, 0.0], [turned], ONE), [0, 1, 0])


def test_other_shapes_are_read_only_when_they_are_needed():
    def others():
        raise AssertionError
        yield

    points = np.random.default_rng(4).normal(size=(5, 3)) * [1, 1, 0]
    across(plane_normal(points, others(), ONE), [0, 0, 1])


def test_shapes_that_share_no_plane_leave_a_line_to_the_axes():
    up, deep = ((STICK - 2.0) ** 2 * axis for axis in ([0, 0, 1.0], [0, 1.0, 0]))
    line = STICK * [1.0, 0.0, 0.0]
    across(plane_normal(line, [line + up, line + deep], ONE), [0, 0, 1])


@pytest.mark.parametrize(
    ("direction", "normal"),
    [([1, 0, 0], [0, 0, 1]), ([0, 1, 0], [0, 0, 1]), ([0, 0, 1], [0, 1, 0]), ([1, 0, 1], [-1, 0, 1])],
)
def test_a_line_alone_lies_along_the_axes(direction, normal):
    across(plane_normal(STICK * direction, [], ONE), normal)


def test_straight_lines_side_by_side():
    ends = np.array([[x, 0.0, z] for x in range(4) for z in (0, 1)])
    across(plane_normal(ends, [], np.repeat(np.arange(4), 2).astype(np.int32)), [0, 1, 0])


def test_points_in_one_place_have_the_plane_of_the_ground():
    across(plane_normal(np.full((5, 3), 2.5), [], ONE), [0, 0, 1])
