# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses whose triangles are set right, and what pins hold on another mesh."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.plane.carrying import carrying
from planar_deform.model.posing.carried_pins import group_carried, nearest_binding, patch_carried
from planar_deform.model.posing.pins import Holder
from planar_deform.model.posing.upright import set_right, turned_over


def test_an_upright_pose_stays_to_the_bit():
    cutout = grid_cutout(5, 5)
    bent = cutout.rest @ np.array([[0.3, 0.9], [-0.9, 0.3]])
    assert set_right(cutout.rest, cutout.triangles, bent) is bent


@pytest.mark.parametrize(
    ("row", "offset"),
    [
        (14, (1.4, 0.2)),
        (14, (-0.3, -1.6)),
        (14, (2.5, 2.5)),
        (0, (1.4, 0.2)),
        (3, (1.4, 0.2)),
        (35, (-1.6, -0.3)),
    ],
)
def test_a_vertex_beyond_its_neighbours_comes_back(row, offset):
    cutout = grid_cutout(5, 5)
    pose = cutout.rest.copy()
    pose[row] += offset
    assert turned_over(pose, cutout.triangles).any()
    found = set_right(cutout.rest, cutout.triangles, pose)
    assert not turned_over(found, cutout.triangles).any()
    far = np.linalg.norm(cutout.rest - cutout.rest[row], axis=1) > 3.0
    assert np.array_equal(found[far], pose[far])


def test_a_drawing_turned_over_as_a_whole_is_given_up():
    cutout = grid_cutout(4, 4)
    assert set_right(cutout.rest, cutout.triangles, cutout.rest * [-1.0, 1.0]) is None


def test_triangles_without_area_count_as_turned_over():
    cutout = grid_cutout(2, 2)
    pose = cutout.rest.copy()
    pose[4] = pose[0]
    assert turned_over(pose, cutout.triangles).any()
    tiny = 1.0 + 1e-9 * cutout.rest  # which float32 cannot tell apart
    assert turned_over(tiny, cutout.triangles).all()


# ---- groups


@pytest.fixture
def finer():
    """A grid of 4 x 4, one of 12 x 12 over it, and how that hangs in it."""
    old, new = grid_cutout(4, 4), grid_cutout(12, 12)
    new = type(new)(new.rest / 3.0, new.triangles, new.parts, old.diagonal)
    return old, new, carrying(old.rest, old.triangles, new.rest)


def test_a_linear_weight_stays_linear(finer):
    old, new, hung = finer
    rows = np.arange(len(old.rest), dtype=np.int32)
    found, weights = group_carried(hung, len(old.rest), rows, old.rest[:, 0] / 4.0)
    assert len(found) == len(new.rest)
    assert weights == pytest.approx(new.rest[:, 0] / 4.0)


def test_a_group_fades_to_what_counts_beside_it(finer):
    old, new, hung = finer
    rows = np.flatnonzero(old.rest[:, 0] == 0.0).astype(np.int32)
    found, weights = group_carried(hung, len(old.rest), rows, np.ones(5))
    assert new.rest[found, 0].max() == pytest.approx(2 / 3)
    assert dict(zip(found.tolist(), weights.tolist(), strict=True))[1] == pytest.approx(2 / 3)
    _, beside = group_carried(hung, len(old.rest), rows, np.ones(5), beside=0.5)
    assert beside.min() == pytest.approx(0.5 + 0.5 / 3)


def test_a_patch_keeps_its_region_at_full_weight(finer):
    old, new, hung = finer
    rows = np.flatnonzero((np.abs(old.rest - 2.0) <= 1.0).all(axis=1)).astype(np.int32)
    found, weights = patch_carried(hung, len(old.rest), rows, np.ones(9))
    inside = (np.abs(new.rest - 2.0) <= 1.0 + 1e-9).all(axis=1)
    assert set(found.tolist()) == set(np.flatnonzero(inside))
    assert weights == pytest.approx(np.ones(len(found)))


@pytest.mark.parametrize(("rows", "count"), [([7], 1), ([6, 7, 8], 5)])
def test_a_patch_without_triangles_holds_what_is_nearest(finer, rows, count):
    old, new, hung = finer
    found, _ = patch_carried(hung, len(old.rest), np.array(rows, np.int32), np.ones(len(rows)))
    assert len(found) >= count
    middle = old.rest[rows].mean(axis=0)
    assert np.abs(new.rest[found].mean(axis=0) - middle).max() < 0.25


@pytest.mark.parametrize("rows", [[0], [7, 8], [6, 7, 12]])
def test_a_point_is_held_where_it_was(finer, rows):
    old, new, _ = finer
    holder = Holder(pin(rows, weights=np.linspace(0.3, 1.0, len(rows))), old)
    vertices, weights = nearest_binding(new, holder, np.arange(len(new.rest), dtype=np.int32))
    assert len(vertices) <= 3
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ new.rest[vertices] == pytest.approx(holder.place(old.rest), abs=1e-12)
