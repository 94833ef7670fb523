# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a mesh in space, against dense sampling."""

import numpy as np
import pytest

from planar_deform.model.plane.locate import at
from planar_deform.model.plane.space import first_met, nearest_in_space

RANDOM = np.random.default_rng(11)
POINTS = RANDOM.normal(size=(30, 3))
TRIANGLES = RANDOM.permuted(np.tile(np.arange(30), (20, 1)), axis=1)[:, :3].astype(np.int32)
EVERY = np.arange(20, dtype=np.int32)


def sampled():
    """Points of all triangles, close to each other."""
    steps = 60
    i, j = np.meshgrid(np.arange(steps + 1), np.arange(steps + 1))
    kept = i + j <= steps
    weights = np.stack([i[kept], j[kept], steps - i[kept] - j[kept]], axis=1) / steps
    return np.einsum("sc,tcd->tsd", weights, POINTS[TRIANGLES])


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_point(seed):
    place = np.random.default_rng(seed).normal(size=3) * 1.5
    found = nearest_in_space(POINTS, TRIANGLES, place, EVERY)
    least = np.linalg.norm(sampled() - place, axis=2).min()
    assert np.linalg.norm(at(POINTS, TRIANGLES, found) - place) == pytest.approx(found.distance)
    assert least - 0.05 < found.distance <= least + 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_the_point_that_a_ray_meets_first(seed):
    random = np.random.default_rng(seed)
    triangle = random.integers(20)
    through = random.dirichlet(np.ones(3)) @ POINTS[TRIANGLES[triangle]]
    origin = through + random.normal(size=3) * 5
    direction = (through - origin) / np.linalg.norm(through - origin)
    found = first_met(POINTS, TRIANGLES, origin, direction)
    place = at(POINTS, TRIANGLES, found)
    along = (place - origin) @ direction
    np.testing.assert_allclose(origin + along * direction, place, atol=1e-9)
    assert 0 < along <= np.linalg.norm(through - origin) + 1e-9
    if found.triangle != triangle:
        assert along < np.linalg.norm(through - origin)


def test_nothing_behind_the_eye_and_no_triangle_without_area_is_met():
    triangles = np.array([[0, 1, 2], [3, 3, 3]], np.int32)
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1.0]])
    down, up = np.array([0.0, 0, -1]), np.array([0.0, 0, 1])
    eye = np.array([0.2, 0.2, 2.0])
    assert first_met(points, triangles, eye, down).triangle == 0
    assert first_met(points, triangles, eye, up) is None
    near = nearest_in_space(points, triangles, np.array([0.2, 0.2, 1.1]), np.arange(2, dtype=np.int32))
    assert (near.triangle, near.distance) == (1, pytest.approx(0.1))
