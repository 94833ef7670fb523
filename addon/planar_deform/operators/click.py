# SPDX-License-Identifier: GPL-3.0-or-later
"""Clicks of the Pose tool that no gizmo takes."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty
from mathutils import Vector

from ..errors import Refusal
from ..model.plane.frame import Array
from ..model.plane.locate import MeshPoint
from ..scene.lattice.posed import PosedObject, begin_posing, posing_refusal
from ..scene.lattice.posed_lattice import PosedLattice
from ..scene.objects.cutout_object import pose_refusal, read_cutout
from ..scene.objects.modifiers import of_lattice
from ..scene.pins.taking_part import control_in_hand, taking_part, with_pins
from ..scene.storage import redraw
from ..scene.telling import said, say
from ..scene.view import snapshot
from ..scene.view.mouse import (
    hidden_refusal,
    nearest_within,
    on_ring,
    pin_at,
    pin_under,
    ray,
    refuse_hidden,
    ring_about,
)
from .modal.pin_selection import select_only
from .modal.session import PASSED_ON, is_dragged
from .posing_operator import Refusing

ADD = "Ctrl-click the drawing to add one"
MENU = "PLANAR_MT_pin_context"
DRAWING_MENU = "PLANAR_MT_drawing_context"
ON_LATTICE_POINT = 8.0  # pixels at a UI scale of 1, within which a click is on a point of the lattice


class PLANAR_OT_click(bpy.types.Operator):
    bl_idname = "planar.click"
    bl_label = "Click in the Pose Tool"
    bl_description = "Make the mesh under the mouse active, deselect all pins, or add a pin"
    # No undo step of its own: what it does has one, under its own name.
    bl_options = {"INTERNAL"}

    add: BoolProperty(name="Add", description="Add a pin under the mouse", options={"SKIP_SAVE"})
    add_joint: BoolProperty(
        name="Add Joint", description="Add a joint under the mouse", options={"SKIP_SAVE"}
    )
    extend: BoolProperty(name="Extend", description="Keep what is selected", options={"SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        region, view = context.region, context.region_data
        if view is None:
            return {"PASS_THROUGH"}
        mouse = (event.mouse_region_x, event.mouse_region_y)
        if self.add_joint:
            return {"FINISHED"} if add_joint_under(self, context, event) else {"CANCELLED"}
        shown = snapshot.pins_in_view(context)
        # No gizmo has lit up where the event that ended a drag's settling comes right here.
        pin = pin_under(region, view, shown, mouse)
        if pin is not None:
            bpy.ops.planar.drag_pins("INVOKE_DEFAULT", True, pin=pin.key, object=pin.owner)
            return {"FINISHED"}
        ring = ring_about(shown)
        if ring is not None and on_ring(region, view, ring, mouse):
            if self.add and ring.only is not None and ring.only.owner == context.object.name:
                bpy.ops.planar.set_pin_radius("INVOKE_DEFAULT", True, release_confirm=True)
                return {"FINISHED"}
            if ring.turns:
                bpy.ops.planar.rotate_pins("INVOKE_DEFAULT", True, release_confirm=True)
                return {"FINISHED"}
        if self.add:
            return {"FINISHED"} if add_pin_under(self, context, event) else {"CANCELLED"}
        other = _object_under(context, *ray(region, view, mouse))
        if other is not None and other != context.object and not _belongs_to(other, context.object):
            return self._activate(context, other)
        if not self.extend and any(pin.select for place in shown if (pin := pin_at(place)) is not None):
            bpy.ops.planar.select_pins("EXEC_DEFAULT", True, action="NONE")
        self._press = event.mouse_x, event.mouse_y
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Until the button is released: whoever drags nothing is told so, until the next thing is done."""
        if said():
            if event.type.startswith(PASSED_ON) or event.value != "PRESS":
                return {"PASS_THROUGH"}
            say("")
            return {"FINISHED", "PASS_THROUGH"}
        if event.type == "LEFTMOUSE":
            return {"FINISHED"}
        if event.type.startswith(PASSED_ON) or event.value != "PRESS":
            if is_dragged(context, event, self._press):
                say(self._missed(context))
            return {"PASS_THROUGH"}
        return {"FINISHED", "PASS_THROUGH"}

    def cancel(self, _context: bpy.types.Context) -> None:
        """Another file is loaded."""
        say("")

    def _missed(self, context: bpy.types.Context) -> str:
        """Why no pin has been dragged."""
        if not with_pins(context):
            return f"There is no pin under the mouse: {ADD}"
        seen = snapshot.in_view(context)
        reason = hidden_refusal(context) if seen is None else seen.refusal
        return reason or "There is no pin under the mouse: drag one, or press B to select by a box"

    def _activate(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        takes_part = obj in taking_part(context).objects
        if not self.extend and takes_part:
            for one in with_pins(context):
                select_only(one, set())
        elif not self.extend:
            for selected in context.selected_objects:
                selected.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        bpy.ops.ed.undo_push(message="Select")
        return {"FINISHED"}


def add_pin_under(operator: bpy.types.Operator, context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Add a pin under the mouse, in an undo step of its own; reports why it cannot.

    To the active object, and where that is not under the mouse, to the next selected one that is: it becomes
    the active one.
    """
    mouse = event.mouse_region_x, event.mouse_region_y
    try:
        refuse_hidden(context)
        drawing = begin_posing(context)
        under = ray(context.region, context.region_data, mouse)
        point = drawing.pick(*under)
        # Points of a lattice are everywhere before what it deforms: pins on that are what is wanted there.
        if isinstance(drawing, PosedLattice) and point is None:
            numbers, places = drawing.lattice_points
            nearest = nearest_within(context.region, context.region_data, places, mouse, ON_LATTICE_POINT)
            if nearest is not None:
                bpy.ops.planar.add_pin("EXEC_DEFAULT", True, lattice_point=int(numbers[nearest]))
                return True
        if point is None:
            drawing, point = _selected_under(context, *under)
    except Refusal as refusal:
        operator.report({"WARNING"}, str(refusal))
        return False
    context.view_layer.objects.active = drawing.resolve()
    bpy.ops.planar.add_pin("EXEC_DEFAULT", True, location=_place_of(drawing, point))
    return True


def _selected_under(
    context: bpy.types.Context, start: Array, towards: Array
) -> tuple[PosedObject, MeshPoint]:
    """The first selected drawing beside the active one that a ray meets, and where. Raises Refusal."""
    met = _object_under(context, start, towards)
    others = [obj for obj in context.selected_objects if obj not in {context.object, met}]
    if met is not None and met.select_get() and met != context.object:
        others.insert(0, met)
    for obj in others:
        if posing_refusal(obj) is None and obj.visible_get():
            drawing = begin_posing(context, obj)
            point = drawing.pick(start, towards)
            if point is not None:
                return drawing, point
    raise Refusal(_missed(begin_posing(context)))


def add_joint_under(operator: bpy.types.Operator, context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Add a joint under the mouse to the active object, in an undo step of its own; reports why it cannot."""
    mouse = event.mouse_region_x, event.mouse_region_y
    try:
        refuse_hidden(context)
        reason = pose_refusal(context.object)
        if reason is not None:
            raise Refusal(reason)
        drawing = begin_posing(context)
        point = drawing.pick(*ray(context.region, context.region_data, mouse))
        if point is None:
            raise Refusal(_missed(drawing))
        bpy.ops.planar.add_joint("EXEC_DEFAULT", True, location=_place_of(drawing, point))
    except (Refusal, RuntimeError) as refusal:  # the operator's own come with what kind of report they are
        operator.report({"WARNING"}, str(refusal).removeprefix("Error: ").strip())
        return False
    return True


def _place_of(drawing: PosedObject, point: MeshPoint) -> list[float]:
    """Where a point of the shown mesh is in the world."""
    corners = drawing.cutout.triangles[point.triangle]
    place = point.weights[None, :] @ drawing.positions[corners]
    found: list[float] = drawing.to_world(place, drawing.cutout.parts[corners[:1]])[0].tolist()
    return found


def _belongs_to(obj: bpy.types.Object, active: bpy.types.Object | None) -> bool:
    """Whether an object is deformed by a lattice that is posed, to which it belongs in the Pose tool then."""
    return active is not None and bool(of_lattice(obj, active))


def _missed(drawing: PosedObject) -> str:
    """Why there is nothing to pin under the mouse."""
    if isinstance(drawing, PosedLattice):
        return f"Nothing that '{drawing.object_name}' deforms is under the mouse, and none of its points"
    return f"'{drawing.object_name}' is not under the mouse: click a layer to make it active"


class PLANAR_OT_pin_menu(bpy.types.Operator):
    bl_idname = "planar.pin_menu"
    bl_label = "Drawing Context Menu"
    bl_description = (
        "Open the menu of the pin under the mouse, and of the others selected with it, or of the drawing"
    )
    bl_options = {"INTERNAL"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.region_data is None:
            return {"PASS_THROUGH"}
        mouse = event.mouse_region_x, event.mouse_region_y
        places = snapshot.pins_in_view(context)
        if not places and with_pins(context):
            return {"PASS_THROUGH"}
        place = pin_under(context.region, context.region_data, places, mouse)
        pin = None if place is None else pin_at(place)
        if place is None or pin is None:
            return self._of_drawing(context, mouse)
        context.view_layer.objects.active = pin.id_data
        if not pin.select:
            bpy.ops.planar.select_pins("EXEC_DEFAULT", True, action="SELECT", pin=place.key)
        else:
            pin.id_data.planar.active_pin = place.key
            redraw.views()
        bpy.ops.wm.call_menu(name=MENU)
        return {"FINISHED"}

    def _of_drawing(self, context: bpy.types.Context, mouse: tuple[int, int]) -> set[str]:
        """Beside all pins: of the drawing if the mouse is on it, else Blender's menu of the object."""
        under = _object_under(context, *ray(context.region, context.region_data, mouse))
        if under is None or under != context.object:
            return {"PASS_THROUGH"}
        try:
            read_cutout(under)
        except Refusal:
            return {"PASS_THROUGH"}
        bpy.ops.wm.call_menu(name=DRAWING_MENU)
        return {"FINISHED"}


class PLANAR_OT_guard_key(bpy.types.Operator):
    """Stands in the tool's keymap beside an operator whose poll would otherwise let the key through.

    Before it or behind, as Blender orders the two.
    """

    bl_idname = "planar.guard_key"
    bl_label = "Guard Key"
    bl_description = "Say why the operator of a key cannot be used, and keep the key from Blender's own"
    bl_options = {"INTERNAL"}

    operator: StringProperty(name="Operator", description="Name of the operator, without 'planar.'")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        guarded: type[Refusing] = getattr(bpy.types, f"PLANAR_OT_{self.operator}")
        reason = guarded.refusal(context)
        if reason is None or control_in_hand(context) is not None:
            return {"PASS_THROUGH"}  # to the operator, or to Blender's own
        self.report({"WARNING"}, reason)
        return {"CANCELLED"}


def _object_under(context: bpy.types.Context, start: Array, towards: Array) -> bpy.types.Object | None:
    """The first selectable object that a ray meets."""
    origin, direction = Vector(start), Vector(towards)
    depsgraph = context.evaluated_depsgraph_get()
    for _ in context.scene.objects:
        hit, place, _normal, _index, obj, _matrix = context.scene.ray_cast(depsgraph, origin, direction)
        if not hit:
            return None
        if not obj.original.hide_select and obj.original.visible_get(viewport=context.space_data):
            return obj.original
        origin = place + direction * 1e-4
    return None


CLASSES = (PLANAR_OT_click, PLANAR_OT_pin_menu, PLANAR_OT_guard_key)
