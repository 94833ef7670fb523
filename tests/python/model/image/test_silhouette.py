# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes filled anew within the outline that they have, and places on their rims."""

import numpy as np
import pytest
from cutouts import grid_cutout

from planar_deform import native
from planar_deform.model.image.filling import Filling, Piece
from planar_deform.model.image.reaching import reaching
from planar_deform.model.image.silhouette import Overlap, Wish, contour, refilled
from planar_deform.model.plane.cutout import connected_parts, oriented, signed_areas
from planar_deform.model.plane.locate import nearest_point


def going_on(_share):
    return True


def fill(rest, triangles, **wish):
    parts = connected_parts(len(rest), triangles)
    return refilled(rest, oriented(rest, triangles), parts, Wish(**wish), going_on)


def area(filling):
    return signed_areas(filling.places, filling.triangles).sum()


def angles(filling):
    """The smallest of each triangle, in degrees."""
    a, b, c = (filling.places[filling.triangles[:, corner]] for corner in range(3))
    found = []
    for tip, one, other in ((a, b, c), (b, c, a), (c, a, b)):
        u, v = one - tip, other - tip
        found.append(np.abs(np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1))))
    return np.degrees(np.min(found, axis=0))


@pytest.mark.parametrize("count", [100, 500, 3000])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_a_grid_is_filled_evenly(count, scale):
    cutout = grid_cutout(12, 5)
    found = fill(cutout.rest * scale + 3.0 * scale, cutout.triangles, vertices=count)
    assert 0.75 * count < len(found.places) < 1.3 * count
    assert area(found) == pytest.approx(60.0 * scale**2, rel=5e-3)
    assert (signed_areas(found.places, found.triangles) > 0.0).all()
    assert angles(found).min() > 15.0
    assert angles(found).mean() > 45.0
    assert found.said == ()


def disc(count=40, radius=1.0):
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    rim = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    triangles = [[0, i + 1, (i + 1) % count + 1] for i in range(count)]
    return np.concatenate([[[0.0, 0.0]], rim]), np.array(triangles, np.int32)


def test_it_stays_where_it_is_however_often():
    rest, triangles = disc()
    first = area(fill(rest, triangles, vertices=700))
    for _ in range(6):
        found = fill(rest, triangles, vertices=700)
        rest, triangles = found.places, found.triangles
    assert area(found) == pytest.approx(first, rel=4e-3)
    assert np.linalg.norm(rest, axis=1).max() < 1.01


def test_tips_and_thin_parts_stay():
    """A blade of a thousandth of its length in the middle, and pointed."""
    along = np.linspace(0.0, 1.0, 41)
    half = 0.0015 + 0.02 * np.abs(along - 0.5) * (along > 0) * (along < 1)
    rest = np.concatenate([np.stack([along, half], axis=1), np.stack([along, -half], axis=1)])
    cells = [[i, 41 + i, i + 1] for i in range(40)] + [[i + 1, 41 + i, 42 + i] for i in range(40)]
    found = fill(rest, np.array(cells, np.int32), vertices=400)
    assert len(found.pieces) == 1
    assert connected_parts(len(found.places), found.triangles).max() == 0
    assert found.places[:, 0].min() < 0.01
    assert found.places[:, 0].max() > 0.99


def test_holes_stay_or_are_filled():
    cutout = grid_cutout(9, 9)
    middles = cutout.rest[cutout.triangles].mean(axis=1)
    ring = cutout.triangles[~((middles > 3) & (middles < 6)).all(axis=1)]
    used, compact = np.unique(ring, return_inverse=True)
    rest, triangles = cutout.rest[used], compact.reshape(-1, 3).astype(np.int32)
    assert area(fill(rest, triangles, vertices=500)) == pytest.approx(72.0, rel=1e-2)
    assert area(fill(rest, triangles, vertices=500, fill=True)) == pytest.approx(81.0, rel=1e-2)


