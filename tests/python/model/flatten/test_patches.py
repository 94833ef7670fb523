# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces cut along seams into patches."""

import numpy as np
import pytest

from planar_deform.model.flatten.patches import Corners, cut, following_corners, matched


def corners_of(faces):
    """The corners of faces, with edges numbered in their order, and those by their ends."""
    sizes = np.array([len(face) for face in faces], np.int32)
    vertices = np.concatenate(faces).astype(np.int32)
    ends = np.sort(np.stack([vertices, vertices[following_corners(sizes)]], axis=1), axis=1)
    edges, numbers = np.unique(ends, axis=0, return_inverse=True)
    index = {tuple(pair): number for number, pair in enumerate(edges.tolist())}
    return Corners(sizes, vertices, numbers.ravel().astype(np.int32)), index


def fan(faces):
    """Faces cut into triangles of corners."""
    found, first = [], 0
    for face in faces:
        found += [(first, first + i, first + i + 1) for i in range(1, len(face) - 1)]
        first += len(face)
    return np.array(found, np.int32)


def patches(faces, seams=(), chosen=None):
    corners, index = corners_of(faces)
    marked = np.zeros(len(index), bool)
    marked[[index[tuple(sorted(seam))] for seam in seams]] = True
    wanted = np.ones(len(faces), bool) if chosen is None else np.isin(np.arange(len(faces)), chosen)
    return cut(corners, wanted, marked, fan(faces))


def sheet(nx, ny):
    row = nx + 1
    return [
        (j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
        for j in range(ny)
        for i in range(nx)
    ]


def test_without_seams_a_sheet_stays_as_it_is():
    found = patches(sheet(3, 2))
    assert found.count == 1
    assert found.vertices.tolist() == list(range(12))
    assert np.array_equal(found.vertices[found.flat], np.concatenate(sheet(3, 2)))
    assert not found.numbers.any()
    assert len(found.triangles) == 12


def test_a_seam_across_makes_two_patches_whose_edges_have_the_same_numbers():
    found = patches(sheet(2, 2), [(1, 4), (4, 7)])
    assert found.count == 2
    assert [found.vertices[found.rows(patch)].tolist() for patch in (0, 1)] == [
        [0, 1, 3, 4, 6, 7],
        [1, 2, 4, 5, 7, 8],
    ]
    for number, ends in ((1, {1, 4}), (2, {4, 7})):
        edges = found.edges[found.numbers == number]
        assert [set(found.vertices[edge].tolist()) for edge in edges] == [ends, ends]
        assert set(found.patch[edges[:, 0]]) == {0, 1}
    assert found.face_in(1) == 1
    assert found.edge_of((4, 1), 0) is not None
    assert found.edge_of((2, 5), 0) is None


def test_a_seam_that_ends_inside_is_a_slit():
    found = patches(sheet(3, 3), [(1, 5), (5, 9)])
    assert found.count == 1
    assert sorted(found.vertices.tolist()) == sorted([*range(16), 1, 5])


def test_a_seam_of_which_neither_end_is_at_the_border_opens_between_its_ends_alone():
    assert sorted(patches(sheet(4, 4), [(6, 11), (11, 16)]).vertices.tolist()) == sorted([*range(25), 11])
    assert sorted(patches(sheet(4, 4), [(6, 11)]).vertices.tolist()) == list(range(25)), (
        "one edge cannot open"
    )


def test_faces_that_meet_in_a_vertex_alone_are_patches_of_their_own():
    found = patches([(0, 1, 2), (2, 3, 4)])
    assert found.count == 2
    assert sorted(found.vertices.tolist()) == [0, 1, 2, 2, 3, 4]


def test_faces_wound_against_each_other_are_joined_all_the_same():
    found = patches([(0, 1, 2), (1, 2, 3)])
    assert found.count == 1
    assert len(found.vertices) == 4


def test_chosen_faces_are_cut_as_if_the_others_were_not_there():
    found = patches(sheet(3, 1), chosen=[0, 2])
    assert found.count == 2
    assert found.faces.tolist() == [0, 2]
    assert found.corners.tolist() == [0, 1, 2, 3, 8, 9, 10, 11]
    assert len(found.triangles) == 4
    assert found.triangles_of(1).max() == 3


def test_three_faces_at_an_edge_are_refused():
    with pytest.raises(ValueError, match="More than two faces meet in edge 0"):
        patches([(0, 1, 2), (0, 1, 3), (1, 0, 4)])
    assert patches([(0, 1, 2), (0, 1, 3), (1, 0, 4)], chosen=[0, 1]).count == 1


def test_faces_are_matched_by_their_vertices_wherever_they_begin():
    flat, _ = corners_of([(0, 1, 2), (3, 4, 5, 6)])
    surface, _ = corners_of([(9, 8, 7, 6), (5, 4, 3, 2), (11, 12, 10)])
    vertices = np.array([10, 11, 12, 4, 3, 2, 5], np.int32)
    found = matched(flat, vertices, surface)
    assert np.array_equal(surface.vertices[found], vertices[flat.vertices])
    assert matched(flat, np.array([10, 11, 12, 4, 3, 2, 6], np.int32), surface) is None
