# SPDX-License-Identifier: GPL-3.0-or-later
"""The weights of vertex groups, of all that are asked for in one pass over the mesh."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np

from ...model.plane.frame import Array, Indices

Members = tuple[Indices, Array]  # vertices (k,) in the mesh's order, and their weights (k,)


def members(obj: bpy.types.Object, names: Iterable[str]) -> dict[str, Members]:
    """The vertices of each of these groups, those of weight 0 as well; missing groups are left out."""
    groups = obj.vertex_groups
    wanted = {groups[name].index: name for name in names if name in groups}
    found: dict[int, tuple[list[int], list[float]]] = {index: ([], []) for index in wanted}
    if found:
        for row, vertex in enumerate(obj.data.vertices):
            for element in vertex.groups:
                if element.group in found:
                    rows, weights = found[element.group]
                    rows.append(row)
                    weights.append(element.weight)
    return {
        wanted[index]: (np.array(rows, np.int32), np.array(weights, np.float64))
        for index, (rows, weights) in found.items()
    }
