# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving, turning and spreading pins: by mouse and keys, from a script, and again from the redo panel."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..errors import Refusal
from ..model.input.drag import Drag, Mode, Point
from ..model.plane.axes import plane_axes
from ..model.plane.frame import PlaneFrame
from ..model.posing.posing import Posing, Sample, carried_path
from ..model.posing.spreading import ScalingSpread, Spreading, carried_growth
from ..model.posing.together import SolvedTogether
from ..scene.pins.pin_list import is_joint
from ..scene.pins.taking_part import control_in_hand, with_pins
from ..scene.storage import redraw
from ..scene.view import pivot
from ..scene.view.mouse import refuse_hidden, towards
from .modal import reports, running
from .modal.plane_mouse import PlaneMouse
from .modal.session import CONFIRM, PASSED_ON, Interactive, Session, is_dragged
from .modal.several_posing import SeveralPosing, begin

HIDDEN = {"HIDDEN", "SKIP_SAVE"}

ORIENTATIONS = (
    ("GLOBAL", "Global", "The two of the world's axes that the plane is nearest to"),
    ("LOCAL", "Local", "The object's own axes"),
)


# What a script may give as a path. That of the mouse is kept beside the properties: Info shows all of these.
PATH = "Way of the pins: base64 of little-endian float32 triples, the offset and the turn from the start"


def pack_path(path: list[Sample]) -> str:
    """Samples as text for the property `path`, rounded to float32: the way that a script leads pins."""
    return base64.b64encode(np.array(path, "<f4").tobytes()).decode()


def unpack_path(text: str) -> list[Sample]:
    """The samples of a PATH. Raises Refusal if the text is anything else."""
    try:
        samples = np.frombuffer(base64.b64decode(text, validate=True), "<f4").reshape(-1, 3)
    except (binascii.Error, ValueError) as error:
        raise Refusal("The path is not base64 of float32 triples: leave it empty") from error
    if not np.isfinite(samples).all():
        raise Refusal("The path is not base64 of float32 triples: leave it empty")
    return [(float(du), float(dv), float(angle)) for du, dv, angle in samples]


class Recorded(NamedTuple):
    """The way that the mouse took, and those that the drawings went along it, by their objects' names."""

    path: list[Sample]
    ways: dict[str, list[Sample]]


