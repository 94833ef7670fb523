# SPDX-License-Identifier: GPL-3.0-or-later
"""What joins vertices is the same from a mesh's attributes as from its lists, and in Edit Mode, too."""

import bpy
import numpy as np
import pytest
from support import make_object


def listed(items, field, size=1):
    values = np.empty(len(items) * size, np.int32)
    items.foreach_get(field, values)
    return values


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT", "WEIGHT_PAINT"])
def test_attributes_tell_what_the_lists_tell(mode):
    from planar_deform.scene.storage import topology

    points = [(x, y, 0.0) for y in range(3) for x in range(3)]
    mesh = make_object(points, [(0, 1, 4, 3), (1, 2, 4), (4, 5, 8, 7, 3)], edges=[(2, 5), (6, 7)]).data
    bpy.ops.object.mode_set(mode=mode)
    assert (".corner_vert" in mesh.attributes) == (mode != "EDIT"), "else this tests one way only"
    assert topology.corner_vertices(mesh).tolist() == [0, 1, 4, 3, 1, 2, 4, 4, 5, 8, 7, 3]
    assert np.array_equal(topology.corner_edges(mesh), listed(mesh.loops, "edge_index"))
    edges = topology.edge_vertices(mesh)
    assert np.array_equal(edges.ravel(), listed(mesh.edges, "vertices", 2))
    assert {(2, 5), (6, 7)} < {tuple(sorted(edge)) for edge in edges.tolist()}
