# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest positions for vertices that have none of their own."""

import numpy as np
import pytest
from cutouts import grid_cutout

from planar_deform.model.plane.rest import (
    coincident_edges,
    completed,
    copied_along_edges,
    copied_parts,
    fitted,
)
from planar_deform.model.posing.pins import rotation


@pytest.mark.parametrize("columns", [1, 2, 5])
def test_unknown_vertices_continue_the_known_ones_under_a_rigid_motion_exactly(columns):
    cutout = grid_cutout(8, 4)
    current = cutout.rest @ rotation(2.5).T + [30.0, -4.0]
    known = cutout.rest[:, 0] <= 8 - columns
    rest = np.where(known[:, None], cutout.rest, 0.0)
    assert completed(rest, current, cutout.triangles, known) == pytest.approx(cutout.rest, abs=1e-12)


def test_what_is_known_keeps_its_bits_and_what_cannot_be_known_rests_as_it_is():
    cutout = grid_cutout(3, 3)
    current = cutout.rest * 1.25
    known = np.zeros(16, bool)
    assert np.array_equal(completed(np.zeros((16, 2)), current, cutout.triangles, known), current)
    known[:8] = True
    rest = completed(cutout.rest, current, cutout.triangles, known)
    assert np.array_equal(rest[:8], cutout.rest[:8])


def test_copies_along_edges_are_the_later_vertices_that_have_moved_away():
    cutout = grid_cutout(2, 2)
    rest = cutout.rest.astype(np.float32)
    rest[6:] = rest[3:6]  # the last row was extruded from the one below
    edges = coincident_edges(rest, cutout.triangles)
    assert copied_along_edges(edges, cutout.rest, 1e-5).nonzero()[0].tolist() == [6, 7, 8]
    assert not copied_along_edges(edges, rest.astype(float), 1e-5).any()  # not moved: merged


def test_copied_parts_repeat_earlier_ones_entirely():
    points = np.random.default_rng(0).normal(size=(10, 3)).astype(np.float32)
    rest = np.concatenate([points, points[::-1], points[:5], points[:5] + 1])
    parts = np.repeat([0, 1, 2, 3], [10, 10, 5, 5]).astype(np.int32)
    assert copied_parts(rest, parts) == [1, 2]
    assert copied_parts(points, np.zeros(10, np.int32)) == []


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_the_best_similarity_is_recovered_also_where_a_drawing_was_turned_over(mirror):
    rng = np.random.default_rng(5)
    rest = np.concatenate([rng.normal(size=(20, 2)), np.full((20, 1), 0.5)], axis=1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    current = 2.5 * (rest * [mirror, 1, 1]) @ turn.T + [1, 2, 3]
    assert fitted(rest, current, scaled=True) == pytest.approx(current, abs=1e-12)
    rigid = fitted(rest, current, scaled=False)
    assert rigid.mean(axis=0) == pytest.approx(current.mean(axis=0))
    gaps = np.linalg.norm(rigid[0] - rigid[1:], axis=1) / np.linalg.norm(rest[0] - rest[1:], axis=1)
    assert gaps == pytest.approx(np.ones(19))
