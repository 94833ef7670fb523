# SPDX-License-Identifier: GPL-3.0-or-later
"""All that the add-on does, in the 3D view's Object menu: with any tool, and found by Menu Search (F3)."""

from __future__ import annotations

import bpy

from ..scene.motion.bake import FORMS
from ..scene.motion.bake_pins import FORMS as PIN_FORMS
from .tool.pin_menu import draw_carrying, draw_depths


class PlanarMenu:
    """A menu whose operators ask for the mouse where they need it, as those of Blender's own menus."""

    layout: bpy.types.UILayout  # of Blender's menus

    @property
    def column(self) -> bpy.types.UILayout:
        self.layout.operator_context = "INVOKE_REGION_WIN"
        return self.layout


class PLANAR_MT_cutout(PlanarMenu, bpy.types.Menu):
    bl_label = "Cutout"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.cutout_from_image", icon="IMAGE_DATA")
        column.operator("planar.make_cutout", icon="OUTLINER_OB_IMAGE")
        column.operator("planar.remesh", icon="MOD_REMESH")
        again = column.operator("planar.remesh", text="Reload and Remesh", icon="FILE_REFRESH")
        again.reload = True


class PLANAR_MT_pins(PlanarMenu, bpy.types.Menu):
    bl_label = "Pins"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        place = column.operator("planar.add_pin", text="Add Pin at 3D Cursor", icon="ADD")
        place.location = context.scene.cursor.location
        column.menu("PLANAR_MT_add_pins", text="Add Pins")
        column.separator()
        column.operator("planar.attach", icon="LINKED")
        joint = column.operator("planar.add_joint", text="Add Joint at 3D Cursor")
        joint.location = context.scene.cursor.location
        column.operator("planar.set_weld_radius")
        column.operator("planar.detach", icon="UNLINKED")
        draw_carrying(column)
        column.separator()
        column.operator("planar.drag_pins")
        column.operator("planar.rotate_pins")
        column.operator("planar.spread_pins")
        column.separator()
        for action, name in (
            ("ALL", "Select All Pins"),
            ("NONE", "Deselect Pins"),
            ("INVERT", "Invert Pins"),
        ):
            column.operator("planar.select_pins", text=name).action = action
        column.operator("planar.box_select_pins")
        column.separator()
        column.operator("planar.set_pin_kind", text="Make Selected Pins Points").kind = "POINT"
        column.operator("planar.set_pin_kind", text="Make Selected Pins Patches").kind = "PATCH"
        column.operator("planar.set_pin_radius")
        column.operator("planar.set_depth")
        draw_depths(column)
        column.operator("planar.dither_materials", icon="MATERIAL")
        column.separator()
        column.operator("planar.disable_pins", icon="UNPINNED")
        column.operator("planar.enable_pins", icon="PINNED")
        column.operator("planar.remove_pins", icon="X")


class PLANAR_MT_posing(PlanarMenu, bpy.types.Menu):
    bl_label = "Posing"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.settle_pose")
        column.operator("planar.reset_selected_pins")
        column.operator("planar.reset_to_rest")
        column.operator("planar.set_rest_to_current")
        column.separator()
        column.operator("planar.copy_pose", icon="COPYDOWN")
        column.operator("planar.paste_pose", icon="PASTEDOWN")
        column.operator("planar.mirror_pose", icon="MOD_MIRROR")
        column.separator()
        column.operator("planar.paint_stiffness", icon="BRUSH_DATA")
        column.operator("planar.refine_mesh", icon="MOD_SUBSURF")


class PLANAR_MT_follow(PlanarMenu, bpy.types.Menu):
    bl_label = "Follow"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.add_controls", icon="EMPTY_DATA")
        column.operator("planar.follow_bones", icon="BONE_DATA")
        column.separator()
        column.operator("planar.follow_now", icon="TRACKER")
        column.operator("planar.set_follow_offset")
        column.operator("planar.clear_follow_offset")
        column.separator()
        for form, name, _ in PIN_FORMS:
            column.operator("planar.bake_pins", text=f"Bake Pins to {name}").to = form


