# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins pose a lattice as they pose a drawing: on its meshes, on its points, in its plane and in space."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.lattice.lattice_poser import LatticePoser, LatticeShape, posed_cutout
from planar_deform.model.posing.pin_reset import PinReset
from planar_deform.model.posing.posing import Posing

GRID = grid_cutout(12, 4)
COUNTS = {2: (9, 6), 3: (6, 5, 4)}
# A plane that is seen askew, with its normal: rows are its u, v and n.
ASKEW = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0].T


def setting(*, flat, bent=0.0, layers=2):
    """Layers of the grid, at depths of their own, in one lattice: the shape, and axes."""
    depths = np.arange(layers) * 0.5
    rest = np.concatenate([np.column_stack([GRID.rest, np.full(len(GRID.rest), d)]) for d in depths])
    rest[:, 2] += bent * np.sin(rest[:, 0])
    triangles = np.concatenate([GRID.triangles + i * len(GRID.rest) for i in range(layers)])
    counts = COUNTS[2 if flat else 3]
    axes = slice(0, len(counts))
    low, high = rest[:, axes].min(axis=0), rest[:, axes].max(axis=0)
    spacing = np.maximum(high - low, 1.0) / (np.array(counts) - 3) * (1 + 1e-9)
    origin = low - spacing
    kinds = ["BSPLINE"] * len(counts)
    weights = native.lattice_weights(rest[:, axes], counts, kinds, origin=origin, spacing=spacing)
    index = np.indices(counts[::-1]).reshape(len(counts), -1)[::-1]
    points = np.zeros((index.shape[1], 3))
    points[:, axes] = origin + spacing * index.T
    return LatticeShape(rest @ ASKEW, triangles, weights, points @ ASKEW)


def begun(shape, *pins, moving, flat, model=Posing, axes=ASKEW):
    rest = np.concatenate([shape.rest, shape.points]) @ axes.T
    parts = np.repeat([0, 1], len(GRID.rest)).astype(np.int32)
    cutout = posed_cutout(rest, shape.triangles, parts, len(shape.points), flat=flat)

    def make_poser(*, progress=None):
        poser = LatticePoser(LatticePoser.solver(shape, axes, flat=flat), shape, axes, flat=flat)
        poser.reset(rest)
        return poser

    return model(cutout, rest, pins, moving, make_poser), rest


def deformed(shape, points, axes=ASKEW):
    """What Blender shows for these points of the lattice."""
    starts, columns, values = shape.weights
    rows = np.repeat(np.arange(len(shape.rest)), np.diff(starts))
    moved = shape.rest.copy()
    np.add.at(moved, rows, values[:, None] * (points @ axes - shape.points)[columns])
    return moved @ axes.T


@pytest.mark.parametrize("flat", [True, False])
def test_a_pin_that_is_dragged_goes_there_and_what_blender_shows_is_what_was_solved(flat):
    shape = setting(flat=flat, bent=0.0 if flat else 0.2)
    ends = [pin([0, 13, 26]), pin([77, 90], key=1)]
    posing, rest = begun(shape, *ends, moving=[1], flat=flat)
    for step in range(1, 5):
        posing.move(0.3 * step, 0.25 * step, 0.0)
    positions = posing.settle()
    count = len(shape.rest)
    np.testing.assert_allclose(deformed(shape, positions[count:]), positions[:count], rtol=0, atol=1e-11)
    held, moved = posing.results()
    assert np.linalg.norm(held.reached - held.target) < 5e-3
    assert np.linalg.norm(moved.reached - moved.target) < 5e-2
    np.testing.assert_allclose(moved.target[:2] - begin_of(rest, 77, 90)[:2], [1.2, 1.0], atol=1e-6)
    if flat:
        np.testing.assert_array_equal(positions[:, 2], rest[:, 2])


def begin_of(rest, *vertices):
    return rest[list(vertices)].mean(axis=0)


