# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices from Python: Blender's weights in plain NumPy, positions that follow from the points, choices of
the method, and the errors that name what is wrong."""

import itertools
import threading

import native_reference as reference
import numpy as np
import pytest

import planar_native

REST, TRIANGLES = reference.bar(columns=12, rows=8)
N = len(REST)
KINDS = ["BERNSTEIN", "LINEAR", "CARDINAL", "CATMULL_ROM", "BSPLINE"]
PINS = np.array([0, 12, 60, N - 1])


def fitted(points, counts):
    """Origin and spacing of a grid with one free cell on each side."""
    spacing = np.ptp(points, axis=0) / (np.array(counts) - 3) * (1 + 1e-9)
    return points.min(axis=0) - spacing, spacing


def grid(counts, origin, spacing):
    index = np.indices(counts[::-1]).reshape(len(counts), -1)[::-1]
    return origin + spacing * index.T


def in_lattice(rest=REST, counts=(7, 6), kind="BSPLINE"):
    origin, spacing = fitted(rest, counts)
    weights = planar_native.lattice_weights(
        rest, counts, [kind] * len(counts), origin=origin, spacing=spacing
    )
    return weights, grid(counts, origin, spacing)


def dense(weights, columns):
    starts, indices, values = weights
    result = np.zeros((len(starts) - 1, columns))
    for row, (start, end) in enumerate(itertools.pairwise(starts)):
        result[row, indices[start:end]] = values[start:end]
    return result


WEIGHTS, POINTS = in_lattice()
W = dense(WEIGHTS, len(POINTS))


def solver(**options):
    return planar_native.LatticeSolver(REST, TRIANGLES, WEIGHTS, POINTS, **options)


def axis_weights(kind, count, s):
    """Of one axis at a place in steps: Blender's, between four points that are clamped to those there are."""
    if kind == "BERNSTEIN":
        t = np.clip(s / (count - 1), 0, 1)
        choose = [1.0]
        for k in range(1, count):
            choose.append(choose[-1] * (count - k) / k)
        k = np.arange(count)
        return np.array(choose) * t**k * (1 - t) ** (count - 1 - k)
    k = int(np.floor(s))
    t = s - k
    c = {"CARDINAL": 0.71, "CATMULL_ROM": 0.5}.get(kind)
    if kind == "LINEAR":
        shares = [0, 1 - t, t, 0]
    elif kind == "BSPLINE":
        shares = [
            -(t**3) / 6 + t**2 / 2 - t / 2 + 1 / 6,
            t**3 / 2 - t**2 + 2 / 3,
            -(t**3) / 2 + t**2 / 2 + t / 2 + 1 / 6,
            t**3 / 6,
        ]
    else:
        shares = [
            -c * t**3 + 2 * c * t**2 - c * t,
            (2 - c) * t**3 + (c - 3) * t**2 + 1,
            (c - 2) * t**3 + (3 - 2 * c) * t**2 + c * t,
            c * t**3 - c * t**2,
        ]
    result = np.zeros(count)
    for i, share in enumerate(shares):
        result[np.clip(k - 1 + i, 0, count - 1)] += share
    return result


@pytest.mark.parametrize("kind", KINDS)
def test_weights_are_those_of_blender(kind):
    counts, kinds = (5, 4, 3), (kind, "BSPLINE", "LINEAR")
    origin, spacing = np.array([-0.9, -0.5, -0.3]), np.array([0.4, 0.3, 0.35])
    places = np.random.default_rng(1).uniform(-2, 2, (100, 3))
    weights = planar_native.lattice_weights(places, counts, kinds, origin=origin, spacing=spacing)
    expected = [
        np.einsum("w,v,u->wvu", *(axis_weights(kinds[a], counts[a], s[a]) for a in (2, 1, 0))).ravel()
        for s in (places - origin) / spacing
    ]
    np.testing.assert_allclose(dense(weights, 60), expected, rtol=0, atol=1e-14)


