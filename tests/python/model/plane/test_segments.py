# SPDX-License-Identifier: GPL-3.0-or-later
"""Segments by their distance."""

import numpy as np
import pytest

from planar_deform.model.plane.segments import nearest_segment

STARTS = np.array([(0.0, 0.0), (0.0, 2.0), (5.0, 5.0)])
ENDS = np.array([(10.0, 0.0), (1.0, 2.0), (5.0, 5.0)])


@pytest.mark.parametrize(
    ("place", "nearest"),
    [
        ((5.0, 0.9), 0),  # by its middle, and not by its ends
        ((0.5, 1.2), 1),
        ((-1.0, 1.4), 1),  # beyond its end
        ((4.0, 4.0), 2),  # of no length
        ((12.0, 0.0), 0),
    ],
)
def test_the_nearest_point_of_a_segment_counts(place, nearest):
    assert nearest_segment(np.array(place), STARTS, ENDS) == nearest
