# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts made from images: from files, dropped or chosen, and from image planes that are there."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    StringProperty,
)

from ..errors import Refusal
from ..scene.image import cutout_mesh, file_state, image_plane, preview
from ..scene.image.cutting import Cut, among, cuts
from ..scene.image.image_plane import ImagePlane
from ..scene.image.importing import Undoing, import_planes, load
from ..scene.objects.adding import select_alone
from ..scene.pins import pin_list
from ..scene.storage.paths import absolute
from ..scene.view.shading import show_textures
from .cutting_settings import CuttingSettings
from .modal.long_job import Job, LongOperator

LAYERS = (
    ("OBJECTS", "Objects", "An object for each file"),
    ("PARTS", "Parts", "One object with a part for each file"),
)
SIZES = (
    ("DPBU", "Pixels per Unit", "By the image's pixels, so that layers fit together"),
    ("ABSOLUTE", "Height", "All images get this height"),
)
AXES = tuple(
    (axis, axis, f"Facing {name} {axis[1]}")
    for axis, name in (
        ("-Y", "negative"),
        ("+Y", "positive"),
        ("+X", "positive"),
        ("-X", "negative"),
        ("+Z", "positive"),
        ("-Z", "negative"),
    )
)
INTERPOLATIONS = (
    ("Linear", "Linear", "Smooth, for drawings"),
    ("Closest", "Closest", "Sharp pixels, for pixel art"),
    ("Cubic", "Cubic", "Smoother still"),
)
SHADERS = (
    ("EMISSION", "Emission", "Rendered in its own colours, without lights"),
    ("PRINCIPLED", "Principled", "Lit by the scene's lights"),
    ("SHADELESS", "Shadeless", "In its own colours, and seen by camera and reflections alone"),
)


class Cutting(CuttingSettings, LongOperator):
    """Makes meshes of images by these settings."""

    separate_islands: BoolProperty(
        name="Separate Islands", description="Make an object of each part of the drawing that hangs together"
    )

    def draw_settings(self, column: bpy.types.UILayout, *, islands: bool = True) -> None:
        self.draw_cutting(column)
        if islands:
            column.prop(self, "separate_islands")

    def finish(self, context: bpy.types.Context, found: list[Cut], *, joined: str = "") -> str:
        """Put the cutouts where the planes are, or one object of this name; what is to be told."""
        for made in found:
            _ = made.plane.texture  # raises ObjectGone, with nothing changed
        lost = [said for made in found if (said := cutout_mesh.lost(made.plane)) is not None]
        shown = preview.of(found, type(self).__name__)
        objects = []
        for made in found:
            objects += cutout_mesh.swap(
                made.plane, made.drawing, separate=self.separate_islands and not joined
            )
        count = sum(len(made.drawing.points) for made in found)
        if joined and len(objects) > 1:
            objects = [cutout_mesh.joined(context, objects, joined)]
        if context.window is not None:
            preview.show(shown, objects)
            show_textures(context.window)
        for obj in objects:
            file_state.remember(obj)
        select_alone(context, objects[0])
        for obj in objects[1:]:
            obj.select_set(True)
        what = f"{len(objects)} cutouts" if len(objects) > 1 else f"'{objects[0].name}'"
        told = [said for made in found for said in made.said] + lost
        if joined and self.separate_islands:
            told.append("islands are not separated where files become parts of one object")
        return "; ".join([f"{what}: {count} vertices", *told])


class FromFiles(Cutting):
    """Makes cutouts of files, by these settings."""

    layout: bpy.types.UILayout  # of Blender's operators, and so are these
    properties: bpy.types.OperatorProperties

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    filter_image: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})
    filter_folder: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})

    image_sequence: BoolProperty(
        name="Detect Image Sequences",
        description="Files numbered one after the other become one cutout that plays them, as wide as all",
    )
    layers: EnumProperty(name="Several Files", description="What several files become", items=LAYERS)
    offset: FloatProperty(
        name="Offset",
        description="From one layer to the next, in front of it: so little that depths of pins reach across",
        default=0.001,
        min=0.0,
        soft_max=1.0,
        precision=4,
        subtype="DISTANCE",
    )
    size_mode: EnumProperty(name="Size", description="How large the cutout is", items=SIZES)
    factor: FloatProperty(
        name="Pixels per Unit", description="How many pixels make a unit", default=600.0, min=1.0
    )
    height: FloatProperty(
        name="Height", description="Of the whole image", default=1.0, min=0.001, subtype="DISTANCE"
    )
    align_axis: EnumProperty(name="Align", description="Where the cutout faces", items=AXES)
    interpolation: EnumProperty(
        name="Interpolation", description="How the texture is read between its pixels", items=INTERPOLATIONS
    )
    shader: EnumProperty(name="Shader", description="How the cutout is rendered", items=SHADERS)

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _mode_refusal(context)

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        several = self.several()
        self.draw_settings(column, islands=not several or self.layers == "OBJECTS")
        column.separator()
        if several:
            column.row().prop(self, "layers", expand=True)
            column.prop(self, "offset")
            column.prop(self, "image_sequence")
        size = "factor" if self.size_mode == "DPBU" else "height"
        for name in ("size_mode", size, "align_axis", "interpolation", "shader"):
            column.prop(self, name)

    def several(self) -> bool:
        """Whether there may be several files."""
        return True


