# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses of drawings that are not symmetric, mirrored by their pins."""

from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.plane.cutout import make_cutout
from planar_deform.model.posing.pin_mirror import PinMirror
from planar_deform.model.posing.pins import Holder
from planar_deform.model.posing.posing import Posing


def lopsided(nx=12, ny=4):
    """A bar whose vertices are all a little out of place, and one end of which is longer."""
    grid = grid_cutout(nx, ny)
    noise = np.random.default_rng(2).uniform(-0.15, 0.15, grid.rest.shape)
    rest = grid.rest + noise
    rest[rest[:, 0] > nx - 0.5, 0] += 0.2
    return make_cutout(rest, grid.triangles, grid.parts)


def solver(cutout, positions, *, progress=None):
    poser = native.Poser(cutout.rest, cutout.triangles, method="hold")
    poser.reset(positions)
    return poser


def posed(cutout, pins, moving, offset=(0.0, 0.0), angle=0.0):
    """The positions and the pins, each with what it was asked for."""
    posing = Posing(cutout, cutout.rest, pins, moving, partial(solver, cutout, cutout.rest))
    for step in range(1, 9):
        posing.move(offset[0] * step / 8, offset[1] * step / 8, angle * step / 8)
    posing.settle()
    results = {result.key: result for result in posing.results()}
    return posing.positions, [
        pin(
            p.vertices,
            key=p.key,
            kind=p.kind,
            enabled=p.enabled,
            target=results[p.key].target,
            angle=results[p.key].angle,
        )
        if p.key in results
        else p
        for p in pins
    ]


def mirrored(cutout, positions, pins, names=None, axis=0):
    names = names or [f"Pin.{p.key:03d}" for p in pins]
    holders = [(name, Holder(p, cutout)) for name, p in zip(names, pins, strict=True)]
    mirror = PinMirror(cutout, positions, holders, axis, partial(solver, cutout))
    mirror.run()
    return mirror


def asked(cutout, pins):
    return [np.array(p.target) - Holder(p, cutout).place(cutout.rest) for p in pins]


@pytest.mark.parametrize("names", [None, ["Arm.L", "Middle", "Arm.R"]])
def test_a_pair_changes_sides_and_a_pin_in_the_middle_stays(names):
    cutout = lopsided()
    pins = [pin([26]), pin([32], key=1), pin([38], key=2)]
    positions, pins = posed(cutout, pins, [2], (-1.0, 3.0))
    before = asked(cutout, pins)
    found = mirrored(cutout, positions, pins, names)
    after = {
        result.key: result.target - Holder(pins[result.key], cutout).place(cutout.rest)
        for result in found.results()
    }
    assert after[0] == pytest.approx(before[2] * [-1, 1])
    assert after[2] == pytest.approx(before[0] * [-1, 1])
    assert after[1] == pytest.approx(before[1] * [-1, 1])
    assert all(np.linalg.norm(result.reached - result.target) < 0.02 for result in found.results())
    assert found.pairs == 1
    report = native.distortion(cutout.rest, found.positions, cutout.triangles)
    was = native.distortion(cutout.rest, positions, cutout.triangles)
    assert (report.flipped, report.area) == (0, pytest.approx(was.area, abs=0.02))


def test_twice_is_the_pose_it_was():
    cutout = lopsided()
    pins = [pin([26]), pin([32], key=1), pin([38], key=2)]
    positions, pins = posed(cutout, pins, [2], (-1.0, 3.0))
    once = mirrored(cutout, positions, pins)
    targets = {result.key: result.target for result in once.results()}
    again = [pin(p.vertices, key=p.key, target=targets[p.key]) for p in pins]
    assert mirrored(cutout, once.positions, again).positions == pytest.approx(positions, abs=0.02)


@pytest.mark.parametrize("turn", [0.8, -2.5])
def test_a_patch_turns_the_other_way(turn):
    cutout = lopsided()
    pins = [pin([13, 14, 26, 27], kind="PATCH"), pin([24, 25, 37, 38], key=1, kind="PATCH")]
    positions, pins = posed(cutout, pins, [1], angle=turn)
    found = mirrored(cutout, positions, pins, ["Foot.L", "Foot.R"])
    turns = {result.key: result.angle for result in found.results()}
    assert (turns[0], turns[1]) == (pytest.approx(-turn, abs=1e-6), pytest.approx(0.0, abs=1e-6))


def test_where_a_pin_has_no_partner_the_drawing_does_what_it_did():
    cutout = lopsided()
    pins = [pin([32]), pin([38], key=1)]
    positions, pins = posed(cutout, pins, [1], (-1.0, 3.0))
    found = mirrored(cutout, positions, pins)
    lift = found.positions - cutout.rest
    assert lift[26] == pytest.approx([1.0, 3.0], abs=0.3)
    assert lift[38] == pytest.approx((positions - cutout.rest)[26] * [-1, 1], abs=0.8)
    alone = {result.key: result for result in found.results()}[1]
    assert alone.target == pytest.approx(alone.reached)


def test_a_pin_that_is_off_neither_leads_nor_holds():
    cutout = lopsided()
    pins = [pin([26]), pin([32], key=1), pin([38], key=2), pin([12], key=3, enabled=False)]
    positions, pins = posed(cutout, pins, [2], (-1.0, 3.0))
    found = mirrored(cutout, positions, pins)
    assert sorted(result.key for result in found.results()) == [0, 1, 2]
    with pytest.raises(ValueError, match="none is enabled"):
        mirrored(cutout, positions, [pin([26], enabled=False)])


def test_a_whole_turn_over_is_no_detour():
    cutout = lopsided()
    pins = [pin([26]), pin([38], key=1)]
    middle = cutout.rest.mean(axis=0)
    turned = 2 * middle - cutout.rest
    pins = [pin(p.vertices, key=p.key, target=turned[p.vertices[0]]) for p in pins]
    found = mirrored(cutout, turned, pins)
    report = native.distortion(cutout.rest, found.positions, cutout.triangles)
    assert (report.flipped, report.area) == (0, pytest.approx(2.0, abs=0.01))