@pytest.mark.parametrize("flat", [True, False])
def test_a_point_of_the_lattice_is_dragged_beside_a_pin_of_a_mesh(flat):
    shape = setting(flat=flat)
    count, point = len(shape.rest), len(shape.points) - 1
    posing, rest = begun(shape, pin([0]), pin([count + point], key=1), moving=[1], flat=flat)
    posing.move(0.7, -0.4, 0.0)
    positions = posing.settle()
    np.testing.assert_allclose(positions[count + point], rest[count + point] + [0.7, -0.4, 0.0], atol=2e-2)
    np.testing.assert_allclose(positions[0], rest[0], atol=1e-2)
    _, moved = posing.results()
    np.testing.assert_array_equal(moved.reached, positions[count + point])


def test_a_patch_is_turned_and_its_angle_counts_from_rest():
    shape = setting(flat=True)
    patch = [0, 1, 13, 14]
    posing, rest = begun(shape, pin(patch, kind="PATCH"), pin([60], key=1), moving=[0], flat=True)
    for step in range(1, 9):
        posing.move(0.0, 0.0, 0.1 * step)
    posing.settle()
    turned, _ = posing.results()
    assert turned.angle == pytest.approx(0.8)
    assert np.linalg.norm(turned.reached - rest[patch].mean(axis=0)) < 0.02


def test_in_space_a_patch_that_was_turned_out_of_the_view_is_not_turned_back_when_it_is_dragged():
    shape = setting(flat=False)
    patch = [0, 1, 13, 14]
    posing, rest = begun(shape, pin(patch, kind="PATCH"), moving=[0], flat=False)
    for step in range(1, 9):
        posing.move(0.0, 0.0, 0.1 * step)
    once = posing.settle() @ ASKEW
    # From a side: u, v and n of another view.
    aside = np.roll(ASKEW, 1, axis=0)
    rest = np.concatenate([shape.rest, shape.points]) @ aside.T
    cutout = posed_cutout(rest, shape.triangles, np.zeros(len(shape.rest), np.int32), 120, flat=False)

    def make_poser(*, progress=None):
        poser = LatticePoser(LatticePoser.solver(shape, aside, flat=False), shape, aside, flat=False)
        poser.reset(once @ aside.T)
        return poser

    posing = Posing(cutout, once @ aside.T, [pin(patch, kind="PATCH")], [0], make_poser)
    posing.move(0.5, 0.2, 0.0)
    np.testing.assert_allclose(posing.settle(), once @ aside.T + [0.5, 0.2, 0.0], atol=2e-2)


def test_in_space_a_patch_goes_back_to_rest_whatever_way_it_was_turned():
    shape = setting(flat=False)
    patch = pin([0, 1, 2, 13, 14, 15], kind="PATCH")
    posing, rest = begun(shape, patch, moving=[0], flat=False)
    for step in range(1, 9):
        posing.move(0.05 * step, 0.0, 0.1 * step)
    aside = np.roll(ASKEW, 1, axis=0)
    turned = posing.settle() @ ASKEW @ aside.T
    rest = rest @ ASKEW @ aside.T
    cutout = posed_cutout(rest, shape.triangles, np.zeros(len(shape.rest), np.int32), 120, flat=False)

    def make_poser(*, progress=None):
        poser = LatticePoser(LatticePoser.solver(shape, aside, flat=False), shape, aside, flat=False)
        poser.reset(turned)
        return poser

    reset = PinReset(cutout, turned, [patch], [0], make_poser)
    reset.run()
    np.testing.assert_allclose(reset.positions, rest, atol=2e-2)


def test_the_first_of_two_pins_on_one_point_of_the_lattice_holds_it():
    shape = setting(flat=True)
    point = len(shape.rest) + 7
    pins = [pin([0]), pin([point], key=1), pin([point], key=2)]
    posing, rest = begun(shape, *pins, moving=[2], flat=True)
    posing.move(0.5, 0.0, 0.0)
    np.testing.assert_allclose(posing.settle()[point], rest[point], atol=1e-2)


@pytest.mark.parametrize("flat", [True, False])
def test_equal_paths_give_equal_bits(flat):
    shape = setting(flat=flat)

    def posed():
        posing, _ = begun(shape, pin([0]), pin([64], key=1), moving=[1], flat=flat)
        for step in range(1, 6):
            posing.move(0.2 * step, 0.1 * step, 0.0)
        return posing.settle()

    np.testing.assert_array_equal(posed(), posed())
