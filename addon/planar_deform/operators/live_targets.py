# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow their targets while these are moved, where Live is on.

Nothing is solved while Blender evaluates: what has moved is looked at soon after it. That is in no undo step
of its own, but in the one of what moved the target, or in the next one. What is shown depends on the way that
the targets have come, so that it is kept how things were when they began to move: Esc brings it all back.
"""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass

import bpy

from ..errors import ObjectGone, Refusal
from ..scene.lattice.posed import PosedObject, posing_refusal, read_posed
from ..scene.motion import to_targets
from ..scene.objects.pose_store import store_of
from ..scene.pins import pin_list, targets
from ..scene.telling import tell
from .modal import running

SOON = 0.05  # seconds between looks while something else is on
PAUSE = 0.3  # seconds without a motion after which another one begins, unless a key or a button is held

CLASSES = ()

State = tuple[object, ...]  # what an object shows and what its pins keep, equal where equal to the bit


@dataclass
class _Motion:
    """Of the targets of one object: how all was when it began."""

    stamp: str  # of the targets
    frame: float
    drawing: PosedObject
    results: pin_list.SavedResults
    left: State | None = None  # how following has left the object
    at: float = 0.0  # when that was
    modal: bool = False  # whether an operator ran then, with which it ends

    def goes_on(self, obj: bpy.types.Object) -> bool:
        """Whether the object has not been changed by anything else, and the motion has not ended."""
        return (self.modal or time.monotonic() - self.at < PAUSE) and self.left == _state(obj)

    def put_back(self, obj: bpy.types.Object) -> None:
        """Make everything as it was when it began, to the bit. Raises ObjectGone."""
        self.drawing.restore()
        self.results.restore(obj)


_live: set[str] = set()  # objects with Live on, by name
_motions: dict[int, _Motion] = {}  # by session_uid of the object


def note(obj: bpy.types.Object) -> None:
    """An object may have been set to follow its targets, or no more to."""
    if obj.library is None and obj.is_property_set("planar") and obj.planar.live:
        _live.add(obj.name)
    else:
        _live.discard(obj.name)


def note_all() -> None:
    """Other data are there."""
    forget()
    for obj in bpy.data.objects:
        note(obj)
    changed()


def forget() -> None:
    """The objects are another file's, or are no more."""
    _live.clear()
    _motions.clear()


def changed() -> None:
    """Something was evaluated anew: look soon whether that were targets."""
    # In background no timer ever runs, and the bpy module crashes at exit if one has been registered.
    if _live and not bpy.app.background and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0.0)


def _look() -> float | None:
    if running.now() is not None or bpy.app.is_job_running("RENDER") or _playing():
        return SOON
    try:
        follow()
    except Exception:  # the same would go wrong at each look
        traceback.print_exc()
        forget()
    return SOON if _watch() else None


def _watch() -> bool:
    """Let motions end with the operators that made them; whether one is to be watched."""
    if not _held():
        for uid in [uid for uid, motion in _motions.items() if motion.modal]:
            del _motions[uid]
    return any(motion.modal for motion in _motions.values())


def _held() -> bool:
    """Whether an operator runs that a key or a button ends."""
    return any(window.modal_operators for window in bpy.context.window_manager.windows)


def _playing() -> bool:
    return any(window.screen.is_animation_playing for window in bpy.context.window_manager.windows)


def follow() -> None:
    """Take the pins of all objects with Live on to where their targets are, if these have moved.

    Where that is refused, the reason is told and Live goes off.
    """
    for name in sorted(_live):
        obj = bpy.data.objects.get(name)
        if obj is None:
            _live.discard(name)  # renamed ones have been noted by their new name
        elif obj.mode == "OBJECT" and obj.name in bpy.context.view_layer.objects:
            _follow(obj)


def _follow(obj: bpy.types.Object) -> None:
    try:
        stamp = targets.stamp(obj)
        if stamp == obj.planar.followed:
            return
        if stamp:
            _go_on(obj, stamp)
        obj.planar.followed = stamp
    except (Refusal, ObjectGone) as refusal:
        obj.planar.live = False
        _live.discard(obj.name)
        tell(f"{obj.name}: {refusal}", title="Live Is Off")


def _go_on(obj: bpy.types.Object, stamp: str) -> None:
    """Take the pins to where their targets are. Raises Refusal and ObjectGone."""
    reason = posing_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    frame = bpy.context.scene.frame_current_final
    motion = _motions.get(obj.session_uid)
    if motion is not None and not motion.goes_on(obj):
        motion = None
    if motion is not None and (motion.stamp, motion.frame) == (stamp, frame):
        motion.put_back(obj)
        del _motions[obj.session_uid]
        return
    drawing = read_posed(obj, unkeyed=True)
    if motion is None:
        motion = _Motion(obj.planar.followed, frame, drawing, pin_list.SavedResults(obj))
    to_targets.solve(obj, drawing)
    motion.left, motion.at, motion.modal = _state(obj), time.monotonic(), _held()
    _motions[obj.session_uid] = motion


def _state(obj: bpy.types.Object) -> State:
    """Raises Refusal."""
    pins = (
        (
            *(pin.group, pin.lattice_point, pin.kind, pin.enabled, pin.weight),
            *(pin.has_target, tuple(pin.target), tuple(pin.reached), pin.angle, pin.scale),
        )
        for pin in obj.planar.pins
    )
    return (store_of(obj, unkeyed=True).shown.tobytes(), obj.planar.pin_weight, *pins)


def unregister() -> None:
    """Look at nothing any more."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
