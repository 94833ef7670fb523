# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices: put round objects, given to others, and made part of what they deform."""

from __future__ import annotations

from functools import partial

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    StringProperty,
)
from mathutils import Quaternion

from ..errors import Refusal
from ..model.lattice.fitting import MOST_AN_AXIS
from ..scene.lattice import applying, fitting
from ..scene.objects.adding import select_alone
from ..scene.objects.flat_object import data_refusal, make_current
from ..scene.objects.modifiers import lattices_of
from .posing_operator import PosingOperator

SPACES = (
    ("AUTO", "Automatic", "In the plane of flat drawings; a box round anything else"),
    ("PLANE", "Drawing", "One layer in the plane of the drawings"),
    ("BOX", "Box", "In space, along the active object's axes"),
    ("VIEW", "View", "One layer across the view: bends 3D models as a picture is bent"),
    ("CAMERA", "Camera", "One layer across the scene's camera"),
)
BASES = (
    ("KEY_LINEAR", "Linear", "Straight from point to point"),
    ("KEY_CARDINAL", "Cardinal", "Through the points; turning all of them is never exactly rigid"),
    ("KEY_CATMULL_ROM", "Catmull-Rom", "Through the points"),
    ("KEY_BSPLINE", "BSpline", "The smoothest"),
)
OTHERS = (
    ("REFUSE", "Refuse", "Fit none round what hangs in a lattice already"),
    ("REPLACE", "Replace", "It takes the place of the lattices that deform the objects already"),
    ("ADD", "Add", "It deforms the objects first, and the others what it has deformed"),
)


class PLANAR_OT_fit_lattice(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.fit_lattice"
    bl_label = "Fit Lattice"
    bl_description = (
        "Put a lattice round the selected meshes, ready to be posed: the layers of a character, or a model"
    )

    space: EnumProperty(name="Space", description="Where the lattice lies", items=SPACES)
    resolution: IntVectorProperty(
        name="Resolution",
        description="Points of a lattice of one layer",
        size=2,
        default=(14, 14),
        min=1,
        max=MOST_AN_AXIS,
    )
    resolution_in_space: IntVectorProperty(
        name="Resolution",
        description="Points of a lattice in space",
        size=3,
        default=(8, 8, 8),
        min=1,
        max=MOST_AN_AXIS,
    )
    basis: EnumProperty(
        name="Interpolation",
        description="How the points share the space between them",
        items=BASES,
        default="KEY_BSPLINE",
    )
    free: IntProperty(
        name="Free Cells",
        description=(
            "Cells outside of the objects on each side. With one, BSpline and Catmull-Rom turn them exactly "
            "when all points turn"
        ),
        default=1,
        min=0,
        max=8,
    )
    others: EnumProperty(
        name="Other Lattices",
        description="What becomes of lattices in which the objects hang already",
        items=OTHERS,
        options={"SKIP_SAVE"},
    )
    view: FloatVectorProperty(
        size=4, options={"HIDDEN", "SKIP_SAVE"}
    )  # how it was turned, for the redo panel

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        if context.mode != "OBJECT":
            return "Leave this mode first: lattices are fitted in Object Mode"
        return fitting.refusal(context.selected_objects)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.region_data is not None:
            self.view = context.region_data.view_rotation
        hanging = _hanging(context)
        if hanging is None or self.others != "REFUSE":
            return self.execute(context)
        context.window_manager.popup_menu(partial(_ask, *hanging), title="Fit Lattice", icon="LATTICE_DATA")
        return {"INTERFACE"}

    def apply(self, context: bpy.types.Context) -> None:
        make_current(context)
        objects = [obj for obj in context.selected_objects if obj.type == "MESH"]
        objects.sort(key=lambda obj: obj != context.object)  # its axes count
        hanging = _hanging(context)
        if hanging is not None and self.others == "REFUSE":
            obj, lattice = hanging
            raise Refusal(
                f"'{obj.name}' hangs in '{lattice.name}' already: pose it by that, make that a shape key by "
                "Apply Lattice, or choose whether the new one replaces it or is added"
            )
        flat = fitting.plane_of(objects) if self.space in {"AUTO", "PLANE"} else None
        if self.space == "AUTO":
            self.space = "BOX" if flat is None else "PLANE"
        counts = tuple(self.resolution_in_space if self.space == "BOX" else (*self.resolution, 1))
        turn = self._turn(context, objects[0], flat)
        anew = self.others == "REPLACE"
        left = fitting.fit(context, objects, turn, counts, self.basis, self.free, anew=anew)
        if left:
            names = ", ".join(f"'{lattice.name}'" for lattice in left)
            self.report({"INFO"}, f"{names} deforms nothing any more")

    def _turn(
        self, context: bpy.types.Context, first: bpy.types.Object, flat: Quaternion | None
    ) -> Quaternion:
        """How the lattice is turned. Raises Refusal."""
        if self.space == "BOX":
            return first.matrix_world.to_quaternion()
        if self.space == "VIEW":
            if not any(self.view):
                raise Refusal("There is no view here: run it with the mouse in a 3D view, or give `view`")
            return Quaternion(self.view).normalized()
        if self.space == "CAMERA":
            camera = context.scene.camera
            if camera is None:
                raise Refusal("The scene has no camera: add one, or choose another Space")
            return camera.matrix_world.to_quaternion()
        if flat is None:
            raise Refusal("The objects are not drawn in one plane: choose another Space")
        return flat

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "space")
        column.prop(self, "resolution_in_space" if self.space == "BOX" else "resolution")
        column.prop(self, "basis")
        column.prop(self, "free")
        if self.others != "REFUSE":
            column.prop(self, "others")


