# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the pixels of an image lie in a mesh that shows it, however its UV map has it."""

import numpy as np
import pytest

from planar_deform.model.image.placement import Misfit, Window, affine_fit, placed

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
SIZE = (400, 300)
# Of the corners of a plane: what of the image each one shows.
TURNS = {
    "upright": SQUARE,
    "turned": SQUARE[[1, 2, 3, 0]],
    "upside down": SQUARE[[2, 3, 0, 1]],
    "mirrored": SQUARE[[1, 0, 3, 2]],
    "mirrored and turned": SQUARE[[0, 3, 2, 1]],
}


def plane(tilt=True):
    """The corners of a plane of 4 x 3, tilted in space; and its normal."""
    corners = np.insert((SQUARE - 0.5) * [4.0, 3.0], 2, 0.0, axis=1)
    axes = np.linalg.qr(np.array([[1.0, 2, 3], [0.2, -1, 1], [1, 1, -2]]))[0] if tilt else np.eye(3)
    axes *= np.sign(np.linalg.det(axes))
    return corners @ axes.T + [20.0, -7.0, 3.0], axes[:, 2]


@pytest.mark.parametrize("turn", TURNS)
def test_pixels_lie_where_the_corners_have_them(turn):
    corners, normal = plane()
    placement = placed(TURNS[turn], corners, normal, SIZE)
    assert placement.places(TURNS[turn] * SIZE) == pytest.approx(corners, abs=1e-12)
    assert placement.window == Window(0, 0, 400, 300)
    # A triangle counter-clockwise in the image, turned where said, faces where the plane faces.
    a, b, c = placement.places(np.array([[10.0, 10.0], [200.0, 15.0], [40.0, 250.0]]))
    assert placement.mirrored == (np.cross(b - a, c - a) @ normal < 0)
    assert placement.mirrored == turn.startswith("mirrored")


def test_a_plane_may_show_a_part_of_an_image():
    corners, normal = plane(tilt=False)
    placement = placed(SQUARE * [0.25, 0.5] + [0.5, 0.0], corners, normal, SIZE)
    assert placement.window == Window(200, 0, 300, 150)
    assert placement.places(np.array([[200.0, 0.0], [300.0, 150.0]])) == pytest.approx(corners[[0, 2]])


def test_what_of_the_uv_map_lies_beyond_the_image_shows_nothing():
    corners, normal = plane()
    assert placed(SQUARE * 1.5 - 0.25, corners, normal, SIZE).window == Window(0, 0, 400, 300)


def test_a_subdivided_plane_is_a_plane():
    grid = np.random.default_rng(2).uniform(0, 1, (40, 2))
    corners = grid @ np.array([[3.0, 1, 0], [0.5, -2, 1]])
    assert placed(grid, corners, np.array([0, 0, 1.0]), SIZE).window.right > 380


def test_what_is_no_image_plane_is_told():
    corners, normal = plane()
    keystone = corners + np.array([[0, 0, 0], [0, 0, 0], [0.3, 0, 0], [0, 0, 0]])
    for uvs, places, told in (
        (SQUARE, keystone, "evenly"),
        (SQUARE * [1.0, 0.0], corners, "UV map has no area"),
        (SQUARE, corners * 0.0, "has no area"),
        (SQUARE, corners * np.nan, "not numbers"),
        (SQUARE + 2.0, corners, "outside of the image"),
    ):
        with pytest.raises(Misfit, match=told):
            placed(uvs, places, normal, SIZE)


def test_half_a_pixel_is_near_enough():
    corners, normal = plane()
    nudged = corners + np.array([[0, 0, 0], [0, 0, 0], [0.004, 0, 0], [0, 0, 0]])
    assert placed(SQUARE, nudged, normal, SIZE).window == Window(0, 0, 400, 300)


def test_points_on_a_line_tell_no_map():
    assert affine_fit([[0, 0], [1, 1], [2, 2]], [[0], [1], [2]]) is None
