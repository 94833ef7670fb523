# SPDX-License-Identifier: GPL-3.0-or-later
"""The module's numbers against dense algebra and closed forms."""

import native_reference as reference
import numpy as np
import pytest

import planar_native

HANDLES = np.array([0, 8, 49])
BARYCENTRIC = (np.array([3, 40, 70]), np.array([[0.2, 0.3, 0.5], [1 / 3, 1 / 3, 1 / 3], [0.0, 0.25, 0.75]]))
VELOCITIES = np.array([[0.3, -0.1], [0.0, 0.4], [-0.2, 0.2]])


@pytest.mark.parametrize("handles", [HANDLES, BARYCENTRIC], ids=["vertices", "barycentric"])
@pytest.mark.parametrize("painted", [False, True], ids=["uniform", "painted"])
@pytest.mark.parametrize("dirichlet", [False, True], ids=["(7)", "(8)"])
@pytest.mark.parametrize(("pin_weight", "hard"), [(1.0, False), (250.0, False), (1.0, True)])
def test_killing_field_solves_7_and_8(handles, painted, dirichlet, pin_weight, hard):
    vertices, triangles = reference.bar()
    stiffness = np.linspace(0.1, 5, len(triangles)) if painted else None
    options = {"pin_weight": pin_weight, "hard": hard, "dirichlet": dirichlet, "stiffness": stiffness}
    field = planar_native.killing_field(vertices, triangles, handles, VELOCITIES, **options)
    expected = reference.killing_field(
        vertices, triangles, reference.picked(handles, triangles, len(vertices)), VELOCITIES, **options
    )
    # The condition number of (7) is about 1e5 here: two exact methods differ by 1e-11 or so.
    np.testing.assert_allclose(field, expected, rtol=0, atol=1e-9)


def test_killing_field_of_one_handle_translates():
    vertices, triangles = reference.bar()
    field = planar_native.killing_field(vertices, triangles, [5], [[0.25, -1.5]])
    np.testing.assert_allclose(field, np.tile([0.25, -1.5], (len(vertices), 1)), rtol=0, atol=1e-12)


def test_no_handle_no_motion():
    vertices, triangles = reference.bar()
    field = planar_native.killing_field(vertices, triangles, np.zeros(0, int), np.zeros((0, 2)))
    np.testing.assert_array_equal(field, np.zeros_like(vertices))


def test_spirals_follow_14_to_16():
    vertices, triangles = reference.bar()
    velocities = np.random.default_rng(3).normal(0, 0.2, vertices.shape)
    velocities[:10] = [0.5, 0.25]  # edges of equal velocities: z = 0
    moved = planar_native.advance_along_spirals(vertices, triangles, velocities)
    expected = reference.advance_along_spirals(vertices, triangles, velocities)
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-12)


def test_distortion_is_that_of_the_singular_values():
    vertices, triangles = reference.bar()
    posed = vertices @ [[1.2, 0.3], [-0.4, 0.9]] + np.random.default_rng(5).normal(0, 0.02, vertices.shape)
    result = planar_native.distortion(vertices, posed, triangles)
    area, angle, weights = reference.distortion(vertices, posed, triangles)
    np.testing.assert_allclose(result.triangle_area, area, rtol=1e-11)
    np.testing.assert_allclose(result.triangle_angle, angle, rtol=1e-11)
    assert result.area == pytest.approx(np.average(area, weights=weights), rel=1e-12)
    assert result.angle == pytest.approx(np.average(angle, weights=weights), rel=1e-12)
    assert result.flipped == 0


def test_mirror_flips_every_triangle():
    vertices, triangles = reference.bar()
    result = planar_native.distortion(vertices, vertices * [-1, 1], triangles)
    assert result.flipped == len(triangles)
    assert result.triangle_flipped.all()


