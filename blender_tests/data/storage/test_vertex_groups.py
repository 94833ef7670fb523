# SPDX-License-Identifier: GPL-3.0-or-later
"""The members of vertex groups."""

import numpy as np
from support import bar


def test_members_of_all_groups_that_are_asked_for():
    from planar_deform.scene.storage.vertex_groups import members

    obj = bar()
    weights = {
        "First": {3: 0.5, 1: 0.25},
        "Unasked": {1: 0.75, 2: 0.5},
        "Second": {3: 0.0, 64: 1.0},  # 0 counts for stiffness, whose neutral weight is another
        "Empty": {},
    }
    for name, rows in weights.items():
        group = obj.vertex_groups.new(name=name)
        for row, weight in rows.items():
            group.add([row], weight, "REPLACE")
    found = members(obj, ["Second", "First", "Empty", "Missing", ""])
    assert {name: (rows.tolist(), shares.tolist()) for name, (rows, shares) in found.items()} == {
        "First": ([1, 3], [0.25, 0.5]),
        "Second": (
            [3, 64],
            [0.0, 1.0],
        ),  # a weight of 0 counts for stiffness, whose neutral weight is another
        "Empty": ([], []),
    }
    assert all(rows.dtype == np.int32 and shares.dtype == np.float64 for rows, shares in found.values())