class PLANAR_OT_cutout_from_image(FromFiles, bpy.types.Operator):
    bl_idname = "planar.cutout_from_image"
    bl_label = "Cutout from Image"
    bl_description = (
        "Make cutouts of image files: meshes that follow the outline of the drawing and show it, ready to be "
        "pinned"
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self._paths():
            return super().invoke(context, event)
        bpy.ops.planar.choose_images("INVOKE_DEFAULT", **_settings_of(self))
        return {"CANCELLED"}

    def several(self) -> bool:
        return len(self._paths()) > 1

    def job(self, context: bpy.types.Context) -> Job:
        preview.forget()
        paths = self._paths()
        if not paths:
            raise Refusal("Which images? Choose some files")
        if len({path.parent for path in paths}) > 1:
            raise Refusal("The files are in several folders: import those of each folder by themselves")
        told: list[str] = []
        return Job(lambda _: self._write(paths, told), summary=lambda _: "; ".join(told))

    def _write(self, paths: list[Path], told: list[str]) -> Generator[float, None, None]:
        undoing = Undoing(bpy.context)
        try:
            loading = load(undoing, paths, sequences=self.image_sequence)
            images = yield from among(loading, 0, 2)
            planes = import_planes(undoing, images, paths, self._plane_options())
            found = yield from among(cuts(planes, self.settings(), loaded=True), 1, 2)
            with undoing.noting():
                parts = self.several() and self.layers == "PARTS"
                character = paths[0].parent.name or "Character"
                told.append(self.finish(bpy.context, found, joined=character if parts else ""))
        except BaseException:  # a refusal, an error, or closed before its end
            undoing.take_back(bpy.context)
            raise

    def _paths(self) -> list[Path]:
        """Each file once, in the order in which they are given."""
        names = [file.name for file in self.files if file.name]
        if names:
            folder = absolute(self.directory)
            return list(dict.fromkeys(folder / name for name in names))
        return [absolute(self.filepath)] if self.filepath else []

    def _plane_options(self) -> dict[str, Any]:
        return {
            "align_axis": self.align_axis,
            "size_mode": self.size_mode,
            "factor": self.factor,
            "height": self.height,
            "offset": True,
            "offset_axis": "+Z",
            "offset_amount": self.offset,
            "image_sequence": self.image_sequence,
            "interpolation": self.interpolation,
            "extension": "CLIP",
            "shader": self.shader,
            "overwrite_material": False,  # another one's, that has the same name
            "relative": True,
        }


class PLANAR_OT_choose_images(FromFiles, bpy.types.Operator):
    """After the file browser an operator has no redo panel, and cannot be modal: this one starts another."""

    bl_idname = "planar.choose_images"
    bl_label = "Cutout from Image"
    bl_description = "Choose files, then make cutouts of them"
    bl_options = {"INTERNAL"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        files = [{"name": file.name} for file in self.files]
        try:
            bpy.ops.planar.cutout_from_image(
                "INVOKE_DEFAULT",
                True,
                filepath=self.filepath,
                directory=self.directory,
                files=files,
                **_settings_of(self),
            )
        except RuntimeError as error:
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            return {"CANCELLED"}
        return {"FINISHED"}


class PLANAR_OT_make_cutout(Cutting, bpy.types.Operator):
    bl_idname = "planar.make_cutout"
    bl_label = "Make Cutout"
    bl_description = (
        "Give the selected image planes meshes that follow the outline of their drawings; they stay where "
        "they are, with their materials"
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = _mode_refusal(context)
        if reason is not None:
            return reason
        if not context.selected_objects:
            return "Select planes that show an image, or add one with Add > Image > Cutout from Image"
        return next(filter(None, map(_plane_refusal, context.selected_objects)), None)

    def job(self, context: bpy.types.Context) -> Job:
        preview.forget()
        active = context.view_layer.objects.active
        objects = sorted(context.selected_objects, key=lambda obj: (obj != active, obj.name))
        planes = [image_plane.read(obj) for obj in objects]
        told: list[str] = []
        return Job(lambda _: self._write(planes, told), summary=lambda _: "; ".join(told))

    def _write(self, planes: list[ImagePlane], told: list[str]) -> Generator[float, None, None]:
        found = yield from cuts(planes, self.settings())
        told.append(self.finish(bpy.context, found))

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        self.draw_settings(column)


def _settings_of(operator: FromFiles) -> dict[str, Any]:
    """All that can be seen in the panel."""
    names = (item.identifier for item in operator.properties.rna_type.properties if not item.is_hidden)
    return {name: getattr(operator, name) for name in names if name != "rna_type"}


def _mode_refusal(context: bpy.types.Context) -> str | None:
    return (
        None if context.mode == "OBJECT" else "Cutouts are made in Object Mode: leave the current mode first"
    )


def _plane_refusal(obj: bpy.types.Object) -> str | None:
    """At first sight, for polls."""
    reason = image_plane.refusal(obj)
    if reason is None and (pin_list.has_pins(obj) or obj.data.shape_keys is not None or obj.vertex_groups):
        return (
            f"'{obj.name}' has pins, shape keys or vertex groups: use Object > Planar > Cutout > Remesh "
            "Cutout, which keeps them"
        )
    return reason


class PLANAR_FH_cutout(bpy.types.FileHandler):
    bl_idname = "PLANAR_FH_cutout"
    bl_label = "Cutout from Image"
    bl_import_operator = "planar.cutout_from_image"
    bl_file_extensions = ";".join(sorted(bpy.path.extensions_image))

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        return context.area is not None and context.area.type == "VIEW_3D" and context.mode == "OBJECT"


CLASSES: tuple[Any, ...] = (
    PLANAR_OT_cutout_from_image,
    PLANAR_OT_choose_images,
    PLANAR_OT_make_cutout,
    PLANAR_FH_cutout,
)
