# SPDX-License-Identifier: GPL-3.0-or-later
"""The weights of vertex groups, of all that an object has in one pass over the mesh.

Blender gives them vertex by vertex alone, which takes some ten milliseconds of a dense mesh. So they are kept
until an edit of the object is told (see changes.py), and whatever writes a group here tells of it.
"""

from __future__ import annotations

from collections import OrderedDict, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import bpy
import numpy as np

from ...model.latest import make_room
from ...model.plane.frame import Array, Indices
from . import changes

ROOM = 2_000_000  # weights together, of 12 bytes

Members = tuple[Indices, Array]  # vertices (k,) in the mesh's order, and their weights (k,)


@dataclass(frozen=True)
class _Kept:
    edits: changes.Others
    names: list[str]  # of all groups, of whose removal Blender does not tell
    groups: dict[str, Members]


_kept: OrderedDict[int, _Kept] = OrderedDict()  # by session_uid, the last one asked for at the end


def members(obj: bpy.types.Object, names: Iterable[str]) -> dict[str, Members]:
    """The vertices of each of these groups, those of weight 0 as well; missing groups are left out.

    They are the caller's to read, not to change.
    """
    wanted = [name for name in names if name in obj.vertex_groups]
    if not wanted:
        return {}
    edits, present = changes.others(obj), obj.vertex_groups.keys()
    kept = _kept.get(obj.session_uid)
    # Of what is hidden Blender tells nothing until it is shown.
    if kept is None or (kept.edits, kept.names) != (edits, present) or not obj.visible_get():
        kept = _kept[obj.session_uid] = _Kept(edits, present, _read(obj))
        make_room(_kept, ROOM, lambda kept: sum(len(rows) for rows, _ in kept.groups.values()))
    _kept.move_to_end(obj.session_uid)
    return {name: kept.groups[name] for name in wanted}


def fill(group: bpy.types.VertexGroup, vertices: Indices, weights: Array) -> None:
    """Give these mesh vertices their weights in a group."""
    for vertex, weight in zip(vertices.tolist(), weights.tolist(), strict=True):
        group.add([vertex], weight, "REPLACE")
    changes.tell(group.id_data)


def give(group: bpy.types.VertexGroup, vertices: Sequence[int], weight: float) -> None:
    """Give these mesh vertices one weight in a group."""
    group.add(vertices, weight, "REPLACE")
    changes.tell(group.id_data)


def clear(group: bpy.types.VertexGroup) -> None:
    """Take all vertices out of a group."""
    obj: bpy.types.Object = group.id_data
    group.remove(range(len(obj.data.vertices)))
    changes.tell(obj)


def forget() -> None:
    """Keep none."""
    _kept.clear()


def _read(obj: bpy.types.Object) -> dict[str, Members]:
    """All groups of an object."""
    found: defaultdict[int, tuple[list[int], list[float]]] = defaultdict(lambda: ([], []))
    for row, elements in enumerate(map(attrgetter("groups"), obj.data.vertices)):
        for element in elements:
            rows, weights = found[element.group]
            rows.append(row)
            weights.append(element.weight)
    return {
        group.name: (np.array(found[group.index][0], np.int32), np.array(found[group.index][1], np.float64))
        for group in obj.vertex_groups
    }
