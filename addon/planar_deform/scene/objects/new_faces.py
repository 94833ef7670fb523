# SPDX-License-Identifier: GPL-3.0-or-later
"""Other vertices and faces for a mesh that stays the same data-block, with its shape keys and attributes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from ...model.plane.frame import Array32, Indices, Mask
from ..storage.vertex_groups import Members


@dataclass(frozen=True)
class NewFaces:
    """What a mesh is to be made of."""

    shape: Array32  # k x 3
    faces: Indices  # f x 3, as they face
    materials: Indices  # f
    smooth: Mask  # f
    groups: Mapping[int, Members]  # by the index of the vertex group


def replace(mesh: bpy.types.Mesh, new: NewFaces) -> None:
    """Replace all vertices and faces of a mesh in Object Mode.

    Shape keys keep their names, eval_times and settings, and get as many points, whose places are to be
    written; so do attributes.
    """
    copy = bmesh.new()
    try:
        copy.from_mesh(mesh)
        bmesh.ops.delete(copy, geom=list(copy.verts), context="VERTS")
        vertices = [copy.verts.new(place) for place in new.shape.tolist()]
        if new.groups:
            weights = copy.verts.layers.deform.verify()
            for index, (rows, shares) in new.groups.items():
                for row, share in zip(rows.tolist(), shares.tolist(), strict=True):
                    vertices[row][weights][index] = share
        triples = zip(new.faces.tolist(), new.materials.tolist(), new.smooth.tolist(), strict=True)
        for number, (corners, material, smooth) in enumerate(triples):
            face = copy.faces.new([vertices[corner] for corner in corners])
            face.material_index, face.smooth, face.index = material, smooth, number
        for number, vertex in enumerate(vertices):
            vertex.index = number
        copy.verts.sort()  # they have been put where deleted ones were
        copy.faces.sort()
        copy.to_mesh(mesh)
    finally:
        copy.free()


def face_settings(mesh: bpy.types.Mesh) -> tuple[Indices, Mask]:
    """The material's slot of each face, and whether it is smooth."""
    materials, smooth = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("material_index", materials)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return materials, smooth


def face_of_corners(mesh: bpy.types.Mesh) -> Indices:
    """The face of each corner."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    return np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
