# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding, selecting, switching and removing pins."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatVectorProperty, IntProperty, StringProperty

from ..errors import Refusal
from ..scene.lattice.posed import PosedObject, begin_posing, posing_refusal
from ..scene.lattice.posed_lattice import PosedLattice
from ..scene.pin_properties import KINDS
from ..scene.pins import followed_mesh, pin_list
from ..scene.pins.taking_part import control_in_hand, with_pins
from ..scene.storage import migration, redraw
from ..scene.view.mouse import hidden_refusal
from .modal import running
from .modal.pin_selection import select_only
from .posing_operator import PinPosingOperator, Refusing

# Farther than this share of the diagonal from the mesh, a place is not on it.
ON_MESH = 0.01


class PinOperator(PinPosingOperator):
    """Changes the pins of what can be posed."""

    def apply(self, context: bpy.types.Context) -> None:
        drawing = begin_posing(context)
        pin_list.sync(context.object)
        self.change(context.object, drawing)

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        """Change the pins, in a subclass. Raises Refusal, with nothing changed."""
        raise NotImplementedError


class PLANAR_OT_add_pin(PinOperator, bpy.types.Operator):
    bl_idname = "planar.add_pin"
    bl_label = "Add Pin"
    bl_description = "Add a point pin at a place on the mesh, or on a point of the lattice"

    location: FloatVectorProperty(
        name="Location", description="World position of the pin", subtype="TRANSLATION", unit="LENGTH"
    )
    lattice_point: IntProperty(
        name="Lattice Point",
        description="Number of the lattice's point to pin, instead of a place on a mesh; none if negative",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )
    extend: BoolProperty(
        name="Extend", description="Keep the selected pins selected", default=False, options={"SKIP_SAVE"}
    )

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        if self.lattice_point >= 0:
            if not isinstance(drawing, PosedLattice):
                raise Refusal(f"'{obj.name}' is no lattice, whose points could be pinned")
            count = len(obj.data.points)
            if self.lattice_point >= count:
                raise Refusal(f"There is no point {self.lattice_point}: the lattice has {count}")
            pin = pin_list.add_on_lattice_point(obj, self.lattice_point)
        else:
            place = np.array(self.location, dtype=np.float64)
            point = drawing.nearest(place, ON_MESH * drawing.cutout.diagonal)
            if point is None:
                raise Refusal("No mesh there: add the pin at a point of the drawing")
            pin_list.check_groups_of(drawing.vertices_held(drawing.cutout.triangles[point.triangle])[0])
            pin = pin_list.add_at(obj, drawing, point)
        if not self.extend:
            for other in with_pins(bpy.context):
                select_only(other, set())
        pin.select = True


class PLANAR_OT_add_pins_from_selected(PinOperator, bpy.types.Operator):
    bl_idname = "planar.add_pins_from_selected"
    bl_label = "Add Pins from Selected"
    bl_description = (
        "Add pins on the vertices selected in Edit Mode: a point pin on each, or one patch pin on all. Of a "
        "lattice, on its selected points"
    )

    kind: EnumProperty(name="Kind", description="Kind of the new pins", items=KINDS)

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        first = len(obj.planar.pins)
        if isinstance(drawing, PosedLattice):
            chosen = {index for index, point in enumerate(obj.data.points) if point.select}
            if not chosen:
                raise Refusal("No points of the lattice are selected: select some in Edit Mode first")
            for index in sorted(chosen):
                pin_list.add_on_lattice_point(obj, index)
            pins = enumerate(obj.planar.pins)
            select_only(obj, {key for key, pin in pins if pin.lattice_point in chosen})
            return
        selected = np.empty(len(obj.data.vertices), bool)
        obj.data.vertices.foreach_get("select", selected)
        on_faces = drawing.vertex_indices[selected[drawing.vertex_indices]].tolist()
        if not on_faces:
            raise Refusal("No vertices of faces are selected: select some in Edit Mode first")
        new = [on_faces] if self.kind == "PATCH" else [[vertex] for vertex in on_faces]
        for vertices in new:
            pin_list.add_on_vertices(obj, vertices, self.kind)
        select_only(obj, set(range(first, len(obj.planar.pins))))


