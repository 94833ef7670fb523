# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting stiffness with Blender's own Weight Paint. After each stroke the pose settles, as it is shown.

Blender makes an undo step of each stroke. What settles after it is in no step of its own, which would have to
be undone twice; it is in the next one, and undoing a stroke lets the pose settle again. Only when the user
leaves Weight Paint sooner than it could settle is there a step for that.
"""

from __future__ import annotations

import traceback
from functools import partial

import bpy

from .. import compat, native
from ..errors import ObjectGone, Refusal
from ..model.plane.cutout import NEUTRAL
from ..model.posing.posing import Posing, Solved
from ..model.posing.solving import Solving, StoppedError
from ..scene.objects import stiffness
from ..scene.objects.cutout_object import begin, read_cutout
from ..scene.pins import joint_list, pin_list
from ..scene.storage import migration
from .modal import running
from .posing_operator import PosingOperator

SOON = 0.05  # seconds from a change to a look at it, and between looks while a stroke is on
RATE = 1 / 60  # seconds between two looks at what the thread has solved
UNDER_WAY = ("PAINT_OT_", "PLANAR_OT_")  # operators that must have ended


class PLANAR_OT_paint_stiffness(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.paint_stiffness"
    bl_label = "Paint Stiffness"
    bl_description = (
        "Paint where the drawing is stiff (a weight of 1) and where it is soft (0), in Weight Paint. Makes "
        "the vertex group if there is none"
    )

    def apply(self, context: bpy.types.Context) -> None:
        obj = context.object
        if not obj.visible_get():
            raise Refusal(f"'{obj.name}' is hidden: show it to paint on it")
        begin(context)  # a mesh that cannot be posed needs no stiffness
        pin_list.sync(obj)
        group = stiffness.ensure_group(obj)
        pin_list.sync(obj)
        obj.vertex_groups.active_index = group.index
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
        brush = compat.brush_weight_owner(context.tool_settings)
        if brush is not None and brush.weight == NEUTRAL:
            brush.weight = 1.0  # else the first strokes would do nothing


class _Settling:
    """A pose on its way to what its new stiffness makes of it. Raises Refusal."""

    def __init__(self, obj: bpy.types.Object):
        self.drawing = read_cutout(obj, mode=obj.mode)
        settings, positions = obj.planar, self.drawing.positions
        used = pin_list.model_pins(obj, self.drawing)
        if settings.method == "AKVF" or not any(pin.enabled for pin in used):
            raise Refusal("Stiffness is felt when pins are moved")
        make_poser = partial(joint_list.solver_of(obj, self.drawing), positions)
        self._solved: Solved | None = None
        self._solving = Solving(Posing(self.drawing.cutout, positions, used, (), make_poser))
        self._solving.ask((0.0, 0.0, 0.0))
        self._solving.hurry()

    def show(self) -> bool:
        """Show the newest; whether it has settled. Raises ObjectGone, SolveError and StoppedError."""
        obj = self.drawing.resolve()
        solved = self._solving.newest()
        if solved is not None:
            self.drawing.write(solved.positions)
            self._solved = solved
        if self._solving.settled and self._solved is not None:
            pin_list.store_results(obj, self.drawing, self._solved.results)
            return True
        return False

    def give_way(self) -> None:
        """See running.Run. Leave it as it is shown."""
        self._solving.stop()

    def let_go(self) -> None:
        """See running.Run."""
        self._solving.stop()


_painted: int | None = None  # the object that was seen in Weight Paint last


def _active() -> bpy.types.Object | None:
    """The object whose stiffness is being painted, or was up to now."""
    obj = bpy.context.view_layer.objects.active
    if obj is None or obj.type != "MESH":
        return None
    left = obj.mode == "OBJECT" and obj.session_uid == _painted
    if obj.mode != "WEIGHT_PAINT" and not left:
        return None
    return obj if obj.planar.stiffness_group and not migration.is_newer(obj) else None


def _look() -> float | None:
    """Let the pose settle where it has not been solved with what is painted; seconds to the next look."""
    global _painted
    obj = _active()
    settling = _settling()
    under_way = (
        operator.bl_idname
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )
    if obj is not None and any(name.startswith(UNDER_WAY) for name in under_way):
        _stop()
        return SOON
    try:
        if obj is None:
            _stop()
            return None
        _painted = obj.session_uid
        if settling is None and not _changed(obj):
            _painted = obj.session_uid if obj.mode == "WEIGHT_PAINT" else None
            return None
        if settling is None:
            running.start(_Settling(obj))
        elif settling.show():
            _stop()
            if obj.mode == "OBJECT":
                bpy.ops.ed.undo_push(message="Settle Pose")
            return SOON
        return RATE
    except ObjectGone:  # it is in another mode, perhaps
        _stop()
        return SOON
    except (Refusal, StoppedError, native.SolveError):
        _stop()
        return None
    except Exception:  # the same would go wrong at each look: not again until something else is painted
        traceback.print_exc()
        _stop()
        if obj is not None:
            obj.planar.solved_stiffness = stiffness.stamp(stiffness.painted(obj))
        return None


def _changed(obj: bpy.types.Object) -> bool:
    """Whether another stiffness is painted than the shape was solved with."""
    now = stiffness.stamp(stiffness.painted(obj))
    if not obj.planar.solved_stiffness:
        obj.planar.solved_stiffness = now  # the shape is as the user has made it
    return bool(obj.planar.solved_stiffness != now)


def _settling() -> _Settling | None:
    run = running.now()
    return run if isinstance(run, _Settling) else None


def _stop() -> None:
    if _settling() is not None:
        running.end()


def changed() -> None:
    """Something was evaluated anew: look soon whether that was the stiffness."""
    # In background no timer ever runs, and the bpy module crashes at exit if one has been registered.
    if bpy.app.background or _active() is None or bpy.app.timers.is_registered(_look):
        return
    bpy.app.timers.register(_look, first_interval=SOON)


def undone() -> None:
    """What is undone to in Object Mode is what was there."""
    forget()
    changed()


def forget() -> None:
    """What was painted is another file's, or is no more."""
    global _painted
    _painted = None


CLASSES = (PLANAR_OT_paint_stiffness,)


def unregister() -> None:
    """Look at nothing any more."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