def test_positions_follow_from_the_points():
    lattice = solver()
    lattice.set_handles(PINS, [3], weights=[1, 2, 1, 1], locked=[0])
    points = lattice.solve(REST[PINS] * 1.1, POINTS[[3]] - 0.2)
    np.testing.assert_array_equal(points, lattice.points)
    for call in (lattice.refine, lattice.settle):
        points = call()
        np.testing.assert_allclose(lattice.positions, REST + W @ (points - POINTS), rtol=0, atol=1e-12)
        np.testing.assert_array_equal(points[0], POINTS[0])
    report = lattice.report
    off = np.linalg.norm(lattice.positions[PINS] - REST[PINS] * 1.1, axis=1)
    np.testing.assert_allclose(report.handle_distance, off, rtol=0, atol=1e-12)
    assert report.flipped == planar_native.distortion(REST, lattice.positions, TRIANGLES).flipped == 0
    assert report.unreached == list(np.flatnonzero(off > 1e-3 * np.linalg.norm(np.ptp(REST, axis=0))))
    assert report.converged
    assert "converged=True" in repr(report)


@pytest.mark.parametrize("options", [{}, {"method": "paper"}])
def test_a_turn_of_the_pins_is_a_turn_of_all(options):
    lattice = solver(**options)
    lattice.set_handles(PINS)
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    lattice.solve(REST[PINS] @ turn)
    lattice.settle()
    np.testing.assert_allclose(lattice.positions, REST @ turn, rtol=0, atol=1e-8)


def test_what_only_the_paper_knows_asks_for_it():
    def settled(**options):
        lattice = solver(**options)
        lattice.set_handles(PINS)
        lattice.solve(REST[PINS] + [[0, 0], [0.5, 0.5], [0, 0], [1.0, -0.5]])
        lattice.settle()
        return lattice.positions

    np.testing.assert_array_equal(settled(), settled(method="hold"))
    for options in ({"rigid_following": False}, {"edge_weights": "uniform"}):
        np.testing.assert_array_equal(settled(**options), settled(method="paper", **options))
    assert np.abs(settled() - settled(method="paper")).max() > 1e-4


def test_edges_and_space():
    edges = np.column_stack([np.arange(N - 1), np.arange(1, N)])
    flat = planar_native.LatticeSolver(REST, edges, WEIGHTS, POINTS)
    flat.set_handles([0, N - 1])
    flat.solve(REST[[0, N - 1]] + 1.0)
    flat.settle()
    np.testing.assert_allclose(flat.positions, REST + 1.0, rtol=0, atol=1e-8)

    space = np.column_stack([REST, np.sin(REST[:, 0])])
    weights, points = in_lattice(space, (6, 6, 5))
    lattice = planar_native.LatticeSolver(space, TRIANGLES, weights, points)
    lattice.set_handles([0, 12, N - 1])
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    assert lattice.solve((space @ turn)[[0, 12, N - 1]]).shape == (180, 3)
    np.testing.assert_allclose(lattice.positions, space @ turn, rtol=0, atol=1e-8)


