# SPDX-License-Identifier: GPL-3.0-or-later
"""What vertices have, carried to other points of the plane."""

import numpy as np
import pytest
from cutouts import grid_cutout

from planar_deform.model.plane.carrying import boundary, carrying
from planar_deform.model.plane.charts import charts_of, corner_carrying
from planar_deform.model.plane.locate import nearest_point


def turned(places, scale):
    c, s = np.cos(0.7), np.sin(0.7)
    return (places @ np.array([[c, s], [-s, c]]) + [0.3, 9.0]) * scale


@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e4])
def test_an_affine_map_is_carried_exactly_also_outside_of_the_mesh(scale):
    cutout = grid_cutout(7, 4)
    rest = turned(cutout.rest, scale)
    places = turned(np.random.default_rng(1).uniform(-3.0, 10.0, (500, 2)), scale)
    found = carrying(rest, cutout.triangles, places)
    assert np.abs(found.of(rest) - places).max() < 1e-10 * scale
    linear = np.array([[1.0, 2.0, 0.5], [-0.3, 0.1, 4.0]])
    assert np.abs(found.of(rest @ linear) - places @ linear).max() < 1e-8 * scale


def test_points_within_hang_in_the_triangle_that_holds_them():
    cutout = grid_cutout(9, 6)
    places = np.random.default_rng(2).uniform([0, 0], [9, 6], (300, 2))
    found = carrying(cutout.rest, cutout.triangles, places)
    assert found.weights.min() > -1e-9
    everything = np.arange(len(cutout.triangles), dtype=np.int32)
    for place, triangle, weights in zip(places, found.triangles, found.weights, strict=True):
        expected = nearest_point(cutout.rest, cutout.triangles, place, everything)
        assert triangle == expected.triangle
        assert weights == pytest.approx(expected.weights, abs=1e-12)


def test_points_outside_hang_in_the_nearest_triangle():
    cutout = grid_cutout(9, 6)
    draw = np.random.default_rng(3)
    places = draw.uniform([-4, -4], [13, 10], (400, 2))
    places = places[((places < 0) | (places > [9, 6])).any(axis=1)]
    found = carrying(cutout.rest, cutout.triangles, places)
    everything = np.arange(len(cutout.triangles), dtype=np.int32)
    for place, triangle in zip(places, found.triangles, strict=True):
        nearest = nearest_point(cutout.rest, cutout.triangles, place, everything).distance
        own = nearest_point(cutout.rest, cutout.triangles, place, np.array([triangle])).distance
        assert own == pytest.approx(nearest, abs=1e-9)


def test_vertices_and_edges_and_corners_of_the_mesh_are_in_it():
    cutout = grid_cutout(5, 5)
    middles = cutout.rest[cutout.triangles].mean(axis=1)
    sides = (cutout.rest[cutout.triangles] + cutout.rest[np.roll(cutout.triangles, 1, axis=1)]).reshape(
        -1, 2
    ) / 2
    places = np.concatenate([cutout.rest, middles, sides])
    found = carrying(cutout.rest, cutout.triangles, places)
    assert np.abs(found.of(cutout.rest) - places).max() < 1e-12
    assert found.weights.min() > -1e-9
    assert np.abs(found.within - found.weights).max() < 1e-9


def test_triangles_without_area_hold_nothing():
    cutout = grid_cutout(4, 4)
    flat = np.array([[0, 1, 2], [5, 5, 6]], np.int32)
    triangles = np.concatenate([flat, cutout.triangles])
    places = np.random.default_rng(4).uniform(-1, 5, (100, 2))
    found = carrying(cutout.rest, triangles, places)
    assert found.triangles.min() >= 2
    assert np.isfinite(found.weights).all()
    assert np.abs(found.of(cutout.rest) - places).max() < 1e-9


def test_weights_within_stay_between_those_of_the_corners_far_outside():
    cutout = grid_cutout(3, 3)
    found = carrying(cutout.rest, cutout.triangles, np.array([[100.0, -50.0], [-7.0, 1.0]]))
    assert found.within.min() >= 0.0
    assert found.within.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_a_large_mesh_takes_a_blink():
    cutout = grid_cutout(200, 200)
    places = np.random.default_rng(5).uniform(-1, 201, (40_000, 2))
    found = carrying(cutout.rest, cutout.triangles, places)
    assert np.abs(found.of(cutout.rest) - places).max() < 1e-9


def test_the_boundary_goes_round_with_the_mesh_on_its_left():
    cutout = grid_cutout(3, 2)
    edges, owners = boundary(cutout.triangles)
    assert len(edges) == 10
    ends = cutout.rest[edges]
    (x, y), (next_x, next_y) = ends[:, 0].T, ends[:, 1].T
    assert 0.5 * (x * next_y - y * next_x).sum() == pytest.approx(6.0)
    for edge, owner in zip(edges, owners, strict=True):
        assert set(edge) <= set(cutout.triangles[owner])


# ---- corners


def corners_of(cutout):
    """Each triangle has corners of its own."""
    return np.arange(3 * len(cutout.triangles), dtype=np.int32).reshape(-1, 3)


def test_charts_end_where_values_jump_and_where_kinds_do():
    cutout = grid_cutout(4, 2)
    middles = cutout.rest[cutout.triangles].mean(axis=1)
    smooth = cutout.rest[cutout.triangles]
    torn = smooth + 10.0 * (middles[:, 0] > 2.0)[:, None, None]
    none = np.zeros(len(middles), np.int32)
    assert charts_of(cutout.triangles, none, [smooth]).max() == 0
    charts = charts_of(cutout.triangles, none, [smooth, torn])
    assert charts.max() == 1
    assert len(set(charts[middles[:, 0] > 2.0])) == 1
    kinds = (middles[:, 1] > 1.0).astype(np.int32)
    assert charts_of(cutout.triangles, kinds, [smooth, torn]).max() == 3


def test_corners_of_a_face_take_values_of_one_chart():
    cutout = grid_cutout(4, 2)
    middles = cutout.rest[cutout.triangles].mean(axis=1)
    right = middles[:, 0] > 2.0
    values = cutout.rest[cutout.triangles] + 10.0 * right[:, None, None]
    charts = charts_of(cutout.triangles, np.zeros(len(right), np.int32), [values])
    places = np.array([[1.7, 0.2], [2.4, 0.2], [1.9, 1.4], [2.3, 1.5]])
    faces = np.array([[0, 1, 2], [1, 3, 2]], np.int32)
    inside = carrying(cutout.rest, cutout.triangles, places[faces].mean(axis=1)).triangles
    found = corner_carrying(cutout.rest, cutout.triangles, corners_of(cutout), charts, places, faces, inside)
    got = found.of(values.reshape(-1, 2)).reshape(-1, 3, 2)
    for face, over, corners in zip(faces, right[inside], got, strict=True):
        assert corners == pytest.approx(places[face] + 10.0 * over)
    assert right[inside].tolist() == [False, True]