class PLANAR_OT_add_pin_from_group(PinOperator, bpy.types.Operator):
    bl_idname = "planar.add_pin_from_group"
    bl_label = "Add Pin from Vertex Group"
    bl_description = "Add a pin on a vertex group, the active one unless another is named"

    object: StringProperty(
        name="Object",
        description="Whose group it is, of all that a lattice deforms; empty for the only one that has it",
    )
    group: StringProperty(name="Vertex Group", description="Group to pin; empty for the active one")
    kind: EnumProperty(name="Kind", description="Kind of the new pin", items=KINDS)

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        objects = [other for other in drawing.meshes if self.object in {"", other.name}]
        if not objects:
            raise Refusal(f"'{self.object}' is not deformed by '{obj.name}': choose an object that is")
        named, active = self.group, [other.vertex_groups.active for other in objects]
        groups = [other.vertex_groups.get(named) for other in objects] if named else active
        found = [group for group in groups if group is not None]
        if not found:
            wanted = f"No vertex group '{named}'" if named else "No active vertex group"
            raise Refusal(f"{wanted}: make one in the Vertex Groups panel")
        if len(found) > 1:
            raise Refusal("Several objects have such a group: name the object as well")
        if pin_list.is_pinned(obj, found[0]):
            raise Refusal(f"Vertex group '{found[0].name}' has a pin already: choose another group")
        pin_list.add_on_group(obj, found[0], self.kind)
        select_only(obj, {len(obj.planar.pins) - 1})


class PLANAR_OT_add_pins_from_all_groups(PinOperator, bpy.types.Operator):
    bl_idname = "planar.add_pins_from_all_groups"
    bl_label = "Add Pins from All Groups"
    bl_description = "Add a pin on every vertex group that has none"

    kind: EnumProperty(name="Kind", description="Kind of the new pins", items=KINDS)

    def change(self, obj: bpy.types.Object, drawing: PosedObject) -> None:
        new = [
            group
            for other in drawing.meshes
            for group in other.vertex_groups
            if group.name not in {other.planar.stiffness_group, *followed_mesh.places_of(other)}
            if not pin_list.is_pinned(obj, group)
        ]
        if not new:
            raise Refusal("Every vertex group has a pin already: add groups in the Vertex Groups panel first")
        first = len(obj.planar.pins)
        for group in new:
            pin_list.add_on_group(obj, group, self.kind)
        select_only(obj, set(range(first, len(obj.planar.pins))))


class NotHidden:
    """Refused to the mouse and to keys where the view at hand does not show the pins. Scripts may do it."""

    report: Callable[[set[str], str], None]  # of Blender's operators
    execute: Callable[[bpy.types.Context], set[str]]

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        reason = hidden_refusal(context)
        if reason is None:
            return self.execute(context)
        self.report({"WARNING"}, reason)
        return {"CANCELLED"}


class PinListOperator(NotHidden, Refusing):
    """Works on the pin lists alone, of all that take part, though they may not be fit for posing now."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return None if _with_lists(context) else _list_refusal(context.object)

    @staticmethod
    def pins(context: bpy.types.Context) -> list[bpy.types.PropertyGroup]:
        """All pins of the lists."""
        return [pin for obj in _with_lists(context) for pin in obj.planar.pins]


class PinListChange(PinListOperator):
    """Done at once, and seen: Blender draws nothing anew for what a script sets of pins."""

    def execute(self, context: bpy.types.Context) -> set[str]:
        result = self.change(context)
        redraw.views()
        return result

    def change(self, context: bpy.types.Context) -> set[str]:
        """Change the lists, in a subclass; the operator's result."""
        raise NotImplementedError


class PLANAR_OT_remove_pins(NotHidden, bpy.types.Operator):
    """Has no poll: in the Pose tool, X must never go on to Blender's own, which deletes the object."""

    bl_idname = "planar.remove_pins"
    bl_label = "Remove Pins"
    bl_description = "Remove the selected pins; the drawing stays as it is"
    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return {"PASS_THROUGH"} if control_in_hand(context) is not None else super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        objects = _with_lists(context)
        if not objects:
            self.report({"WARNING"}, _list_refusal(context.object) or "No pins: add some first")
            return {"CANCELLED"}
        selected = {
            obj: [index for index, pin in enumerate(obj.planar.pins) if pin.select] for obj in objects
        }
        if not any(selected.values()):
            self.report({"WARNING"}, "No pins are selected: click one first")
            return {"CANCELLED"}
        for obj, pins in selected.items():
            if pins:
                pin_list.remove(obj, pins)
        return {"FINISHED"}


