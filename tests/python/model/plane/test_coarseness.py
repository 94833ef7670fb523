# SPDX-License-Identifier: GPL-3.0-or-later
"""When a mesh counts as too coarse to bend, and that it is."""

import numpy as np
import pytest
from cutouts import grid_cutout

import planar_native as planar
from planar_deform.model.plane.coarseness import hinged, is_coarse


def bent(nx: int, ny: int) -> float:
    """How much a bar of 8 x 1 is distorted when its ends are bent up, above no distortion."""
    cutout = grid_cutout(nx, ny)
    rest = cutout.rest * [8 / nx, 1 / ny]
    places = np.array([[0.0, 0.5], [4.0, 0.5], [8.0, 0.5]])
    handles = [int(np.linalg.norm(rest - place, axis=1).argmin()) for place in places]
    poser = planar.Poser(rest, cutout.triangles)
    poser.set_handles(np.array(handles, np.int32))
    ends = np.array([[1.2, 2.5], [0.0, 0.0], [-1.2, 2.5]])
    for share in np.linspace(0.05, 1.0, 20):
        poser.move(rest[handles] + share * ends)
    return planar.distortion(rest, poser.settle(), cutout.triangles).area - 2.0


@pytest.mark.parametrize("nx", [16, 32, 64])
def test_one_row_of_triangles_bends_badly_however_many_there_are_along_it(nx):
    assert bent(nx, 1) > 3.0 * bent(nx, 2)
    assert bent(nx, 2) < 1.5 * bent(2 * nx, 8)
    one, two = grid_cutout(nx, 1), grid_cutout(nx, 2)
    assert hinged(one.rest, one.triangles) == 1.0
    assert is_coarse(one.rest, one.triangles)
    assert hinged(two.rest, two.triangles) < 0.05
    assert is_coarse(two.rest, two.triangles) == (len(two.rest) < 50)


def test_few_vertices_are_coarse_even_with_two_rows():
    for size in (1, 2, 4):
        cutout = grid_cutout(size, size)
        assert is_coarse(cutout.rest, cutout.triangles)
    cutout = grid_cutout(8, 8)
    assert not is_coarse(cutout.rest, cutout.triangles)


def test_a_thin_part_of_a_fine_drawing_does_not_make_it_coarse():
    body, tail = grid_cutout(10, 10), grid_cutout(6, 1)
    rest = np.concatenate([body.rest, tail.rest + np.array([20.0, 0.0])])
    triangles = np.concatenate([body.triangles, tail.triangles + len(body.rest)])
    assert 0.0 < hinged(rest, triangles) < 0.1
    assert not is_coarse(rest, triangles)
    assert is_coarse(np.concatenate([body.rest, tail.rest * 3.0 + np.array([20.0, 0.0])]), triangles)


def test_no_triangles_and_no_area():
    assert hinged(np.zeros((3, 2)), np.empty((0, 3), np.int32)) == 0.0
    assert hinged(np.zeros((3, 2)), np.array([[0, 1, 2]], np.int32)) == 0.0
