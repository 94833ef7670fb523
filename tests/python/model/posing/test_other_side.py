# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses mirrored from one drawing to the one opposite."""

from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform import native
from planar_deform.model.plane.connectivity import unique_edges
from planar_deform.model.plane.cutout import make_cutout
from planar_deform.model.plane.frame import frame_across
from planar_deform.model.posing.other_side import OtherSide, Reflection, Side, mirrored, opposites
from planar_deform.model.posing.pins import Holder
from planar_deform.model.posing.symmetry import NotSymmetricError

UP = np.array([0.0, 0.0, 1.0])
FRAME = frame_across(UP, np.eye(3))
ACROSS_X = Reflection.of(FRAME, FRAME, FRAME.u)


def test_names_of_drawings_tell_first_then_names_of_pins():
    assert opposites({"Arm.L": ["Hand"], "Body": ["Chest"], "Arm.R": ["Hand"]}) == {
        "Arm.L": "Arm.R",
        "Arm.R": "Arm.L",
    }
    assert opposites({"A": ["Hand.L", "Elbow.L"], "B": ["Hand.R"], "C": ["Head"]}) == {"A": "B", "B": "A"}
    assert opposites({"Body": ["Hand.L", "Hand.R"], "Other": ["Hand.L"]}) == {}, "it has both itself"
    assert opposites({"A": ["Foot.L"], "B": ["Foot.R"], "C": ["Foot.R"]}) == {}, "which of the two?"
    assert opposites({}) == {}


def slanted(seed=3):
    """A bar without any symmetry."""
    grid = grid_cutout(10, 3)
    rest = grid.rest + np.random.default_rng(seed).uniform(-0.2, 0.2, grid.rest.shape)
    return make_cutout(rest, grid.triangles, grid.parts)


def other(cutout):
    """Its mirror image, elsewhere, with its vertices in another order."""
    order = np.random.default_rng(5).permutation(len(cutout.rest))
    rest = (cutout.rest * [-1.0, 1.0] + [20.0, 3.0])[order]
    place = np.argsort(order).astype(np.int32)
    return make_cutout(rest, place[cutout.triangles], cutout.parts[order]), order


def side(cutout, pins, positions=None, depths=None):
    edges = unique_edges(np.concatenate([cutout.triangles[:, [i, (i + 1) % 3]] for i in range(3)]))
    holders = [(name, Holder(one, cutout)) for name, one in pins.items()]
    depths = np.zeros(len(cutout.rest)) if depths is None else depths
    return Side(cutout, cutout.rest if positions is None else positions, depths, edges, holders)


def test_mirror_images_are_mirrored_vertex_by_vertex_whatever_their_order_and_place():
    left = slanted()
    right, order = other(left)
    pose = left.rest + np.stack([0.1 * left.rest[:, 1], 0.05 * left.rest[:, 0] ** 2], axis=1)
    depths = np.arange(len(pose), dtype=float)
    held = {"Hand.L": pin([4], key=0, target=pose[4] + [0.5, 0.25], angle=0.0)}
    row = int(np.flatnonzero(order == 4)[0])
    found = mirrored(
        side(right, {"Hand.R": pin([row], key=7)}), side(left, held, pose, depths), ACROSS_X, tolerance=1e-6
    )
    expected = (pose * [-1.0, 1.0] + [20.0, 3.0])[order]
    assert found.positions == pytest.approx(expected, abs=1e-9)
    assert np.array_equal(found.depths, depths[order])
    (result,) = found.results
    assert result.key == 7
    assert result.target == pytest.approx(expected[row] + [-0.5, 0.25], abs=1e-9)


def test_others_are_told_apart():
    left = slanted()
    with pytest.raises(NotSymmetricError, match="have no partner"):
        mirrored(side(slanted(4), {}), side(left, {}), ACROSS_X, tolerance=1e-3)
    with pytest.raises(NotSymmetricError, match="vertices on one side"):
        mirrored(side(grid_cutout(4, 4), {}), side(left, {}), ACROSS_X, tolerance=1e-3)


def test_a_drawing_mirrored_by_its_scale_turns_the_other_way():
    behind = frame_across(UP, np.diag([-1.0, 1.0, 1.0]))
    seen = Reflection.of(behind, FRAME, FRAME.u)
    assert seen.ways == pytest.approx(np.eye(2)), "its own axes are mirrored already"
    assert (ACROSS_X.side, seen.side) == (-1.0, 1.0)
    assert ACROSS_X.ways == pytest.approx(np.diag([-1.0, 1.0]))


def test_unlike_drawings_are_led_by_their_pins():
    left, right = slanted(), grid_cutout(14, 4)
    pins = {"Root.L": pin([0], key=0), "Hand.L": pin([10], key=1)}
    pose = left.rest.copy()
    pose[10] += [0.5, 1.5]
    source = side(left, pins, pose, np.full(len(pose), 2.0))
    target = side(right, {"Hand.R": pin([14], key=3), "Root.R": pin([0], key=5), "Loose": pin([30], key=6)})

    def solver(positions, *, progress=None):
        poser = native.Poser(right.rest, right.triangles, method="hold")
        poser.reset(positions)
        return poser

    posing = OtherSide(target, source, ACROSS_X, solver)
    posing.run()
    assert posing.pairs == 2
    results = {result.key: result for result in posing.results()}
    assert results[3].target == pytest.approx(right.rest[14] + [-0.5, 1.5])
    assert results[5].target == pytest.approx(right.rest[0])
    assert results[3].reached == pytest.approx(results[3].target, abs=0.02)
    assert results[6].target == pytest.approx(results[6].reached), "it holds what there is"
    assert posing.asked_depths() == {3: 2.0, 5: 2.0}


def test_without_partners_nothing_is_led():
    left = slanted()
    with pytest.raises(ValueError, match="none is enabled"):
        OtherSide(side(left, {"A": pin([0], key=0)}), side(left, {"B": pin([0], key=0)}), ACROSS_X, partial)
