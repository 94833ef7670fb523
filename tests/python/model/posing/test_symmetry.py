# SPDX-License-Identifier: GPL-3.0-or-later
"""Partners on the other side of a symmetric drawing, and what is said where there are none."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.plane.connectivity import Connectivity
from planar_deform.model.posing.pins import Holder
from planar_deform.model.posing.symmetry import NotSymmetricError, find_symmetry, nearest, partner_pins


def quads(nx, ny):
    """The faces of a grid of quads, vertex j * (nx + 1) + i."""
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    corners = np.stack([first, first + 1, first + nx + 2, first + nx + 1], axis=1).astype(np.int32)
    return Connectivity((nx + 1) * (ny + 1), np.full(len(corners), 4, np.int32), corners.ravel())


def scattered(seed, pairs=40):
    """A drawing without order: random points and mirror images about x = 3, shuffled; edges; partners."""
    rng = np.random.default_rng(seed)
    right = rng.uniform([3.1, 0.0], [6.0, 2.0], (pairs, 2))
    points = np.concatenate([right, np.stack([6.0 - right[:, 0], right[:, 1]], axis=1)])
    partners = np.concatenate([np.arange(pairs, 2 * pairs), np.arange(pairs)])
    edges = rng.integers(0, pairs, (3 * pairs, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    edges = np.concatenate([edges, edges + pairs])
    shuffle = rng.permutation(2 * pairs)
    back = np.argsort(shuffle)
    return points[shuffle], back[edges].astype(np.int32), back[partners[shuffle]]


@pytest.mark.parametrize("seed", range(5))
def test_every_vertex_finds_its_partner(seed):
    rest, edges, partners = scattered(seed)
    symmetry = find_symmetry(rest, edges, 0, 1e-9)
    assert symmetry.line == pytest.approx(3.0)
    assert np.array_equal(symmetry.partners, partners)
    assert symmetry.mirrored(rest) == pytest.approx(rest)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_mirrored_pose_is_the_pose_seen_in_the_mirror_and_twice_is_itself(axis):
    cutout = grid_cutout(6, 4)
    symmetry = find_symmetry(cutout.rest, quads(6, 4).edges(), axis, 1e-6)
    pose = cutout.rest + np.random.default_rng(1).normal(size=cutout.rest.shape)
    mirrored = symmetry.mirrored(pose)
    corner, other = (0, 6) if axis == 0 else (0, 28)
    expected = pose[other].copy()
    expected[axis] = (6.0, 4.0)[axis] - expected[axis]
    assert mirrored[corner] == pytest.approx(expected)
    assert symmetry.mirrored(mirrored) == pytest.approx(pose)


def test_a_vertex_out_of_place_is_counted_and_measured():
    cutout = grid_cutout(6, 4)
    rest = cutout.rest.copy()
    rest[8] += (0.0, 0.2)
    edges = quads(6, 4).edges()
    with pytest.raises(NotSymmetricError, match="2 of 35 .* the worst is 0.2"):
        find_symmetry(rest, edges, 0, 0.1)
    assert find_symmetry(rest, edges, 0, 0.3).partners[8] == 12


def test_a_partner_that_two_vertices_share_is_none():
    rest = np.array([[0, 0], [0, 0.01], [4, 0], [4, 3.0], [0, 3.0]])
    edges = np.array([[0, 2], [2, 3], [3, 4], [4, 0], [0, 1]], np.int32)
    with pytest.raises(NotSymmetricError, match="1 of 5 vertices share"):
        find_symmetry(rest, edges, 0, 0.1)


def test_edges_that_have_no_partner_are_counted():
    edges = grid_cutout(6, 4).triangles  # whose diagonals all run the same way
    edges = np.concatenate([edges[:, [0, 1]], edges[:, [1, 2]], edges[:, [2, 0]]])
    with pytest.raises(NotSymmetricError, match="24 of 82 edges have no partner"):
        find_symmetry(grid_cutout(6, 4).rest, edges, 0, 1e-6)


@pytest.mark.parametrize("count", [1, 7, 500])
def test_the_nearest_point_is_what_comparing_all_gives(count):
    rng = np.random.default_rng(count)
    points = np.round(rng.uniform(-1, 1, (count, 2)), 1)  # with equal coordinates
    queries = rng.uniform(-2, 2, (200, 2))
    index, distances = nearest(points, queries)
    expected = np.linalg.norm(points[None] - queries[:, None], axis=2)
    assert distances == pytest.approx(expected.min(axis=1))
    assert np.linalg.norm(points[index] - queries, axis=1) == pytest.approx(expected.min(axis=1))


def test_pins_find_the_pin_of_their_kind_on_the_other_side():
    cutout = grid_cutout(6, 4)
    symmetry = find_symmetry(cutout.rest, quads(6, 4).edges(), 0, 1e-6)
    pins = [pin([0]), pin([6], key=1), pin([3], key=2), pin([1], key=3), pin([7, 14], key=4, kind="PATCH")]
    pins += [pin([13, 20], key=5)]  # a point where the patch's partner would be
    holders = [Holder(each, cutout) for each in pins]
    assert partner_pins(holders, cutout.rest, symmetry, 0.01) == {0: 1, 1: 0, 2: 2}


def test_connectivity_says_what_differs():
    one = quads(3, 2)
    assert one.difference(quads(3, 2)) is None
    assert one.difference(quads(3, 3)) == "12 vertices, not 16"
    fewer = Connectivity(12, one.sizes[:-1], one.corners[:-4])
    assert one.difference(fewer) == "6 faces, not 5"
    other = Connectivity(12, one.sizes, np.concatenate([one.corners[4:], one.corners[:4]]))
    assert one.difference(other) == "6 of 6 faces on other vertices"
    sizes = one.sizes.copy()
    sizes[0], sizes[1] = 3, 5
    assert one.difference(Connectivity(12, sizes, one.corners)) == "2 faces with another number of corners"
    assert len(one.edges()) == 17
