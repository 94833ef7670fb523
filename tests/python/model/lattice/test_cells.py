# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells of a lattice's grid, whichever axis it is flat in."""

import numpy as np
import pytest

from planar_deform.model.lattice.cells import axis_across, border, cells_across, halves
from planar_deform.model.plane.cutout import signed_areas


def regular(counts):
    """N x 3, u fastest, at whole numbers."""
    w, v, u = np.meshgrid(*(np.arange(count) for count in reversed(counts)), indexing="ij")
    return np.stack([u, v, w], axis=-1).reshape(-1, 3).astype(np.float32)


@pytest.mark.parametrize(
    ("counts", "axis"),
    [
        ((4, 3, 1), 2),
        ((4, 1, 3), 1),
        ((1, 4, 3), 0),
        ((4, 3, 2), 2),
        ((2, 4, 3), 0),
        ((2, 2, 1), 2),
        ((4, 4, 4), None),
        ((4, 1, 1), None),
        ((1, 1, 1), None),
    ],
)
def test_the_axis_in_which_a_lattice_is_flat(counts, axis):
    assert axis_across(counts, [regular(counts)]) == axis


def test_two_layers_count_as_one_only_while_they_are_equal_in_every_shape():
    bent = regular((4, 3, 2))
    bent[:, 1] += bent[:, 0] ** 2
    assert axis_across((4, 3, 2), [regular((4, 3, 2)), bent]) == 2
    bent[-1, 0] += 0.1
    assert axis_across((4, 3, 2), [regular((4, 3, 2)), bent]) is None


def test_of_two_axes_with_two_layers_every_shape_is_looked_at_for_each():
    counts = (2, 2, 4)
    moved = regular(counts)
    moved[0] += (0.3, 0.2, 0.1)
    assert axis_across(counts, iter([moved])) is None
    bent = regular(counts)
    bent[:, 0] += bent[:, 2] ** 2
    assert axis_across(counts, iter([regular(counts), bent])) == 1


@pytest.mark.parametrize(("counts", "axis"), [((4, 3, 1), 2), ((4, 1, 3), 1), ((1, 4, 3), 0), ((4, 3, 2), 2)])
def test_the_cells_cover_each_layer_once_and_are_turned_alike(counts, axis):
    cells = cells_across(counts, axis)
    flat = np.delete(regular(counts), axis, axis=1).astype(float)
    areas = signed_areas(flat, halves(cells))
    assert len(cells) == 6 * counts[axis]
    np.testing.assert_allclose(np.abs(areas), 0.5)
    assert len(set(np.sign(areas))) == 1
    assert len({tuple(sorted(cell)) for cell in cells.tolist()}) == len(cells)


def test_the_border_of_a_flat_lattice_is_its_outline_and_of_a_box_its_twelve_edges():
    points = regular((4, 3, 1))
    edges = border((4, 3, 1))
    assert len(edges) == 2 * (3 + 2)
    inner = (points[:, 0] % 3 > 0) & (points[:, 1] == 1)
    assert not np.isin(edges, np.flatnonzero(inner)).any()
    assert len(border((4, 3, 2))) == 4 * (3 + 2 + 1)
    np.testing.assert_allclose(
        np.abs(np.diff(regular((4, 3, 2))[border((4, 3, 2))], axis=1)).sum(axis=2), 1.0
    )
