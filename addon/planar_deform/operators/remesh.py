# SPDX-License-Identifier: GPL-3.0-or-later
"""Another mesh for a cutout: finer or coarser, or of its changed image."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..errors import Refusal
from ..scene.image import canvases, file_state, remesh_refusals, remesh_source
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
        chosen = self.reload or self.properties.is_property_set("source")
        drawing = begin(context, unkeyed=True)
        reason = remesh_refusals.thorough_refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        if self.reload:
            file_state.reload(obj)
            if not self.properties.is_property_set("vertices"):
                self.density, self.vertices = "VERTICES", len(drawing.rest)  # as finely as it was
        now = remesh_source.present(obj, drawing)
        if not chosen and not remesh_source.shows_image(obj):
            self.source = "OUTLINE"
        source, told = None, ""
        if self.source == "IMAGE":
            try:
                fitted, said = canvases.fitted(obj, now)
                source = remesh_source.of_images(obj, fitted, self.settings())
                now, told = fitted, "".join(f"; {sentence}" for sentence in said)
            except Refusal as reason:
                if chosen:
                    raise
                self.source, told = "OUTLINE", f"; by its outline: {reason}"
        current = source is not None and (file_state.is_read(obj) or not file_state.is_changed(obj))
        remesh = Remesh(obj, now, source or remesh_source.of_outline(obj, now, self.settings()))
        summary = partial(self._summary, obj.name, len(drawing.rest), told)
        return Job(partial(self._write, remesh, current), remesh.solve, summary)

    def _write(self, remesh: Remesh, current: bool, new: Carried) -> Generator[float, None, None]:
        yield from remesh.write(new)
        if current:
            file_state.remember(bpy.context.object)

    def _summary(self, name: str, before: int, told: str, new: Carried) -> str:
        return "; ".join([f"'{name}': {len(new.rest)} vertices instead of {before}{told}", *new.said])

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.row().prop(self, "source", expand=True)
        self.draw_cutting(column, of_image=self.source == "IMAGE")


CLASSES = (PLANAR_OT_remesh,)