def test_reset_and_handles_inside_triangles():
    lattice = solver()
    lattice.set_handles(([0, 50], [[0.2, 0.3, 0.5], [1, 0, 0]]))
    lattice.solve([[0.0, 0.0], [3.0, 3.0]])
    assert np.abs(lattice.points - POINTS).max() > 0.1
    lattice.reset()
    np.testing.assert_array_equal(lattice.positions, REST)
    lattice.reset(POINTS + 1.0)
    np.testing.assert_allclose(lattice.positions, REST + 1.0, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(lattice.settle(), POINTS + 1.0)  # no targets


STARTS, INDICES, VALUES = WEIGHTS


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        ((REST[:, :1], TRIANGLES, WEIGHTS, POINTS), {}, "rest: shape"),
        ((REST, TRIANGLES[:, :1], WEIGHTS, POINTS), {}, "elements: shape"),
        ((REST, TRIANGLES + N, WEIGHTS, POINTS), {}, "triangles, row 0"),
        ((REST, TRIANGLES, WEIGHTS[:2], POINTS), {}, "weights: 2 arrays"),
        ((REST, TRIANGLES, 3.0, POINTS), {}, "weights: expected"),
        ((REST, TRIANGLES, (STARTS[:-1], INDICES, VALUES), POINTS), {}, "weights indptr: shape"),
        ((REST, TRIANGLES, (STARTS + 1, INDICES, VALUES), POINTS), {}, "weights indptr: must lead"),
        ((REST, TRIANGLES, (STARTS[::-1], INDICES, VALUES), POINTS), {}, "weights indptr: must lead"),
        ((REST, TRIANGLES, (STARTS, INDICES + 42, VALUES), POINTS), {}, "weights indices, row"),
        ((REST, TRIANGLES, (STARTS, INDICES - 42, VALUES), POINTS), {}, "weights indices, row 0"),
        ((REST, TRIANGLES, (STARTS, INDICES, VALUES * np.nan), POINTS), {}, "weights values, row 0"),
        ((REST, TRIANGLES, (STARTS, INDICES, VALUES[1:]), POINTS), {}, "weights values: shape"),
        ((REST, TRIANGLES, WEIGHTS, POINTS**2), {}, "lattice_rest, row"),
        ((REST, TRIANGLES, WEIGHTS, POINTS), {"method": "arap"}, "method: 'arap' is not available"),
        ((REST, TRIANGLES, WEIGHTS, POINTS), {"edge_weights": "x"}, "edge_weights: 'x'"),
        ((REST, TRIANGLES[:, :2], WEIGHTS, POINTS), {"method": "hold"}, "method: 'hold' needs triangles"),
        ((REST, TRIANGLES, WEIGHTS, POINTS), {"weight_mesh": -1.0}, "weight_mesh must be"),
    ],
)
def test_errors_name_what_is_wrong(arguments, options, words):
    with pytest.raises(ValueError, match=f"^{words}"):
        planar_native.LatticeSolver(*arguments, **options)


def test_a_call_that_raises_changes_nothing():
    lattice = solver()
    lattice.set_handles(PINS)
    before = lattice.solve(REST[PINS] * 1.1)
    for call in (
        lambda: lattice.solve(REST[PINS][:2]),
        lambda: lattice.solve(REST[PINS] * np.inf),
        lambda: lattice.solve(REST[PINS], POINTS[:1]),
        lambda: lattice.set_handles([N]),
        lambda: lattice.set_handles(PINS, [1, 1]),
        lambda: lattice.set_handles(PINS, weights=[0, 1, 1, 1]),
        lambda: lattice.reset(POINTS[1:]),
        lambda: planar_native.lattice_weights(REST, (65, 2), KINDS[:2], origin=[0, 0], spacing=[1, 1]),
        lambda: planar_native.lattice_weights(
            REST, (5, 2), ["KEY_LINEAR"] * 2, origin=[0, 0], spacing=[1, 1]
        ),
    ):
        with pytest.raises(ValueError, match=r"\w"):
            call()
    with pytest.raises(planar_native.SolveError):
        lattice.solve(REST[PINS] * 1e300)
    np.testing.assert_array_equal(lattice.points, before)


def test_threads_may_share_an_object():
    lattice = solver()
    lattice.set_handles(PINS)

    def drag(seed):
        random = np.random.default_rng(seed)
        for _ in range(20):
            lattice.solve(REST[PINS] + random.normal(size=(4, 2)))
            assert lattice.report.flipped == 0

    threads = [threading.Thread(target=drag, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.isfinite(lattice.positions).all()


def test_made_by_new_alone_it_is_refused():
    empty = planar_native.LatticeSolver.__new__(planar_native.LatticeSolver)
    with pytest.raises(RuntimeError, match="held"):
        empty.settle()
    with pytest.raises(TypeError):
        planar_native.LatticeReport()
