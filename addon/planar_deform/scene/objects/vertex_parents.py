# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that hang on vertices of a mesh by Blender's own parenting, and stay where they are meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ...model.plane.frame import Array, Array32

COUNTS = {"VERTEX": 1, "VERTEX_3": 3}  # vertices by which each kind of parent holds


@dataclass(frozen=True)
class Hanging:
    """An object that hangs on vertices: where these are at rest, and what is above it."""

    name: str
    places: Array  # k x 3, in the space of the mesh
    above: Matrix  # in the world, of the object's own transform


def is_hanging(obj: bpy.types.Object) -> bool:
    """Whether an object hangs on vertices of another one."""
    return obj.parent is not None and obj.parent_type in COUNTS


def above(obj: bpy.types.Object) -> Matrix:
    """In what an object's own transform is."""
    return Matrix() if obj.parent is None else obj.matrix_world @ obj.matrix_basis.inverted_safe()


def hang(obj: bpy.types.Object, carrier: bpy.types.Object, vertices: list[int], held: Matrix) -> None:
    """Parent an object to one or three vertices, with its own transform in `held`, as now."""
    kind = "VERTEX" if len(vertices) == 1 else "VERTEX_3"
    frame = _frame_of(carrier, kind, vertices)
    _parent(obj, carrier, kind, vertices)
    obj.matrix_parent_inverse = frame.inverted_safe() @ held


def read(carrier: bpy.types.Object, rest: Array32) -> list[Hanging]:
    """What hangs on the vertices of a mesh, whose rest is count x 3."""
    hung = [obj for obj in bpy.data.objects if obj.parent == carrier and is_hanging(obj)]
    return [
        Hanging(
            obj.name, rest[list(obj.parent_vertices)[: COUNTS[obj.parent_type]]].astype(float), above(obj)
        )
        for obj in hung
        if max(list(obj.parent_vertices)[: COUNTS[obj.parent_type]]) < len(rest)
    ]


def put_back(hung: list[Hanging], carrier: bpy.types.Object, rest: Array32) -> None:
    """Let it hang on the nearest vertices of another mesh, whose rest is count x 3."""
    for one in hung:
        vertices: list[int] = []
        for place in one.places:
            gaps = np.linalg.norm(rest - place, axis=1)
            gaps[vertices] = np.inf
            vertices.append(int(gaps.argmin()))
        hang(bpy.data.objects[one.name], carrier, vertices, one.above)


def _frame_of(carrier: bpy.types.Object, kind: str, vertices: list[int]) -> Matrix:
    """Where Blender has the origin of what hangs on vertices: another object tells it."""
    probe = bpy.data.objects.new("Probe", None)
    try:
        bpy.context.scene.collection.objects.link(probe)
        _parent(probe, carrier, kind, vertices)
        bpy.context.view_layer.update()
        return probe.matrix_world.copy()
    finally:
        bpy.data.objects.remove(probe)


def _parent(obj: bpy.types.Object, carrier: bpy.types.Object, kind: str, vertices: list[int]) -> None:
    obj.parent, obj.parent_type = carrier, kind
    obj.parent_vertices = (vertices * 3)[:3]
