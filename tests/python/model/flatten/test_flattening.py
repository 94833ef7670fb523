# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches laid flat one after the other, with and without held vertices."""

import numpy as np
import pytest
from test_patches import patches, sheet

from planar_deform import native
from planar_deform.model.flatten.flattening import Held, PatchError, Settings, flatten, lengths_kept

NX, NY = 12, 4
CHORD = 2.0 * np.sin(0.1)  # of a step about the axis


def bent(seams=()):
    """A sheet bent about an axis, cut along edges, and its flat vertices on it."""
    found = patches(sheet(NX, NY), seams)
    x, y = np.meshgrid(0.2 * np.arange(NX + 1), 0.25 * np.arange(NY + 1))
    places = np.stack([np.sin(x), -np.cos(x), y], axis=2).reshape(-1, 3)
    return found, places[found.vertices]


def going_on(_share):
    return True


def test_lengths_are_compared_edge_by_edge():
    surface = np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    flat = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 2.4], [0.0, 2.4]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)  # the last one has an edge without length
    assert lengths_kept(surface, flat, triangles) == pytest.approx((0.8, np.hypot(10.0, 2.4) / 4.0))


def test_lengths_stay_and_the_share_done_grows_to_all_of_it():
    middle = NX // 2
    found, places = bent([(j * (NX + 1) + middle, (j + 1) * (NX + 1) + middle) for j in range(NY)])
    shares = []
    flat = flatten(places, found, Settings(), lambda share: shares.append(share) or True)
    assert found.count == 2
    ends = found.edges
    lengths = [np.linalg.norm(p[ends[:, 0]] - p[ends[:, 1]], axis=1) for p in (flat.places, places)]
    assert np.abs(lengths[0] / lengths[1] - 1.0).max() < 1e-9
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert flat.unit == 1.0


def test_nobody_waits_any_more():
    with pytest.raises(native.Cancelled):
        flatten(*bent()[::-1], Settings(), lambda _share: False)


def test_held_vertices_are_where_the_map_has_them_in_its_unit():
    found, places = bent()
    corners = [0, NX, (NX + 1) * (NY + 1) - 1, (NX + 1) * NY]
    turn = np.array([[np.cos(2.5), np.sin(2.5)], [-np.sin(2.5), np.cos(2.5)]])
    true = np.array([[0.0, 0.0], [NX * CHORD, 0.0], [NX * CHORD, 1.0], [0.0, 1.0]])
    order = np.argsort(corners)
    held = Held(np.array(corners, np.int32)[order], (0.1 * true @ turn + 3.0)[order])
    flat = flatten(places, found, Settings(), going_on, held)
    assert flat.unit == pytest.approx(10.0)
    assert flat.held.tolist() == [0]
    assert np.abs(flat.places[held.rows] / flat.unit - held.places).max() < 1e-6


def test_one_held_vertex_tells_a_place_and_no_unit():
    found, places = bent()
    flat = flatten(
        places, found, Settings(), going_on, Held(np.array([7], np.int32), np.array([[0.5, 0.25]]))
    )
    assert np.allclose(flat.places[7] / flat.unit, (0.5, 0.25))
    assert np.ptp(flat.places / flat.unit, axis=0).max() == pytest.approx(1.0)


def test_a_patch_that_cannot_be_laid_flat_is_told():
    closed = [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]
    found = patches([*closed, (4, 5, 6)])
    places = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [5, 0, 0], [6, 0, 0], [5, 1, 0]], float)
    with pytest.raises(PatchError, match=r"^the surface is closed") as error:
        flatten(places[found.vertices], found, Settings(), going_on)
    assert error.value.patch == 0
    assert found.face_in(1) == 4


def test_the_fixed_edge_is_that_of_the_surface():
    found, places = bent()
    flat = flatten(places, found, Settings(fixed=(NX + 1, 0)), going_on)
    along = flat.places[0] - flat.places[NX + 1]
    assert abs(along[1]) < 1e-9
    assert abs(along[0]) == pytest.approx(0.25)
