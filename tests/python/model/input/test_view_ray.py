# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays of sight: they meet what is seen at their place, and begin in front of it."""

import itertools

import numpy as np
import pytest

from planar_deform.model.input.view_ray import ray

# Near and far of a camera, or, where they are opposite, of a view without one.
RANGES = [(0.1, 100.0), (1e-6, 1e6), (9.9, 10.2), (0.1, 1e9), (-500.0, 500.0), (-5e5, 5e5)]
SIDES = [(-1.0, 1.0, -0.6, 0.6), (0.2, 2.2, -1.0, 0.2)]  # the second one is shifted


def projection(near: float, far: float, sides: tuple[float, ...], *, perspective: bool) -> np.ndarray:
    """As OpenGL has it and as Blender keeps it, in float32."""
    left, right, bottom, top = sides
    matrix = np.zeros((4, 4))
    if perspective:
        matrix[0, [0, 2]] = 2 * near / (right - left), (right + left) / (right - left)
        matrix[1, [1, 2]] = 2 * near / (top - bottom), (top + bottom) / (top - bottom)
        matrix[2, [2, 3]] = -(far + near) / (far - near), -2 * far * near / (far - near)
        matrix[3, 2] = -1.0
    else:
        matrix[0, [0, 3]] = 2 / (right - left), -(right + left) / (right - left)
        matrix[1, [1, 3]] = 2 / (top - bottom), -(top + bottom) / (top - bottom)
        matrix[2, [2, 3]] = -2 / (far - near), -(far + near) / (far - near)
        matrix[3, 3] = 1.0
    return matrix.astype(np.float32).astype(float)


def turned(seed: int) -> np.ndarray:
    """From the world to an eye somewhere."""
    rng = np.random.default_rng(seed)
    view = np.eye(4)
    view[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    view[:3, 3] = 3.0 * rng.normal(size=3)
    return view.astype(np.float32).astype(float)


@pytest.mark.parametrize(
    ("near", "far", "perspective"),
    [(*ends, False) for ends in RANGES] + [(*ends, True) for ends in RANGES if ends[0] > 0.0],
)
@pytest.mark.parametrize("sides", SIDES)
def test_a_ray_meets_what_is_seen_at_its_place(near, far, perspective, sides):
    window, view = projection(near, far, sides, perspective=perspective), turned(3)
    for depth, x, y in itertools.product((10.0, 10.1), (-0.8, 0.1, 1.0), (-1.0, 0.3)):
        at_depth = depth if perspective else 1.0
        seen = np.array(
            [
                (x * at_depth + window[0, 2] * depth - window[0, 3]) / window[0, 0],
                (y * at_depth + window[1, 2] * depth - window[1, 3]) / window[1, 1],
                -depth,
                1.0,
            ]
        )
        point = (np.linalg.inv(view) @ seen)[:3]
        origin, direction = ray(window, view, (x, y))
        along = float((point - origin) @ direction)
        assert along > 0.0, "it begins in front"
        assert np.linalg.norm(direction) == pytest.approx(1.0)
        size = max(1.0, np.abs(point).max(), along * 1e-3)
        assert origin + along * direction == pytest.approx(point, abs=1e-9 * size)


def test_without_a_camera_what_is_behind_the_eye_is_seen_too():
    window = projection(-500.0, 500.0, SIDES[0], perspective=False)
    origin, direction = ray(window, np.eye(4), (0.0, 0.0))
    assert origin == pytest.approx([0.0, 0.0, 500.0], rel=1e-6)
    assert direction == pytest.approx([0.0, 0.0, -1.0])
