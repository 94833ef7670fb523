# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins led away from their centre, and towards it."""

from functools import partial

import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.posing import solver_cache
from planar_deform.model.posing.spreading import Spreading


def spreading(pins, moving, pivot=None):
    cutout = grid_cutout(8, 4)
    make_poser = partial(solver_cache.poser_for, 1, cutout, "hold", cutout.rest)
    return Spreading(cutout, cutout.rest, pins, moving, make_poser, pivot)


def targets(posing):
    return {result.key: result.target.tolist() for result in posing.results()}


def test_distances_from_the_centre_grow_by_the_share():
    pins = [pin([18], key=0), pin([26], key=1), pin([40], key=2)]  # at (0, 2), (8, 2) and (4, 4)
    posing = spreading(pins, {0, 1})
    posing.move(0.25, 0.0, 0.0)
    assert targets(posing) == {0: [-1.0, 2.0], 1: [9.0, 2.0], 2: [4.0, 4.0]}
    posing.move(-0.5, 0.0, 0.0)
    assert targets(posing) == {0: [2.0, 2.0], 1: [6.0, 2.0], 2: [4.0, 4.0]}
    posing.move(-1.0, 0.0, 0.0)
    assert targets(posing)[0] == targets(posing)[1] == [4.0, 2.0]


def test_a_pivot_stays_and_patches_are_not_turned():
    patch = pin([18, 19, 27, 28], key=0, kind="PATCH", angle=0.3)
    posing = spreading([patch, pin([26], key=1)], {0, 1}, pivot=[8.0, 2.0])
    before = {result.key: result.angle for result in posing.results()}
    posing.move(0.5, 0.0, 0.0)
    assert targets(posing)[1] == [8.0, 2.0]
    assert targets(posing)[0] == pytest.approx([8.0 - 1.5 * 7.5, 2.0 + 1.5 * 0.5])
    assert {result.key: result.angle for result in posing.results()} == before