class PLANAR_MT_poses(PlanarMenu, bpy.types.Menu):
    bl_label = "Poses"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.key_pose", icon="KEY_HLT")
        column.operator("planar.record_pins", icon="REC")
        column.operator("planar.breakdown", icon="ARROW_LEFTRIGHT")
        column.separator()
        column.operator("planar.jump_to_pose", icon="EYEDROPPER")
        column.operator("planar.update_pose", icon="FILE_REFRESH")
        column.operator("planar.duplicate_pose", icon="DUPLICATE")
        column.operator("planar.retime_pose", icon="TIME")
        column.operator("planar.delete_pose", icon="REMOVE")
        column.separator()
        for step, name in ((1, "Step on Ones"), (2, "Step on Twos"), (3, "Step on Threes")):
            column.operator("planar.step_poses", text=name).step = step
        column.separator()
        column.operator("planar.clear_poses", icon="TRASH")


class PLANAR_MT_motion(PlanarMenu, bpy.types.Menu):
    bl_label = "In-Betweens and Motion"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.generate_inbetweens", icon="IPO_EASE_IN_OUT")
        column.operator("planar.remove_inbetweens", icon="X")
        column.operator("planar.add_pin_path", icon="CURVE_PATH")
        column.operator("planar.remove_pin_path", icon="REMOVE")
        column.separator()
        column.operator("planar.transfer_motion", icon="MOD_DATA_TRANSFER")
        column.operator("planar.edit_sequence", icon="SMOOTHCURVE")
        column.operator("planar.thin_poses", icon="MOD_DECIM")
        column.separator()
        for form, name, _ in FORMS:
            column.operator("planar.bake", text=f"Bake to {name}").to = form


class PLANAR_MT_lattice(PlanarMenu, bpy.types.Menu):
    bl_label = "Lattice"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.fit_lattice", icon="LATTICE_DATA")
        column.operator("planar.select_lattice", icon="RESTRICT_SELECT_OFF")
        column.operator("planar.add_to_lattice", icon="ADD")
        column.operator("planar.apply_lattice", icon="CHECKMARK")


class PLANAR_MT_flatten(PlanarMenu, bpy.types.Menu):
    bl_label = "Flatten"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.column
        column.operator("planar.flatten", icon="MOD_UVPROJECT")
        column.operator("planar.push_to_uv_map", icon="UV")
        column.operator("planar.refresh_from_surface", icon="FILE_REFRESH")
        column.operator("planar.export_pattern", icon="EXPORT")


MENUS = (
    PLANAR_MT_cutout,
    PLANAR_MT_pins,
    PLANAR_MT_posing,
    PLANAR_MT_follow,
    PLANAR_MT_poses,
    PLANAR_MT_motion,
    PLANAR_MT_lattice,
    PLANAR_MT_flatten,
)


class PLANAR_MT_object(PlanarMenu, bpy.types.Menu):
    bl_label = "Planar"

    def draw(self, context: bpy.types.Context) -> None:
        for menu in MENUS:
            self.column.menu(menu.__name__)


def _entry(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.menu(PLANAR_MT_object.__name__)


def _uv_entry(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator_context = "INVOKE_REGION_WIN"
    menu.layout.operator("planar.flatten").to = "UV"


def _image_entry(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.operator_context = "INVOKE_REGION_WIN"
    menu.layout.operator("planar.cutout_from_image", icon="IMAGE_DATA")


CLASSES = (*MENUS, PLANAR_MT_object)

# Blender's menus, with what is put into them.
ENTRIES = (
    ("VIEW3D_MT_object", _entry),
    ("VIEW3D_MT_image_add", _image_entry),
    ("TOPBAR_MT_file_import", _image_entry),
    ("VIEW3D_MT_uv_map", _uv_entry),
    ("IMAGE_MT_uvs", _uv_entry),
)


def register() -> None:
    """Adds the entries to Blender's menus."""
    for menu, entry in ENTRIES:
        getattr(bpy.types, menu).append(entry)


def unregister() -> None:
    """Takes them away."""
    for menu, entry in ENTRIES:
        getattr(bpy.types, menu).remove(entry)