class PLANAR_OT_select_pins(PinListChange, bpy.types.Operator):
    bl_idname = "planar.select_pins"
    bl_label = "Select Pins"
    bl_description = "Select or deselect pins"

    action: EnumProperty(
        name="Action",
        description="What to do with the selection",
        items=(
            ("SELECT", "Select", "Select one pin"),
            ("DESELECT", "Deselect", "Deselect one pin"),
            ("TOGGLE", "Toggle", "Select one pin, or deselect it if it is selected"),
            ("ALL", "All", "Select all pins"),
            ("NONE", "None", "Deselect all pins"),
            ("INVERT", "Invert", "Select those that are not selected"),
        ),
    )
    pin: IntProperty(
        name="Pin",
        description="Index of the one pin, of the active object; the active one if negative",
        default=-1,
        min=-1,
    )
    extend: BoolProperty(name="Extend", description="Keep the other pins as they are", default=False)

    def change(self, context: bpy.types.Context) -> set[str]:
        if self.action in {"ALL", "NONE", "INVERT"}:
            for pin in self.pins(context):
                pin.select = {"ALL": True, "NONE": False, "INVERT": not pin.select}[self.action]
            return {"FINISHED"}
        settings = context.object.planar
        one = settings.active_pin if self.pin < 0 else self.pin
        if one >= len(settings.pins):
            self.report({"ERROR"}, f"There is no pin {one}: the object has {len(settings.pins)}")
            return {"CANCELLED"}
        on = self.action == "SELECT" or (self.action == "TOGGLE" and not settings.pins[one].select)
        if not self.extend:
            for pin in self.pins(context):
                pin.select = False
        settings.pins[one].select = on
        settings.active_pin = one
        return {"FINISHED"}


class PLANAR_OT_set_pin_kind(PinListChange, bpy.types.Operator):
    bl_idname = "planar.set_pin_kind"
    bl_label = "Set Pin Kind"
    bl_description = "Make the selected pins point or patch pins"

    kind: EnumProperty(name="Kind", description="How the pins hold the drawing", items=KINDS)

    def change(self, context: bpy.types.Context) -> set[str]:
        pins = [pin for pin in self.pins(context) if pin.select and pin.lattice_point < 0]
        pins = [pin for pin in pins if not pin_list.is_joint(pin)]
        changed = [pin for pin in pins if pin.kind != self.kind]
        if not changed:
            self.report({"WARNING"}, "No selected pin is of another kind: select some first")
            return {"CANCELLED"}
        for pin in changed:
            pin.kind = self.kind
        return {"FINISHED"}


class PLANAR_OT_disable_pins(PinListChange, bpy.types.Operator):
    bl_idname = "planar.disable_pins"
    bl_label = "Disable Pins"
    bl_description = "Switch the selected pins off: they go where the drawing takes them"

    def change(self, context: bpy.types.Context) -> set[str]:
        changed = [pin for pin in self.pins(context) if pin.select and pin.enabled]
        if not changed:
            self.report({"WARNING"}, "No selected pin is on: click one first")
            return {"CANCELLED"}
        for pin in changed:
            pin.enabled = False
        return {"FINISHED"}


class PLANAR_OT_enable_pins(PinListChange, bpy.types.Operator):
    bl_idname = "planar.enable_pins"
    bl_label = "Enable All Pins"
    bl_description = "Switch all pins on that are off: they hold the drawing where it is"

    def change(self, context: bpy.types.Context) -> set[str]:
        changed = [pin for pin in self.pins(context) if not pin.enabled]
        if not changed:
            self.report({"INFO"}, "All pins are on")
            return {"CANCELLED"}
        for pin in changed:
            pin.enabled = True
        return {"FINISHED"}


def _list_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why the pin list of an object cannot be changed, and what to do; None if it can."""
    if obj is None or not pin_list.has_pins(obj):
        return "No pins: add some first"
    local = obj.library is None and obj.data.library is None and obj.override_library is None
    fit = local and obj.mode == "OBJECT" and not migration.is_newer(obj)
    return None if fit else posing_refusal(obj)


def _with_lists(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The objects whose pins can be changed."""
    return [obj for obj in with_pins(context) if _list_refusal(obj) is None]


CLASSES = (
    PLANAR_OT_add_pin,
    PLANAR_OT_add_pins_from_selected,
    PLANAR_OT_add_pin_from_group,
    PLANAR_OT_add_pins_from_all_groups,
    PLANAR_OT_remove_pins,
    PLANAR_OT_select_pins,
    PLANAR_OT_set_pin_kind,
    PLANAR_OT_disable_pins,
    PLANAR_OT_enable_pins,
)
