# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: what the poses show, frame by frame, kept as shapes, as a point cache or as relative keys."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..scene import bake, compat, point_cache
from ..scene.access import Refusal
from .long_operator import Job, LongOperator

FORMS = (
    (
        "SHAPES",
        "Shapes",
        "A keyed pose for each frame: easing, steps and in-betweens become poses, which can be changed",
    ),
    ("POINT_CACHE", "Point Cache", "A .pc2 file that a Mesh Cache modifier plays, for long shots"),
    (
        "RELATIVE_KEYS",
        "Relative Keys",
        "A relative shape key for each frame, for export to other programs; the poses are taken away",
    ),
)


class PLANAR_OT_bake(LongOperator, bpy.types.Operator):
    bl_idname = "planar.bake"
    bl_label = "Bake"
    bl_description = "Keep what the poses show, with their timing and in-betweens, frame by frame"

    to: EnumProperty(name="To", description="What the frames become", items=FORMS)
    frame_start: IntProperty(name="First Frame", description="By default the scene's, or its preview's")
    frame_end: IntProperty(name="Last Frame", description="By default the scene's, or its preview's")
    frame_step: IntProperty(
        name="Step", description="Frames from one baked frame to the next", default=1, min=1, soft_max=12
    )
    filepath: StringProperty(
        name="File",
        description="File of the point cache; by default the object's own, beside the .blend",
        subtype="FILE_PATH",
        options=compat.BLEND_RELATIVE,
    )
    replace: BoolProperty(
        name="Replace File",
        description="Write the point cache even over a file that is not the object's own",
        options={"SKIP_SAVE"},
    )
    free: BoolProperty(
        name="Remove Poses",
        description="Take the poses away when they are in a point cache, so that the .blend is small",
    )

    @classmethod
    def refusal(cls, context):
        return bake.refusal(context.object)

    @classmethod
    def description(cls, context, properties):
        chosen = next(text for form, _, text in FORMS if form == properties.to)
        return f"{cls.bl_description}: {chosen[0].lower()}{chosen[1:]}"

    def invoke(self, context, event):
        obj = context.object
        self._complete(context)
        if self.to == "POINT_CACHE" and not self.replace and point_cache.is_foreign(obj, self.filepath):
            self.replace = True
            return context.window_manager.invoke_confirm(
                self,
                event,
                title="Replace File?",
                message=f"There is a file {bpy.path.basename(self.filepath)} already",
                confirm_text="Replace",
            )
        return super().invoke(context, event)

    def job(self, context):
        obj = context.object
        self._complete(context)
        if self.frame_end < self.frame_start:
            raise Refusal("The last frame is before the first one: exchange them")
        frames = range(self.frame_start, self.frame_end + 1, self.frame_step)
        return Job(write=lambda _: self._bake(obj, frames), summary=lambda _: self._summary(frames))

    def _bake(self, obj, frames):
        if self.to == "POINT_CACHE":
            yield from bake.to_point_cache(obj, frames, self.filepath, replace=self.replace, free=self.free)
            self.replace = True  # in the redo panel it is the file of this very bake
        elif self.to == "RELATIVE_KEYS":
            yield from bake.to_relative_keys(obj, frames)
        else:
            yield from bake.to_shapes(obj, frames)

    def _complete(self, context):
        """Give what is not said its default, so that the redo panel shows it."""
        scene = context.scene
        preview = scene.use_preview_range
        defaults = {
            "frame_start": scene.frame_preview_start if preview else scene.frame_start,
            "frame_end": scene.frame_preview_end if preview else scene.frame_end,
            "filepath": point_cache.default_path(context.object),
        }
        for name, value in defaults.items():
            if not self.properties.is_property_set(name):
                setattr(self, name, value)

    def _summary(self, frames):
        what = {"SHAPES": "poses", "POINT_CACHE": f"'{self.filepath}'", "RELATIVE_KEYS": "shape keys"}
        return f"Baked frames {frames[0]} to {frames[-1]} to {what[self.to]}"

    def draw(self, context):
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "to")
        for name in ("frame_start", "frame_end", "frame_step"):
            column.prop(self, name)
        if self.to == "POINT_CACHE":
            for name in ("filepath", "replace", "free"):
                column.prop(self, name)


CLASSES = (PLANAR_OT_bake,)