def _hanging(context: bpy.types.Context) -> tuple[bpy.types.Object, bpy.types.Object] | None:
    """One of the selected meshes that hangs in a lattice already, and that; None if none does."""
    for obj in context.selected_objects:
        if obj.type == "MESH" and (lattices := lattices_of(obj)):
            return obj, lattices[0]
    return None


def _ask(
    obj: bpy.types.Object, lattice: bpy.types.Object, menu: bpy.types.Menu, _context: bpy.types.Context
) -> None:
    """What is to be done with objects that hang in a lattice."""
    column = menu.layout.column()
    column.label(text=f"'{obj.name}' hangs in '{lattice.name}' already")
    column.separator()
    column.operator("planar.select_lattice", text=f"Pose '{lattice.name}'").lattice = lattice.name
    column.operator("planar.fit_lattice", text="Fit a New One in Its Place").others = "REPLACE"
    column.operator("planar.fit_lattice", text="Add Another One").others = "ADD"


class PLANAR_OT_select_lattice(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.select_lattice"
    bl_label = "Select Lattice"
    bl_description = (
        "Make the lattice active in which the active object hangs, to pose it by the lattice's pins"
    )

    lattice: StringProperty(
        name="Lattice", description="Its name; empty: the first one", options={"SKIP_SAVE"}
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        if context.object is None or not lattices_of(context.object):
            return "The active object hangs in no lattice: put one round it with Fit Lattice"
        return (
            None if context.mode == "OBJECT" else "Leave this mode first: lattices are posed in Object Mode"
        )

    def apply(self, context: bpy.types.Context) -> None:
        found = {lattice.name: lattice for lattice in lattices_of(context.object)}
        lattice = found.get(self.lattice or next(iter(found)))
        if lattice is None:
            raise Refusal(f"'{context.object.name}' does not hang in '{self.lattice}'")
        if not lattice.visible_get():
            raise Refusal(f"'{lattice.name}' is hidden: show it in the Outliner first")
        if lattice.hide_select:
            raise Refusal(f"'{lattice.name}' cannot be selected: allow that in the Outliner first")
        select_alone(context, lattice)


class LatticeOperator(PosingOperator):
    """Works on the active lattice."""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        if obj is None or obj.type != "LATTICE":
            return "The active object is no lattice: select one last"
        return data_refusal(obj, "OBJECT")


class PLANAR_OT_add_to_lattice(LatticeOperator, bpy.types.Operator):
    bl_idname = "planar.add_to_lattice"
    bl_label = "Add to Lattice"
    bl_description = (
        "Let the active lattice deform the other selected meshes, too, as it deforms its first one"
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = super().refusal(context)
        return reason or fitting.refusal([obj for obj in context.selected_objects if obj != context.object])

    def apply(self, context: bpy.types.Context) -> None:
        lattice = context.object
        inside = dict(fitting.modifiers_of(lattice))
        new = [obj for obj in context.selected_objects if obj.type == "MESH" and obj not in inside]
        if not new:
            raise Refusal(f"'{lattice.name}' deforms all of them already")
        like = next(iter(inside.items()), None)
        for obj in new:
            if like is None:
                fitting.add_modifier(obj, lattice)
            else:
                fitting.add_like(obj, *like)


class PLANAR_OT_apply_lattice(LatticeOperator, bpy.types.Operator):
    bl_idname = "planar.apply_lattice"
    bl_label = "Apply Lattice"
    bl_description = "Make what the active lattice does to its meshes a shape key of each of them"

    keep_modifiers: BoolProperty(
        name="Keep Modifiers", description="Hide the modifiers instead of removing them", default=False
    )

    def apply(self, context: bpy.types.Context) -> None:
        make_current(context)
        applied = applying.apply(context.object, keep_modifiers=self.keep_modifiers)
        names = ", ".join(obj.name for obj in applied)
        if len(context.object.planar.poses):
            frame = context.scene.frame_current
            text = f"A shape key on {names} as at frame {frame}: the keyed poses move them no more"
            self.report({"WARNING"}, text)
        else:
            self.report({"INFO"}, f"A shape key on {names}")


CLASSES = (PLANAR_OT_fit_lattice, PLANAR_OT_select_lattice, PLANAR_OT_add_to_lattice, PLANAR_OT_apply_lattice)
