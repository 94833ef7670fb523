# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces laid flat, from Python."""

import numpy as np
import pytest

import planar_native


def sheet(columns, rows, embed):
    u, v = np.meshgrid(np.linspace(0, 2, columns), np.linspace(0, 1, rows))
    corner = (np.arange(columns - 1) + columns * np.arange(rows - 1)[:, None]).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + columns]),
            np.column_stack([corner + 1, corner + columns + 1, corner + columns]),
        ]
    )
    return np.column_stack(embed(u.ravel(), v.ravel())), triangles


def rolled():
    return sheet(13, 7, lambda u, v: (np.cos(u), np.sin(u), v))


def saddle():
    return sheet(13, 7, lambda u, v: (u, v, 0.8 * (u - 1) * (v - 0.5)))


def lengths(points, triangles):
    return np.linalg.norm(points[triangles] - points[np.roll(triangles, 1, axis=1)], axis=2)


@pytest.mark.parametrize("method", ["hold", "two_step"])
@pytest.mark.parametrize("weights", ["cotangent", "uniform"])
def test_a_cylinder_unrolls(method, weights):
    vertices, triangles = rolled()
    flat = planar_native.flatten(vertices, triangles, method=method, weights=weights, fixed=[0, 1])
    np.testing.assert_allclose(lengths(flat, triangles), lengths(vertices, triangles), rtol=0, atol=1e-9)
    np.testing.assert_allclose(flat[13:26, 1] - flat[:13, 1], 1 / 6, rtol=0, atol=1e-9)
    assert flat[1, 0] > flat[0, 0]


def test_pins_and_lines_live():
    vertices, triangles = saddle()
    flattener = planar_native.Flattener(vertices, triangles)
    free = flattener.positions
    edge = np.arange(13)
    line = flattener.fitted_line(edge)
    flattener.set_pins([84], weights=[2.0], lines=[line])
    target = free[84] + [0.1, 0.2]
    flattener.move([target])
    flat = flattener.settle()
    assert flattener.report.converged
    assert flattener.report.flipped == 0
    assert flattener.report.furthest_handle < 1e-2
    _, point, direction = line
    off = (flat[edge] - point) @ np.array([-direction[1], direction[0]])
    np.testing.assert_allclose(off, 0, atol=1e-3)
    flattener.reset()
    np.testing.assert_array_equal(flattener.positions, free)


def test_progress_stops():
    vertices, triangles = saddle()
    told = []
    planar_native.flatten(vertices, triangles, progress=told.append)
    assert told[0] == 0
    assert told[-1] == 1
    with pytest.raises(planar_native.Cancelled):
        planar_native.flatten(vertices, triangles, progress=lambda share: share < 0.1)
    with pytest.raises(ValueError, match="progress: returned 3"):
        planar_native.Flattener(vertices, triangles, progress=lambda share: 3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": np.zeros((4, 2))}, "vertices: shape"),
        ({"vertices": np.full((91, 3), np.nan)}, "vertices, row 0: not a finite number"),
        ({"triangles": [[0, 1, 91]]}, "triangles, row 0: vertex 91 is out of range"),
        ({"triangles": [[0, 1, 13], [40, 41, 54]]}, "2 parts .*: flatten them one by one"),
        ({"triangles": [[0, 1, 13], [0, 13, 14], [0, 14, 1], [1, 14, 13]]}, "closed: cut it open"),
        ({"method": "slim"}, "method: 'slim' is not available"),
        ({"weights": "mean"}, "weights: 'mean' is not available"),
        ({"fixed": [0, 1, 2]}, "fixed: shape"),
        ({"fixed": [0, 50]}, "fixed: its vertices share no edge"),
        ({"iterations": -1}, "iterations"),
    ],
)
def test_what_cannot_be_laid_flat_is_refused(change, message):
    vertices, triangles = saddle()
    arguments = {"vertices": vertices, "triangles": triangles} | change
    with pytest.raises(ValueError, match=message):
        planar_native.flatten(**arguments)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (3, "lines: expected a list"),
        ([3], r"lines\[0\]: expected \(vertices, point, direction\)"),
        ([([0, 1], [0, 0, 0], [1, 0])], r"lines\[0\] point: shape"),
        ([([0, 91], [0, 0], [1, 0])], "vertex 91 is out of range"),
        ([([0, 1], [0, 0], [0, 0])], "no direction"),
    ],
)
def test_lines_are_checked(lines, message):
    flattener = planar_native.Flattener(*saddle())
    with pytest.raises(ValueError, match=message):
        flattener.set_pins([0], lines=lines)


def test_an_object_of_new_alone_is_refused():
    with pytest.raises((TypeError, RuntimeError)):
        planar_native.Flattener.__new__(planar_native.Flattener).settle()
