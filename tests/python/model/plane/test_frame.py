# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane frames: in-plane axes that follow the object's, whatever the winding, scale and shear."""

import numpy as np
import pytest

from planar_deform.model.plane.cutout import connected_parts, make_cutout, signed_areas
from planar_deform.model.plane.frame import inverse, is_of, plane_frame

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
PARTS = np.zeros(4, np.int32)


def random_linear(seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(3, 3)) + 0.2 * np.eye(3)


@pytest.mark.parametrize("seed", range(8))
def test_axes_are_orthonormal_and_in_the_plane_under_any_linear_transform(seed):
    linear = random_linear(seed)
    points = SQUARE @ np.linalg.qr(random_linear(seed + 100))[0]
    frame = plane_frame(points, PARTS, TRIANGLES, linear)
    axes = np.stack([frame.u, frame.v, frame.n])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.ptp(frame.depth(points @ linear.T)) < 1e-12 * np.abs(linear).max()


@pytest.mark.parametrize("seed", range(4))
def test_flatten_keeps_world_lengths_and_lift_is_its_inverse(seed):
    linear = random_linear(seed)
    frame = plane_frame(SQUARE, PARTS, TRIANGLES, linear)
    world = SQUARE @ linear.T
    flat = frame.flatten(world)
    for i in range(4):
        assert np.linalg.norm(flat[i] - flat[0]) == pytest.approx(np.linalg.norm(world[i] - world[0]))
    assert frame.lift(flat - flat[0]) == pytest.approx(world - world[0])


def test_the_winding_does_not_turn_the_axes():
    both = [plane_frame(SQUARE, PARTS, triangles, np.eye(3)) for triangles in (TRIANGLES, TRIANGLES[:, ::-1])]
    assert both[0].v == pytest.approx(both[1].v)
    # Areas that cancel.
    mixed = plane_frame(SQUARE, PARTS, np.array([[0, 1, 2], [0, 3, 2]], np.int32), np.eye(3))
    assert mixed.n == pytest.approx([0, 0, 1])


@pytest.mark.parametrize("axis", range(3))
def test_a_drawing_across_an_axis_is_so_exactly(axis):
    rng = np.random.default_rng(axis)
    flat = rng.normal(size=(500, 2)).astype(np.float32).astype(float)
    points = np.insert(flat, axis, 1e-15 * rng.normal(size=500), axis=1)  # what some LAPACK makes of 0
    triangles = np.arange(498, dtype=np.int32).reshape(-1, 3)
    frame = plane_frame(points, np.zeros(500, np.int32), triangles, np.eye(3))
    assert np.array_equal(np.abs(frame.n), np.eye(3)[axis])
    assert not frame.lift(flat)[:, axis].any()


def test_a_mirrored_frame_sees_the_plane_from_behind():
    frame = plane_frame(SQUARE, PARTS, TRIANGLES, np.eye(3))
    behind = frame.mirrored()
    assert behind.u == pytest.approx(frame.u)
    assert behind.n == pytest.approx(-frame.n)
    assert np.cross(behind.u, behind.v) == pytest.approx(behind.n)


def test_no_area_has_no_frame():
    assert plane_frame(SQUARE * [1, 0, 0], PARTS, TRIANGLES, np.eye(3)) is None
    assert plane_frame(SQUARE, PARTS, np.empty((0, 3), np.int32), np.eye(3)) is None


def test_triangles_are_turned_counter_clockwise_in_rest():
    triangles = np.array([[0, 2, 1], [0, 2, 3]], np.int32)
    cutout = make_cutout(SQUARE[:, :2], triangles, np.zeros(4, np.int32))
    assert (signed_areas(cutout.rest, cutout.triangles) > 0).all()
    assert sorted(cutout.triangles[0]) == [0, 1, 2]
    assert cutout.diagonal == pytest.approx(np.sqrt(2))


def test_connected_parts_agree_with_a_search_through_the_graph():
    rng = np.random.default_rng(3)
    for _ in range(20):
        count = 60
        triangles = rng.integers(0, count, (25, 3)).astype(np.int32)
        part = np.full(count, -1)
        for start in range(count):
            if part[start] >= 0:
                continue
            label, stack = part.max() + 1, [start]
            while stack:
                vertex = stack.pop()
                if part[vertex] < 0:
                    part[vertex] = label
                    stack += triangles[(triangles == vertex).any(axis=1)].ravel().tolist()
        assert np.array_equal(connected_parts(count, triangles), part)


def test_a_long_strip_is_one_part():
    first = np.random.default_rng(0).permutation(5000).astype(np.int32)
    triangles = np.stack([first[:-2], first[1:-1], first[2:]], axis=1)
    assert not connected_parts(5000, triangles).any()


@pytest.mark.parametrize("seed", range(4))
def test_an_inverse_is_that_of_lapack_and_exact_where_it_can_be(seed):
    linear = random_linear(seed)
    assert inverse(linear) == pytest.approx(np.linalg.inv(linear), rel=1e-11)
    assert np.array_equal(inverse(np.diag([-2.0, 4.0, 0.5])), np.diag([-0.5, 0.25, 2.0]))


def test_points_are_told_by_their_parts():
    parts = np.array([0, 2, 1, 2, 0], np.int32)
    assert is_of(parts, {0, 1}).tolist() == [True, False, True, False, True]
    assert not is_of(parts, ()).any()
    assert len(is_of(parts[:0], ())) == 0