def test_flipped_triangles_are_told_one_by_one():
    vertices, triangles = reference.bar()
    folded = vertices.copy()
    corner = triangles[7, 0]
    folded[corner] = 2.0 * folded[triangles[7, 1:]].mean(axis=0) - folded[corner]  # over the opposite edge
    a, b, c = (folded[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    expected = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0] < 0.0
    result = planar_native.distortion(vertices, folded, triangles)
    assert expected[7]
    np.testing.assert_array_equal(result.triangle_flipped, expected)
    assert result.flipped == expected.sum() < len(triangles)


def test_akvf_brings_handles_to_their_targets():
    vertices, triangles = reference.bar()
    poser = planar_native.Poser(vertices, triangles, method="akvf", pin_weight=1e4)
    poser.set_handles(HANDLES)
    targets = vertices[HANDLES] + [[0, 0], [0.8, 1.2], [0, 0]]
    posed = poser.move(targets)
    for _ in range(20):
        posed = poser.settle()
    np.testing.assert_array_equal(posed, poser.positions)
    error = np.linalg.norm(posed[HANDLES] - targets, axis=1).max()
    assert error < 1e-3 * np.linalg.norm(np.ptp(vertices, axis=0))
    assert poser.report.furthest_handle == pytest.approx(error, rel=1e-9)
    assert poser.report.flipped == 0


def test_akvf_turns_rigid_motion_into_rigid_motion():
    vertices, triangles = reference.bar()
    poser = planar_native.Poser(vertices, triangles, method="akvf")
    poser.set_handles(BARYCENTRIC)
    turn = np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
    moved = vertices @ turn + [3.0, -1.0]
    start = reference.picked(BARYCENTRIC, triangles, len(vertices)) @ moved
    posed = poser.move(start)
    for _ in range(20):
        posed = poser.settle()
    # AKVF forgets the rest shape: what is left is what soft handles lose along the way, not solver error.
    assert planar_native.distortion(vertices, posed, triangles).area == pytest.approx(2, abs=1e-2)
    assert poser.report.furthest_handle < 0.05


@pytest.mark.parametrize("weights", ["cotangent", "uniform"])
@pytest.mark.parametrize("handles", [HANDLES, ([0, 30], [[0.2, 0.3, 0.5], [0.6, 0.4, 0.0]])])
def test_arap_two_step_is_exact_on_similarities_and_rigid_motions(handles, weights):
    vertices, triangles = reference.bar()
    turn = np.array([[np.cos(2.0), np.sin(2.0)], [-np.sin(2.0), np.cos(2.0)]])
    if isinstance(handles, tuple):
        rest = np.einsum("kc,kcd->kd", handles[1], vertices[triangles[handles[0]]])
    else:
        rest = vertices[handles]
    for scale in (1.0, 1.5):
        similar, final = planar_native.arap_two_step(
            vertices, triangles, handles, scale * rest @ turn + 3.0, weights=weights
        )
        np.testing.assert_allclose(similar, scale * vertices @ turn + 3.0, rtol=0, atol=1e-10)
        if scale == 1.0:
            np.testing.assert_allclose(final, similar, rtol=0, atol=1e-10)


def test_arap_refuses_other_weights():
    vertices, triangles = reference.bar()
    with pytest.raises(ValueError, match="weights.*'cotangent'.*'uniform'"):
        planar_native.arap_two_step(vertices, triangles, [0], vertices[:1], weights="area")
    with pytest.raises(ValueError, match="handle_weight"):
        planar_native.arap_two_step(vertices, triangles, [0], vertices[:1], handle_weight=0.0)


def test_arap_moves_are_the_two_steps_and_settle_goes_on():
    vertices, triangles = reference.bar()
    poser = planar_native.Poser(vertices, triangles, method="arap")
    poser.set_handles(HANDLES)
    targets = vertices[HANDLES] + np.linspace(0, 1.5, 2 * len(HANDLES)).reshape(-1, 2)
    final = planar_native.arap_two_step(vertices, triangles, HANDLES, targets)[1]
    np.testing.assert_allclose(poser.move(targets), final, rtol=0, atol=1e-12)
    assert poser.report.converged
    assert poser.report.iterations == 1
    settled = poser.settle()
    assert poser.report.converged
    assert poser.report.iterations > 1
    assert np.abs(settled - final).max() > 1e-4
    np.testing.assert_allclose(poser.move(targets), final, rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ["hold", "akvf", "arap"])
def test_reset_takes_the_rest_shape_or_the_one_given(method):
    vertices, triangles = reference.bar()
    poser = planar_native.Poser(vertices, triangles, method=method)
    poser.set_handles(HANDLES)
    poser.move(vertices[HANDLES] + 0.5)
    shape = vertices * [1.1, 0.9]
    poser.reset(shape)
    np.testing.assert_array_equal(poser.positions, shape)
    poser.reset()
    np.testing.assert_array_equal(poser.positions, vertices)
    poser.move(vertices[HANDLES] + 0.25)
    poser.reset(None)
    np.testing.assert_array_equal(poser.positions, vertices)


@pytest.mark.parametrize("method", ["hold", "akvf", "arap"])
def test_what_is_returned_is_a_copy(method):
    vertices, triangles = reference.bar()
    poser = planar_native.Poser(vertices, triangles, method=method)
    poser.set_handles(HANDLES)
    posed = poser.move(vertices[HANDLES])
    posed[:] = 0
    poser.positions[:] = 0
    np.testing.assert_allclose(poser.positions, vertices, rtol=0, atol=1e-9)


def test_build_info_names_the_backend():
    info = planar_native.build_info()
    assert {"version", "backend", "eigen", "suitesparse", "threads"} <= info.keys()
    assert "CHOLMOD" in info["backend"] if info["suitesparse"] else "Eigen" in info["backend"]
    assert info["threads"] >= 1