def test_each_part_is_filled_by_itself_though_they_lie_over_each_other():
    cutout = grid_cutout(4, 4)
    rest = np.concatenate([cutout.rest, cutout.rest * 0.5 + 1.0, cutout.rest * 0.01 + 20.0])
    triangles = np.concatenate([cutout.triangles + 25 * number for number in range(3)]).astype(np.int32)
    found = fill(rest, triangles, vertices=800)
    assert [piece.parts.tolist() for piece in found.pieces] == [[0], [1], [2]]
    areas = [signed_areas(piece.places, piece.triangles).sum() for piece in found.pieces]
    assert areas == pytest.approx([16.0, 4.0, 16e-4], rel=2e-2)


def test_what_lies_over_itself_is_refused():
    cutout = grid_cutout(4, 2)
    folded = np.abs(cutout.rest - [2.0, 0.0])
    with pytest.raises(Overlap):
        fill(folded, cutout.triangles, vertices=200)


def test_an_edge_length_counts_instead_and_a_margin_goes_outwards():
    cutout = grid_cutout(10, 4)
    found = fill(cutout.rest, cutout.triangles, edge=0.5)
    ends = found.places[contour(found.triangles)]
    assert np.median(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)) == pytest.approx(0.5, rel=0.2)
    grown = fill(cutout.rest, cutout.triangles, edge=0.5, grown=0.3)
    assert area(grown) == pytest.approx(10.6 * 4.6 - (4 - np.pi) * 0.09, rel=1e-2)


def test_what_needs_more_vertices_is_said():
    turns = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    radii = 1.0 + 0.3 * np.sin(20 * turns)
    rim = radii[:, None] * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rest = np.concatenate([[[0.0, 0.0]], rim])
    triangles = np.array([[0, i + 1, (i + 1) % 240 + 1] for i in range(240)], np.int32)
    found = fill(rest, triangles, vertices=60)
    assert len(found.places) > 75
    assert "needs" in found.said[0]


def test_it_can_be_cancelled():
    cutout = grid_cutout(4, 4)
    parts = np.zeros(len(cutout.rest), np.int32)
    with pytest.raises(native.Cancelled):
        refilled(cutout.rest, cutout.triangles, parts, Wish(), lambda _: False)


def test_what_lies_on_both_sides_cancels_in_a_contour():
    cutout = grid_cutout(3, 3)
    assert len(contour(cutout.triangles)) == 12
    twice = np.concatenate([cutout.triangles, cutout.triangles])
    assert len(contour(twice)) == 24


# ---- places on the rim


def test_places_just_outside_become_vertices_of_the_rim():
    cutout = grid_cutout(6, 3)
    filling = Filling([Piece(cutout.rest, cutout.triangles, np.array([0]))])
    places = np.array([[-0.02, 1.0], [2.5, 3.03], [6.05, 3.05], [4.45, -0.04], [3.0, 1.5]])
    found = reaching(filling, places, np.zeros(5, np.int32))
    everything = np.arange(len(found.triangles), dtype=np.int32)
    for place in places:
        assert nearest_point(found.places, found.triangles, place, everything).distance == 0.0
    assert (signed_areas(found.places, found.triangles) > 0.0).all()
    assert len(found.places) <= len(cutout.rest) + 3


def test_two_places_at_one_vertex_both_stay():
    cutout = grid_cutout(6, 3)
    filling = Filling([Piece(cutout.rest, cutout.triangles, np.array([0]))])
    places = np.array([[2.95, 3.05], [3.05, 3.05]])
    found = reaching(filling, places, np.zeros(2, np.int32))
    for place in places:
        assert np.linalg.norm(found.places - place, axis=1).min() == 0.0
    assert (signed_areas(found.places, found.triangles) > 0.0).all()


def test_places_far_away_and_in_other_parts_change_nothing():
    cutout = grid_cutout(6, 3)
    filling = Filling([Piece(cutout.rest, cutout.triangles, np.array([0]))])
    found = reaching(filling, np.array([[9.0, 9.0], [-0.01, 1.0]]), np.array([0, 1], np.int32))
    assert np.array_equal(found.places, filling.places)
