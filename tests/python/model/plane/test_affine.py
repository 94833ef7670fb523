# SPDX-License-Identifier: GPL-3.0-or-later
"""Which map took a shape as a whole to what it is, and when there is none."""

import numpy as np
import pytest

from planar_deform.model.plane.affine import affine_between

RNG = np.random.default_rng(5)
LINEAR = {
    "moved": np.eye(3),
    "scaled": np.diag([4.0, 4.0, 4.0]),
    "stretched": np.diag([2.0, 0.5, -1.0]),
    "turned": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "sheared": np.array([[1.0, 0.4, 0.1], [0.0, 1.2, 0.0], [0.3, 0.0, 0.7]]),
    "tiny": 1e-3 * np.eye(3),
}


def drawing(layers, count=1500):
    """Points of one or several parallel planes that are tilted in space, far from the origin; float32."""
    points = RNG.uniform(-1.0, 1.0, (count, 3)) * [3.0, 1.0, 0.0]
    points[:, 2] = RNG.integers(0, layers, count) * 0.05
    tilt = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    return (points @ tilt.T + [20.0, -7.0, 3.0]).astype(np.float32)


def mapped(points, linear, offset=(3.0, -2.0, 0.5)):
    """As Blender computes it."""
    return (points @ linear.T.astype(np.float32) + np.float32(offset)).astype(np.float32)


@pytest.mark.parametrize("layers", [1, 3])
@pytest.mark.parametrize("name", LINEAR)
@pytest.mark.parametrize("edited", [0, 30, 600])
def test_the_map_is_found_although_some_points_were_edited_besides(name, layers, edited):
    points = drawing(layers)
    after = mapped(points, LINEAR[name])
    size = np.ptp(after, axis=0).max()
    after[:edited] += size * RNG.normal(size=(edited, 3)).astype(np.float32)
    found = affine_between(points, after)
    assert found is not None
    exact = points.astype(float) @ LINEAR[name].T + [3.0, -2.0, 0.5]
    assert found.of(points) == pytest.approx(exact, abs=2e-6 * np.abs(exact).max())
    # So is the rest shape, which lies in the same planes.
    if layers > 1:
        assert found.linear == pytest.approx(LINEAR[name], abs=0.02 * np.abs(LINEAR[name]).max())


def test_what_has_not_moved_was_not_mapped():
    assert affine_between(drawing(1), drawing(1)) is None
    points = drawing(1)
    assert affine_between(points, points.copy()) is None


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_part_that_was_moved_scaled_or_turned_is_no_map_of_the_whole(share):
    for linear in LINEAR.values():
        points = drawing(1)
        after = points.copy()
        rows = slice(0, int(share * len(points)))
        after[rows] = mapped(points[rows], linear)
        assert affine_between(points, after) is None


def test_a_bend_and_noise_are_no_maps():
    points = drawing(1)
    bent = points.copy()
    bent[:, 1] += 0.1 * points[:, 0] ** 2
    assert affine_between(points, bent) is None
    assert affine_between(points, points + RNG.normal(0, 0.01, points.shape).astype(np.float32)) is None


def test_points_that_the_map_itself_leaves_in_place_are_no_objection():
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1).astype(np.float32)
    after = points * np.float32([1.0, -2.0, 1.0])  # y = 0 stays
    found = affine_between(points, after)
    assert found.of(points) == pytest.approx(after)
    assert found.turns_over(points)
    assert not affine_between(points, points * np.float32(3.0)).turns_over(points)


@pytest.mark.parametrize("count", [3, 4, 5])
def test_coarse_shapes(count):
    points = RNG.normal(size=(count, 3)).astype(np.float32) * np.float32([1, 1, 0])
    after = mapped(points, LINEAR["sheared"])
    assert affine_between(points, after).of(points) == pytest.approx(after, abs=1e-5)


def test_lines_and_numbers_that_are_none_have_no_map():
    line = np.outer(np.arange(5.0), [1.0, 2.0, 0.0]).astype(np.float32)
    assert affine_between(line, 2 * line) is None
    broken = drawing(1)
    broken[3] = np.nan
    assert affine_between(drawing(1), broken) is None
