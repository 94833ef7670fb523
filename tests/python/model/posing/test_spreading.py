# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins led away from their centre, and towards it."""

from functools import partial

import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.posing import solver_cache
from planar_deform.model.posing.pins import LEAST_SCALE
from planar_deform.model.posing.spreading import ScalingSpread, Spreading, carried_growth, growth


def spreading(pins, moving, pivot=None, model=Spreading):
    cutout = grid_cutout(8, 4)
    make_poser = partial(solver_cache.poser_for, 1, cutout, "hold", cutout.rest)
    return model(cutout, cutout.rest, pins, moving, make_poser, pivot)


def targets(posing):
    return {result.key: result.target.tolist() for result in posing.results()}


def test_distances_from_the_centre_grow_by_the_share():
    pins = [pin([18], key=0), pin([26], key=1), pin([40], key=2)]  # at (0, 2), (8, 2) and (4, 4)
    posing = spreading(pins, {0, 1})
    posing.move(0.25, 0.25, 0.0)
    assert targets(posing) == {0: [-1.0, 2.0], 1: [9.0, 2.0], 2: [4.0, 4.0]}
    posing.move(-0.5, -0.5, 0.0)
    assert targets(posing) == {0: [2.0, 2.0], 1: [6.0, 2.0], 2: [4.0, 4.0]}
    posing.move(-1.0, -1.0, 0.0)
    assert targets(posing)[0] == targets(posing)[1] == [4.0, 2.0]


def test_a_pivot_stays_and_patches_are_not_turned():
    patch = pin([18, 19, 27, 28], key=0, kind="PATCH", angle=0.3)
    posing = spreading([patch, pin([26], key=1)], {0, 1}, pivot=[8.0, 2.0])
    before = {result.key: result.angle for result in posing.results()}
    posing.move(0.5, 0.5, 0.0)
    assert targets(posing)[1] == [8.0, 2.0]
    assert targets(posing)[0] == pytest.approx([8.0 - 1.5 * 7.5, 2.0 + 1.5 * 0.5])
    assert {result.key: result.angle for result in posing.results()} == before


def test_along_an_axis_only_the_way_along_it_grows():
    pins = [pin([18], key=0), pin([26], key=1), pin([40], key=2)]  # at (0, 2), (8, 2) and (4, 4)
    posing = spreading(pins, {0, 1, 2}, pivot=[4.0, 2.0])
    posing.move(*growth(0.5, (1.0, 0.0)))
    assert targets(posing) == {0: [-2.0, 2.0], 1: [10.0, 2.0], 2: [4.0, 4.0]}
    posing.move(*growth(-1.0, (0.0, 1.0)))
    assert targets(posing) == {0: [0.0, 2.0], 1: [8.0, 2.0], 2: [4.0, 2.0]}
    posing.move(*growth(1.0, (0.6, 0.8)))
    assert targets(posing)[1] == pytest.approx([8.0 + 4 * 0.36, 2.0 + 4 * 0.48])


def test_an_edited_path_goes_the_same_shares_of_the_way():
    path = [growth(0.25), growth(0.1), growth(0.5)]
    assert carried_growth(path, 0.5) == path
    assert carried_growth(path, 1.0) == [growth(0.5), growth(0.2), growth(1.0)]
    assert carried_growth(path, 1.0, (1.0, 0.0))[-1] == (1.0, 0.0, 0.0)
    along = [growth(0.2, (0.6, 0.8)), growth(0.4, (0.6, 0.8))]
    assert carried_growth(along, 0.4, (0.6, 0.8)) == along
    assert carried_growth([], -1.0)[-1] == (-1.0, -1.0, 0.0)
    assert carried_growth([growth(0.0)], 0.5)[-1] == growth(0.5)


def scales(posing):
    return {result.key: result.scale for result in posing.results()}


def test_a_patch_alone_is_scaled_but_not_along_an_axis_nor_to_nothing():
    patch = pin([18, 19, 27, 28], key=0, kind="PATCH", angle=0.3)
    posing = spreading([patch, pin([26], key=1)], {0})
    start = posing.results()[0]
    posing.move(*growth(0.5))
    assert scales(posing) == {0: 1.5, 1: 1.0}
    assert posing.results()[0].target.tolist() == start.target.tolist()
    assert posing.results()[0].reached_scale == pytest.approx(1.5, rel=0.03)
    posing.move(*growth(0.5, (1.0, 0.0)))
    assert scales(posing) == {0: 1.0, 1: 1.0}
    posing.move(*growth(-3.0))
    assert scales(posing)[0] == LEAST_SCALE


def test_several_patches_are_scaled_where_that_is_asked_for():
    patches = [pin([18, 19, 27, 28], key=0, kind="PATCH"), pin([24, 25, 33, 34], key=1, kind="PATCH")]
    posing = spreading(patches, {0, 1})
    posing.move(*growth(0.2))
    assert scales(posing) == {0: 1.0, 1: 1.0}
    scaling = spreading(patches, {0, 1}, model=ScalingSpread)
    scaling.move(*growth(0.2))
    assert scales(scaling) == pytest.approx({0: 1.2, 1: 1.2})
    assert targets(scaling) == targets(posing)


def test_what_is_mirrored_goes_and_grows_as_its_partner():
    patches = [pin([18, 19, 27, 28], key=0, kind="PATCH"), pin([24, 25, 33, 34], key=1, kind="PATCH")]
    posing = spreading(patches, {1}, pivot=[4.0, 0.0])
    posing.mirrored = {0: 1}
    start = targets(posing)
    posing.move(*growth(0.5))
    assert scales(posing) == pytest.approx({0: 1.5, 1: 1.5})
    ways = {key: [a - b for a, b in zip(targets(posing)[key], start[key], strict=True)] for key in start}
    assert ways[0] == pytest.approx([-ways[1][0], ways[1][1]])
