# SPDX-License-Identifier: GPL-3.0-or-later
"""Places of a mesh that others go with, against closed forms."""

import numpy as np
import pytest

from planar_deform.model.plane.cutout import make_cutout
from planar_deform.model.plane.locate import nearest_point
from planar_deform.model.posing.attaching import hanging_place
from planar_deform.model.posing.mesh_place import place_binding, rigid_motion, spanning


def turn(axis, angle):
    """The rotation about an axis, by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def sheet(nx, ny, width=1.0, height=1.0, at=(0.0, 0.0)):
    """Vertices (k x 2) and triangles of a grid."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1) + at[0], np.linspace(0, height, ny + 1) + at[1])
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    triangles = np.concatenate(
        [
            np.stack([first, first + 1, first + nx + 2], 1),
            np.stack([first, first + nx + 2, first + nx + 1], 1),
        ]
    )
    return np.stack([x.ravel(), y.ravel()], axis=1), triangles.astype(np.int32)


def moved(motion, points):
    return points @ motion[:3, :3].T + motion[:3, 3]


@pytest.fixture
def draw():
    return np.random.default_rng(3)


@pytest.mark.parametrize("across", [0.0, 1.0], ids=["in a plane", "in space"])
def test_a_rigid_motion_is_found_to_rounding(draw, across):
    points = draw.normal(size=(12, 3)) * (1.0, 1.0, across)
    rotation, offset = turn((0.2, -0.5, 1.0), 2.1), np.array((3.0, -2.0, 0.5))
    motion = rigid_motion(points, points @ rotation.T + offset, draw.uniform(0.1, 1.0, 12))
    np.testing.assert_allclose(motion[:3, :3], rotation, atol=1e-8)
    np.testing.assert_allclose(moved(motion, points), points @ rotation.T + offset, atol=1e-7)


def test_what_is_stretched_does_not_turn_and_what_is_sheared_turns_by_half_of_it(draw):
    points = draw.normal(size=(9, 3)) * (1.0, 1.0, 0.0)
    weights = draw.uniform(0.1, 1.0, 9)
    along = turn((0, 0, 1), 0.4)
    stretch = along @ np.diag([2.5, 0.6, 1.0]) @ along.T
    np.testing.assert_allclose(
        rigid_motion(points, points @ stretch.T, weights)[:3, :3], np.eye(3), atol=1e-8
    )
    shear = np.array([[1.0, 0.8, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    found = rigid_motion(points, points @ shear.T, weights)[:3, :3]
    np.testing.assert_allclose(found, turn((0, 0, 1), -np.arctan(0.4)), atol=1e-8)


def test_points_of_a_line_and_a_single_one_are_turned_as_little_as_can_be():
    line = np.outer(np.arange(4.0), (1.0, 0.0, 0.0))
    rotation = turn((0, 0, 1), 0.7)
    motion = rigid_motion(line, line @ rotation.T, np.ones(4))
    np.testing.assert_allclose(motion[:3, :3], rotation, atol=1e-6)
    motion = rigid_motion(line[:1], line[:1] + np.array((1.0, 2.0, 3.0)), np.ones(1))
    np.testing.assert_allclose(motion[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(motion[:3, 3], (1.0, 2.0, 3.0), atol=1e-12)


def test_a_place_is_of_its_own_finger():
    """Two fingers that lie closer to each other than a place reaches, joined far away."""
    points, triangles = sheet(40, 80)
    middles = points[triangles].mean(axis=1)
    triangles = triangles[~((np.abs(middles[:, 0] - 0.4875) < 0.013) & (middles[:, 1] > 0.2))]
    used, back = np.unique(triangles, return_inverse=True)
    points, triangles = points[used], back.reshape(triangles.shape).astype(np.int32)
    cutout = make_cutout(points, triangles, np.zeros(len(points), np.int32))
    every = np.arange(len(triangles), dtype=np.int32)
    found = nearest_point(points, cutout.triangles, np.array((0.47, 0.9)), every)
    rows, weights = place_binding(cutout, found)
    assert len(rows) >= 6
    assert points[rows, 0].max() < 0.49
    assert np.linalg.norm(points[rows] - (0.47, 0.9), axis=1).max() < 0.06
    assert weights.min() > 0.0
    assert weights.max() <= 1.0


def test_a_coarse_mesh_gives_all_it_has():
    points, triangles = sheet(1, 1)
    cutout = make_cutout(points, triangles, np.zeros(4, np.int32))
    rows, weights = place_binding(cutout, nearest_point(points, cutout.triangles, points[0], np.arange(2)))
    assert sorted(rows) == [0, 1, 2, 3]
    assert weights.argmax() == 0


def test_three_that_span_much(draw):
    points = draw.uniform(size=(30, 2))
    first, second, third = spanning(points)
    sides = np.linalg.norm(points[:, None] - points[None], axis=2)
    assert len({first, second, third}) == 3
    assert sides[first, second] > 0.8 * sides.max()
    one, other = points[second] - points[first], points[third] - points[first]
    assert abs(one[0] * other[1] - one[1] * other[0]) > 0.3


def test_one_drawing_hangs_on_another_where_they_lie_on_each_other():
    below, triangles = sheet(20, 5, 2.0, 0.5)
    above, more = sheet(3, 9, 0.3, 0.9, at=(1.5, -0.7))  # 0.2 of it on the other
    cutout = make_cutout(
        np.concatenate([below, above]),
        np.concatenate([triangles, more + len(below)]),
        np.repeat([0, 1], [len(below), len(above)]).astype(np.int32),
    )
    place = hanging_place(cutout, 1)
    np.testing.assert_allclose(place, (1.65, 0.1), atol=0.06)
    apart = make_cutout(
        cutout.rest + np.where(cutout.parts == 1, 5.0, 0.0)[:, None], cutout.triangles, cutout.parts
    )
    assert hanging_place(apart, 1) is None
