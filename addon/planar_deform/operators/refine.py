# SPDX-License-Identifier: GPL-3.0-or-later
"""Dividing the faces of a mesh that is too coarse to bend."""

from __future__ import annotations

import bmesh
import bpy

from ..scene.objects.cutout_object import begin
from ..scene.objects.refining import refined
from ..scene.pins import pin_list
from ..scene.view import coarseness
from .posing_operator import PosingOperator


class PLANAR_OT_refine_mesh(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.refine_mesh"
    bl_label = "Refine Mesh"
    bl_description = (
        "Divide the faces until the drawing can bend: n-gons become triangles, the longest edges are halved"
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = super().refusal(context)
        if reason is not None:
            return reason
        if context.object.data.shape_keys is not None:
            return "The mesh has shape keys already: subdivide it in Edit Mode, then look at each of them"
        if not coarseness.of(context.object):
            return "The mesh is fine enough to bend: subdivide it in Edit Mode if you want it finer"
        return None

    def apply(self, context: bpy.types.Context) -> None:
        obj = context.object
        begin(context)  # a mesh that cannot be posed is left alone
        pin_list.sync(obj)
        mesh = bmesh.new()
        try:
            mesh.from_mesh(obj.data)
            refined(mesh)
            mesh.to_mesh(obj.data)
        finally:
            mesh.free()
        obj.data.update()


CLASSES = (PLANAR_OT_refine_mesh,)
