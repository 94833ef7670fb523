# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: what the poses show, frame by frame, kept as shapes, as a point cache or as relative keys."""

from __future__ import annotations

from collections.abc import Generator

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

from .. import compat
from ..scene.motion import bake, point_cache
from .frame_range import FrameRange
from .modal.long_job import Job, LongOperator


class BakeOperator(FrameRange, LongOperator):
    """Bakes frames, to a point cache among others."""

    layout: bpy.types.UILayout  # of Blender's operators
    to: str  # what the frames become, as an EnumProperty in a subclass

    filepath: StringProperty(
        name="File",
        description="File of the point cache; by default the object's own, beside the .blend",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"} | compat.BLEND_RELATIVE,
    )
    replace: BoolProperty(
        name="Replace File",
        description="Write the point cache even over a file that is not the object's own",
        options={"SKIP_SAVE"},
    )

    _asked = False  # whether a file may be replaced

    def steps(self, obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
        """The bake itself, in a subclass, as in scene/motion/bake.py."""
        raise NotImplementedError

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        obj = context.object
        self._complete(context)
        if self.to == "POINT_CACHE" and not self.replace and point_cache.is_foreign(obj, self.filepath):
            self.replace = self._asked = True
            asked: set[str] = context.window_manager.invoke_confirm(
                self,
                event,
                title="Replace File?",
                message=f"There is a file {bpy.path.basename(self.filepath)} already",
                confirm_text="Replace",
            )
            return asked
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        if self._asked:  # the question has been answered by yes: Blender goes on here, and not with invoke()
            self._asked = False
            return self.start(context)
        return super().execute(context)

    def cancel(self, context: bpy.types.Context) -> None:
        if hasattr(self, "_run"):  # it is not the question that has been answered by no
            super().cancel(context)

    def job(self, context: bpy.types.Context) -> Job:
        obj = context.object
        self._complete(context)
        frames = self.frames
        return Job(write=lambda _: self._write(obj, frames), summary=lambda _: self._summary(frames))

    def _write(self, obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
        yield from self.steps(obj, frames)
        self.replace = True  # in the redo panel the file is that of this very bake

    def _complete(self, context: bpy.types.Context) -> None:
        """Give what is not said its default, so that the redo panel shows it."""
        self.complete_range(context)
        if not self.properties.is_property_set("filepath") or not self.filepath:
            self.filepath = point_cache.default_path(context.object)

    def _summary(self, frames: range) -> str:
        what = {"POINT_CACHE": f"'{self.filepath}'", "RELATIVE_KEYS": "shape keys"}
        return f"Baked frames {frames[0]} to {frames[-1]} to {what.get(self.to, 'poses')}"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "to")
        for name in ("frame_start", "frame_end", "frame_step"):
            column.prop(self, name)
        if self.to == "POINT_CACHE":
            self.draw_cache(column)

    def draw_cache(self, column: bpy.types.UILayout) -> None:
        """The settings of a point cache, in the redo panel."""
        for name in ("filepath", "replace"):
            column.prop(self, name)


class PLANAR_OT_bake(BakeOperator, bpy.types.Operator):
    bl_idname = "planar.bake"
    bl_label = "Bake"
    bl_description = "Keep what the poses show, with their timing and in-betweens, frame by frame"

    to: EnumProperty(name="To", description="What the frames become", items=bake.FORMS)
    free: BoolProperty(
        name="Remove Poses",
        description="Take the poses away when they are in a point cache, so that the .blend is small",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return bake.refusal(context.object)

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        chosen = next(text for form, _, text in bake.FORMS if form == properties.to)
        return f"{cls.bl_description}: {chosen[0].lower()}{chosen[1:]}"

    def steps(self, obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
        return bake.to(self.to, obj, frames, self.filepath, replace=self.replace, free=self.free)

    def draw_cache(self, column: bpy.types.UILayout) -> None:
        super().draw_cache(column)
        column.prop(self, "free")


CLASSES = (PLANAR_OT_bake,)
