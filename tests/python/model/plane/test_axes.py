# SPDX-License-Identifier: GPL-3.0-or-later
"""The axes along which pins are moved: the world's two that lie in the drawing's plane, or its own."""

import numpy as np
import pytest

from planar_deform.model.plane.axes import plane_axes
from planar_deform.model.plane.frame import plane_frame

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)  # drawn in its own XY plane
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
PARTS = np.zeros(4, np.int32)


def turn(axis: int, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def in_world(linear: np.ndarray, orientation: str) -> dict[str, np.ndarray]:
    """The directions in the world of the axes, by their letters."""
    frame = plane_frame(SQUARE, PARTS, TRIANGLES, linear)
    axes = plane_axes(frame, orientation)
    lifted = frame.lift(np.array([axes.offset((1.0, 0.0)), axes.offset((0.0, 1.0))]))
    return dict(zip(axes.letters, lifted, strict=True))


@pytest.mark.parametrize("degrees", [0.0, 30.0, -100.0, 180.0])
@pytest.mark.parametrize("scale", [(1, 1, 1), (3, 3, 3), (-1, 1, 2), (2, 0.5, 1)])
def test_an_imported_drawing_moves_along_the_worlds_x_and_z_however_it_is_turned(degrees, scale):
    linear = turn(1, degrees) @ turn(0, 90.0) @ np.diag(scale)
    along = in_world(linear, "GLOBAL")
    assert set(along) == {"X", "Z"}
    assert along["X"] == pytest.approx([1, 0, 0], abs=1e-6)
    assert along["Z"] == pytest.approx([0, 0, 1], abs=1e-6)
    own = in_world(linear, "LOCAL")
    assert set(own) == {"X", "Y"}
    assert own["X"] == pytest.approx(linear[:, 0] / np.linalg.norm(linear[:, 0]), abs=1e-6)
    assert own["Y"] == pytest.approx(linear[:, 1] / np.linalg.norm(linear[:, 1]), abs=1e-6)


def test_a_drawing_that_leans_moves_along_the_axes_that_are_nearest_to_its_plane():
    along = in_world(turn(0, 60.0), "GLOBAL")  # 30 degrees from upright
    assert along["X"] == pytest.approx([1, 0, 0], abs=1e-6)
    assert along["Z"] == pytest.approx([0, np.cos(np.radians(60)), np.sin(np.radians(60))], abs=1e-6)
    assert set(in_world(turn(0, 20.0), "GLOBAL")) == {"X", "Y"}
    assert set(in_world(turn(1, 80.0), "GLOBAL")) == {"Y", "Z"}


@pytest.mark.parametrize("orientation", ["GLOBAL", "LOCAL"])
def test_values_and_offsets_are_each_others_inverse(orientation):
    frame = plane_frame(SQUARE, PARTS, TRIANGLES, turn(1, 40.0) @ turn(0, 70.0) @ turn(2, 25.0))
    axes = plane_axes(frame, orientation)
    assert axes.values(axes.offset((0.3, -1.2))) == pytest.approx((0.3, -1.2), abs=1e-6)


def test_the_rounding_of_a_transform_does_not_turn_the_axes():
    linear = turn(0, 90.0).astype(np.float32).astype(float) + 1e-9
    axes = plane_axes(plane_frame(SQUARE, PARTS, TRIANGLES, linear), "GLOBAL")
    assert (axes.first, axes.second) == ((1.0, 0.0), (0.0, 1.0)), "a typed 0.5 is 0.5 to the bit"