class PinTransform(Interactive):
    """What moving, turning and spreading share. A subclass names its mode and keeps its result in properties.

    There is no poll, as the Pose tool's keys must not go on to Blender's own operators: refusals are reports.
    """

    bl_options = {"REGISTER", "UNDO", "GRAB_CURSOR"}
    mode: Mode
    model: type[Posing] = Posing

    pin: IntProperty(
        name="Pin",
        description="Pin that is pressed: it is selected first, unless it is already; none if negative",
        default=-1,
        min=-1,
        options=HIDDEN,
    )
    object: StringProperty(
        name="Object", description="Whose pin is pressed; empty: the active object's", options=HIDDEN
    )
    extend: BoolProperty(
        name="Extend", description="Keep the other pins selected when one is pressed", options=HIDDEN
    )
    release_confirm: BoolProperty(
        name="Confirm on Release", description="End when the mouse button is released", options=HIDDEN
    )
    facing: FloatVectorProperty(
        name="Facing",
        description=(
            "Direction in the world from which pins are seen, that move in space with a lattice: across it "
            "they are moved; zero: the lattice's own Z"
        ),
        options=HIDDEN,
    )
    path: StringProperty(name="Path", description=PATH, options=HIDDEN)
    _recorded: Recorded | None = None  # Blender repeats the operator with all it has

    def execute(self, context: bpy.types.Context) -> set[str]:
        running.end()
        try:
            mouse = self._recorded
            recorded = unpack_path(self.path) if mouse is None else mouse.path
            posing = self._begun(context)
            path = self.edited(recorded, posing.drawing.frame)
            same = path == recorded
            again = mouse is not None and same and [*mouse.ways] == posing.names
            ways = [*mouse.ways.values()] if mouse is not None and again else None
            reports.inform(self, posing.run(path, settle=not same, ways=ways))
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        return {"FINISHED"}

    def _begun(self, context: bpy.types.Context) -> SeveralPosing:
        return begin(
            context,
            self.pin,
            self.extend,
            of=self.object,
            pivot=self.given_pivot(),
            facing=self.facing,
            model=self.posing_model(),
        )

    def posing_model(self) -> type[Posing]:
        """What samples mean."""
        return self.model

    def given_pivot(self) -> Sequence[float] | None:
        """What to turn about, in the world; None: the centre of the pins."""
        return None

    def edited(self, path: list[Sample], frame: PlaneFrame) -> list[Sample]:
        """The recorded path, made to end as the properties say, in a subclass."""
        raise NotImplementedError

    def set_end(self, drag: Drag, sample: Sample) -> None:
        """Let the properties say that the path of a drag ends here, in a subclass."""
        raise NotImplementedError

    # ---- by mouse and keys

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.region_data is None:
            self.report({"ERROR"}, "Pins are dragged in a 3D view: move the mouse over one")
            return {"CANCELLED"}
        if control_in_hand(context) is not None:
            return {"PASS_THROUGH"}  # Blender's own moves the control
        running.end()
        pressed = self.pin >= 0
        self.extend = pressed and event.shift
        self.facing = towards(context.region_data)
        try:
            refuse_hidden(context, bpy.data.objects.get(self.object))
            self._posing = self._begun(context)
            self._mouse = PlaneMouse(self._posing, context.region, context.region_data, event)
            self._press: Point | None = (event.mouse_x, event.mouse_y) if pressed else None
            self._drag: Drag | None = None if pressed else self._mouse.begin(self.mode)
        except Refusal as refusal:
            self.report({"WARNING"}, str(refusal))
            return {"CANCELLED"}
        frame = self._posing.drawing.frame
        letters = plane_axes(frame, "GLOBAL").letters
        locks = f"   {' or '.join(letters)}: Lock Axis, Twice the Local One" if self.mode != "ROTATE" else ""
        self._session = Session(
            context,
            self._posing,
            "LMB or Enter: Confirm   Esc or RMB: Cancel   Shift: Precise   Ctrl: Snap"
            f"{locks}   Digits: Type the Value",
        )
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        pressed = event.value == "PRESS"
        if event.type in {"ESC", "RIGHTMOUSE"} and pressed:
            return self.stop()
        if event.type == "LEFTMOUSE" and pressed and event.alt:
            return {"PASS_THROUGH"}  # drives the view in some keymaps
        by_release = self.release_confirm or self._press is not None
        if event.type == "LEFTMOUSE" and (pressed or (event.value == "RELEASE" and by_release)):
            return self._confirm()
        if event.type in CONFIRM and pressed:
            return self._confirm()
        if event.type == "TIMER":
            self._session.tell_progress(context)
        if event.type.startswith(PASSED_ON):
            return {"PASS_THROUGH"}
        if self._drag is None and not self._dragged(context, event):
            return {"RUNNING_MODAL"}
        assert self._drag is not None  # it has begun by now
        drag = self._drag.held(shift=event.shift, ctrl=event.ctrl)
        if event.type == "MOUSEMOVE":
            drag = self._mouse.moved(context.region, context.region_data, event, drag)
        elif pressed and not (event.is_repeat and event.type in drag.letters):
            drag = drag.pressed(event.type) or drag
        if drag.sample != self._drag.sample:
            if drag.numeric.active or self._drag.numeric.active:
                # Not by way of each digit: a typed value gives the shape that a script gets with it.
                self.set_end(drag, drag.sample)
                self._session.retrace(self.edited([], self._posing.drawing.frame))
            else:
                self._session.ask(drag.sample)
        if drag.text != self._drag.text:
            self._session.say(context, drag.text)
        self._drag = drag
        return {"RUNNING_MODAL"}

    def _dragged(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """Whether a pressed pin is being dragged by now and not just clicked; starts the drag then."""
        assert self._press is not None  # or the drag would have begun at once
        if not is_dragged(context, event, self._press):
            return False
        self._drag = self._mouse.begin(self.mode)
        return True

    def _confirm(self) -> set[str]:
        if self._drag is None:
            changed = self._posing.click()
            self.leave()
            if changed:  # nothing was posed, so this is a step of its own, of another name
                redraw.views()  # lists and panels, too
                bpy.ops.ed.undo_push(message="Select Pins")
            return {"CANCELLED"}
        if self._session.untouched:
            return self.stop()
        return self.release()

    def keep_result(self, solved: SolvedTogether) -> None:
        assert self._drag is not None  # what it asked for has been solved
        ways = (one.path for one in solved.each)
        self._recorded = Recorded(solved.path, dict(zip(self._posing.names, ways, strict=True)))
        self.set_end(self._drag, solved.path[-1])


class AboutPivot(PinTransform):
    """What turning and spreading share."""

    properties: bpy.types.OperatorProperties  # of Blender's operators

    pivot: FloatVectorProperty(
        name="Pivot",
        description="World position that stays; by default the centre of the pins, or what Pivot Point says",
        subtype="XYZ",
        options=HIDDEN,
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        about = None if self.release_confirm else pivot.chosen(context)  # a ring is about the centre
        if about is not None and not self.properties.is_property_set("pivot"):
            self.pivot = about
        return super().invoke(context, event)

    def given_pivot(self) -> Sequence[float] | None:
        return self.pivot if self.properties.is_property_set("pivot") else None


class PLANAR_OT_drag_pins(PinTransform, bpy.types.Operator):
    bl_idname = "planar.drag_pins"
    bl_label = "Move Pins"
    bl_description = "Move the selected pins; the drawing follows"

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Names the pin under the mouse."""
        obj = bpy.data.objects.get(properties.object) or context.object
        pins = obj.planar.pins if obj is not None else ()
        if 0 <= properties.pin < len(pins):
            pin = pins[properties.pin]
            use = "click to select it" if is_joint(pin) else "drag to move it"
            return f"{pin.name}: {use}; Shift to select several pins"
        return cls.bl_description

    mode = "MOVE"
    offset: FloatVectorProperty(
        name="Offset",
        description="Offset of the pins along two axes in the drawing's plane, in world units",
        size=2,
        precision=4,
        options={"SKIP_SAVE"},
    )
    orientation: EnumProperty(
        name="Orientation",
        description="Whose axes the offset is along",
        items=ORIENTATIONS,
        default="LOCAL",
        options=HIDDEN,
    )
    letters: StringProperty(default="XY", options=HIDDEN)  # names of those axes, for the redo panel

    def edited(self, path: list[Sample], frame: PlaneFrame) -> list[Sample]:
        axes = plane_axes(frame, self.orientation)
        self.letters = "".join(axes.letters)
        if path:
            end = np.array(axes.values(path[-1][:2]), np.float32)
            if np.array_equal(end, np.array(self.offset, np.float32)):
                return path  # to the bit, which turning the offset back would not be
        return carried_path(path, offset=axes.offset(tuple(self.offset)))

    def set_end(self, drag: Drag, sample: Sample) -> None:
        self.orientation, self.letters = drag.orientation, "".join(drag.axes.letters)
        self.offset = drag.axes.values(sample[:2])

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.use_property_split = True
        for index, letter in enumerate(self.letters[:2]):
            text = f"{self.orientation.title()} {letter}" if index == 0 else letter
            column.prop(self, "offset", index=index, text=text)


class PLANAR_OT_rotate_pins(AboutPivot, bpy.types.Operator):
    bl_idname = "planar.rotate_pins"
    bl_label = "Turn Pins"
    bl_description = "Turn the selected pins about their centre or the Pivot Point, patches with the drawing"

    mode = "ROTATE"
    angle: FloatProperty(
        name="Angle",
        description="Turn of the pins, counter-clockwise in the drawing's plane",
        subtype="ANGLE",
        unit="ROTATION",
        options={"SKIP_SAVE"},
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        chosen = [obj for obj in with_pins(context) for pin in obj.planar.pins if pin.select]
        if self.release_confirm and event.ctrl and chosen == [context.object]:
            # The ring of one pin, which a gizmo gives to this operator whatever keys are held.
            bpy.ops.planar.set_pin_radius("INVOKE_DEFAULT", True, release_confirm=True)
            return {"CANCELLED"}
        return super().invoke(context, event)

    def edited(self, path: list[Sample], frame: PlaneFrame) -> list[Sample]:
        return carried_path(path, angle=self.angle)

    def set_end(self, drag: Drag, sample: Sample) -> None:
        self.angle = sample[2]

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.prop(self, "angle")


class PLANAR_OT_spread_pins(AboutPivot, bpy.types.Operator):
    bl_idname = "planar.spread_pins"
    bl_label = "Spread Pins"
    bl_description = (
        "Lead the selected pins away from their centre, or gather them there; a patch alone is scaled. The "
        "drawing follows"
    )

    mode = "SPREAD"
    model = Spreading
    factor: FloatProperty(
        name="Factor",
        description="What the pins' distances from the centre are multiplied by",
        default=1.0,
        precision=4,
        options={"SKIP_SAVE"},
    )

    axis: EnumProperty(
        name="Axis",
        description="Along which axis the pins are spread",
        items=(
            ("NONE", "All", "In all directions"),
            *((letter, letter, f"Only along {letter}") for letter in "XYZ"),
        ),
        options={"SKIP_SAVE"},
    )
    orientation: EnumProperty(
        name="Orientation",
        description="Whose axis that is",
        items=ORIENTATIONS,
        default="LOCAL",
        options={"SKIP_SAVE"},
    )

    scale_patches: BoolProperty(
        name="Scale Patches",
        description="Let patches grow with their distances. One that is selected alone is always scaled",
        options={"SKIP_SAVE"},
    )

    def posing_model(self) -> type[Posing]:
        return ScalingSpread if self.scale_patches else Spreading

    def edited(self, path: list[Sample], frame: PlaneFrame) -> list[Sample]:
        along = None if self.axis == "NONE" else plane_axes(frame, self.orientation).along(self.axis)
        # Along an axis that leaves the plane nothing can be spread.
        share = 0.0 if self.axis != "NONE" and along is None else self.factor - 1.0
        return carried_growth(path, share, along)

    def set_end(self, drag: Drag, sample: Sample) -> None:
        self.factor = 1.0 + drag.grown
        self.axis, self.orientation = drag.lock or "NONE", drag.orientation

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "factor")
        column.prop(self, "scale_patches")
        column.row().prop(self, "axis", expand=True)
        if self.axis != "NONE":
            column.prop(self, "orientation")


CLASSES = (PLANAR_OT_drag_pins, PLANAR_OT_rotate_pins, PLANAR_OT_spread_pins)
