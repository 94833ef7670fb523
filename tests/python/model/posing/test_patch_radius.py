# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches by how far they reach."""

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.plane.cutout import make_cutout
from planar_deform.model.posing.patch_radius import least_radius, vertices_within
from planar_deform.model.posing.pins import Holder


def test_all_vertices_within_the_radius_belong_and_no_others():
    cutout = grid_cutout(6, 5)
    holder = Holder(pin([16, 17, 24], weights=[0.25, 0.5, 0.25]), cutout)
    distances = np.linalg.norm(cutout.rest - holder.place(cutout.rest), axis=1)
    for radius in (1.0, 1.7, 3.3, 100.0):
        assert (
            vertices_within(holder, cutout.rest, radius).tolist()
            == np.flatnonzero(distances <= radius).tolist()
        )


def test_it_is_measured_on_the_shape_shown():
    cutout = grid_cutout(6, 5)
    holder = Holder(pin([16]), cutout)
    found = vertices_within(holder, 3.0 * cutout.rest, 3.0)
    assert found.tolist() == vertices_within(holder, cutout.rest, 1.0).tolist()


def test_one_vertex_is_no_patch_and_the_least_radius_makes_one():
    cutout = grid_cutout(6, 5)
    holder = Holder(pin([16, 17, 24], weights=[0.6, 0.3, 0.1]), cutout)
    least = least_radius(holder, cutout.rest)
    assert len(vertices_within(holder, cutout.rest, least)) == 2
    assert len(vertices_within(holder, cutout.rest, 0.999 * least)) == 0


def test_other_layers_are_left_alone():
    one = grid_cutout(3, 3)
    count = len(one.rest)
    rest = np.concatenate([one.rest, one.rest])
    triangles = np.concatenate([one.triangles, one.triangles + count]).astype(np.int32)
    parts = np.repeat(np.array([0, 1], np.int32), count)
    cutout = make_cutout(rest, triangles, parts)
    found = vertices_within(Holder(pin([count + 5]), cutout), rest, 1.2)
    assert found.min() >= count
    assert least_radius(Holder(pin([5]), cutout), rest) == pytest.approx(1.0), "not 0, to the layer behind"
