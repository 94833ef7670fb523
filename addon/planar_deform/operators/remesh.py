# SPDX-License-Identifier: GPL-3.0-or-later
"""Another mesh for a cutout: finer or coarser, or of its changed image."""

from __future__ import annotations

from functools import partial

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..errors import Refusal
from ..scene.image import file_state, remesh_refusals, remesh_source
from ..scene.image.remeshing import Carried, Remesh
from ..scene.objects.cutout_object import begin
from .cutting_settings import CuttingSettings
from .modal.long_job import Job, LongOperator

SOURCES = (
    ("IMAGE", "Image", "Follow the drawing in the image that the mesh shows"),
    ("OUTLINE", "Outline", "Keep the outline that the mesh has at rest"),
)


class PLANAR_OT_remesh(CuttingSettings, LongOperator, bpy.types.Operator):
    bl_idname = "planar.remesh"
    bl_label = "Remesh Cutout"
    bl_description = (
        "Replace the mesh by a finer or coarser one of the same drawing. Pins, stiffness, poses, in-betweens "
        "and all else stay"
    )

    source: EnumProperty(
        name="From", description="What the new mesh is made of", items=SOURCES, options={"SKIP_SAVE"}
    )
    reload: BoolProperty(
        name="Reload",
        description="Read the image's file again, which has been painted on",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return remesh_refusals.refusal(context.object)

    def job(self, context: bpy.types.Context) -> Job:
        obj = context.object
        if not self.properties.is_property_set("source") and not remesh_source.shows_image(obj):
            self.source = "OUTLINE"
        drawing = begin(context, unkeyed=True)
        reason = remesh_refusals.thorough_refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        if self.reload:
            file_state.reload(obj)
        now = remesh_source.present(obj, drawing)
        make = remesh_source.of_images if self.source == "IMAGE" else remesh_source.of_outline
        remesh = Remesh(obj, now, make(obj, now, self.settings()))
        return Job(remesh.write, remesh.solve, partial(self._summary, len(drawing.rest)))

    def _summary(self, before: int, new: Carried) -> str:
        obj = bpy.context.object
        if self.source == "IMAGE":
            file_state.remember(obj)
        return "; ".join([f"'{obj.name}': {len(new.rest)} vertices instead of {before}", *new.said])

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.row().prop(self, "source", expand=True)
        self.draw_cutting(column, of_image=self.source == "IMAGE")


CLASSES = (PLANAR_OT_remesh,)
