# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow objects and bones while these are moved, where Live is on.

Nothing is solved while Blender evaluates: what has moved is looked at soon after it. That is in no undo step
of its own, but in the one of what moved the control, or in the next one. It is kept how things were when the
controls began to move: Esc brings it all back to the bit. Frames are followed in scene/motion/live.py.
"""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass
from functools import partial

import bpy

from ..errors import ObjectGone, Refusal
from ..scene.lattice import rig
from ..scene.lattice.posed import PosedObject, posing_refusal, read_posed
from ..scene.motion import live, to_controls
from ..scene.objects import pose_store
from ..scene.pins import controls, dependencies, followed_mesh, pin_list
from ..scene.telling import tell
from ..scene.view import snapshot
from .modal import running

SOON = 0.05  # seconds between looks while something else is on
PAUSE = 0.3  # seconds without a motion after which another one begins, unless a key or a button is held

LOCK = (
    "the picture does not show what its pins follow. Turn on Lock Interface in the Render menu, render in "
    "background, or use Bake Pins"
)
LATTICE = (
    "the picture does not show what the pins of this lattice follow, as something else deforms its meshes "
    "before it: use Bake Pins"
)

CLASSES = ()

State = tuple[object, ...]  # what an object shows and what its pins keep, equal where equal to the bit


@dataclass
class _Motion:
    """Of the controls of one object: how all was when it began."""

    stamp: str  # of the controls
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


_motions: dict[int, _Motion] = {}  # by session_uid of the object
_carrying = False
_undone = False  # by undo or redo all is as it was once, and why Live went off then has been told
_told = False  # that the present render does not follow


def forget() -> None:
    """The objects are another file's, or are no more."""
    _motions.clear()


def undone() -> None:
    """Undo or redo has brought other data."""
    global _undone
    _undone = not bpy.app.background and bool(live.objects())  # else nobody looks soon
    changed()


def changed() -> None:
    """Something was evaluated anew: look soon whether that were controls."""
    # In background no timer ever runs, and the bpy module crashes at exit if one has been registered.
    if not bpy.app.background and live.objects() and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0.0)


def render_begins() -> None:
    """A picture or a film is about to be rendered."""
    global _told
    _told = False


def follow_frame(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After a change of the frame: drawings with Live on show what belongs to it.

    Not so those that something goes through which is running. In a render this may be in another thread.
    """
    global _told
    if running.now() is not None:
        return
    followed_mesh.evaluated()
    for obj in live.objects():
        try:
            if not live.shows_frame(obj, scene, depsgraph) and not _told:
                _told = True
                _tell(f"{obj.name}: {LATTICE if obj.type == 'LATTICE' else LOCK}", "Live Is Not Rendered")
        except (Refusal, ObjectGone) as refusal:
            _go_off(obj, str(refusal))
    followed_mesh.evaluated()


def carry(depsgraph: bpy.types.Depsgraph) -> None:
    """Objects have just been evaluated: what follows their meshes goes along, in the same picture.

    Blender evaluates once more what is written here, before it draws. So this holds during a drag of what
    carries, and for scripts as soon as they update the view layer.
    """
    global _carrying
    if _carrying or depsgraph.mode != "VIEWPORT" or live.is_paused() or bpy.app.is_job_running("RENDER"):
        return
    moved = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, bpy.types.Object)
        and (update.is_updated_geometry or update.is_updated_transform)
    }
    _carrying = True
    try:
        followed_mesh.evaluated()
        for obj in live.objects() if moved else ():
            if not moved.isdisjoint(dependencies.carriers_of(obj)) and _follows(obj, depsgraph):
                moved.add(obj)
    finally:
        _carrying = False
        followed_mesh.evaluated()


def _follows(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Take an object along with what carries it; whether it has been written."""
    if (
        obj.mode != "OBJECT"
        or (obj.type == "LATTICE" and not rig.is_known(obj, posed=True))
        or snapshot.following(obj)
        or not obj.evaluated_get(depsgraph).is_evaluated
    ):
        return False
    try:
        if not _follow(obj, depsgraph):
            return False
        followed_mesh.wrote(obj, pose_store.shown_by(obj))
    except (Refusal, ObjectGone) as refusal:
        _go_off(obj, str(refusal))
        return False
    return True


def _go_off(obj: bpy.types.Object, reason: str) -> None:
    """Turn Live off where it cannot go on, and tell why."""
    obj.planar.live = False
    if not _undone:
        _tell(f"{obj.name}: {reason}", "Live Is Off")


def _tell(message: str, title: str) -> None:
    """Tell it, from whatever thread."""
    if bpy.app.background:
        tell(message, title=title)
    else:
        bpy.app.timers.register(partial(tell, message, title=title), first_interval=0.0)


def _look() -> float | None:
    global _undone
    if running.now() is not None or bpy.app.is_job_running("RENDER") or _playing():
        return SOON
    try:
        follow()
    except Exception:  # the same would go wrong at each look
        traceback.print_exc()
        forget()
        live.forget()
    _undone = False
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
    """Take the pins of all objects with Live on to where their controls want them, if these have moved.

    Where that is refused, the reason is told and Live goes off.
    """
    for obj in live.objects():
        if obj.mode == "OBJECT" and obj.name in bpy.context.view_layer.objects:
            try:
                _follow(obj, bpy.context.evaluated_depsgraph_get())
            except (Refusal, ObjectGone) as refusal:
                _go_off(obj, str(refusal))


def _follow(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether anything was written. Raises Refusal and ObjectGone."""
    dependencies.find_lost(obj)
    if dependencies.waits(obj):
        return False
    frame = depsgraph.scene.frame_current_final
    stamp = controls.stamp(obj, frame, depsgraph)
    if stamp == obj.planar.followed:
        return False
    if stamp:
        _go_on(obj, stamp, frame, depsgraph)
    obj.planar.followed = stamp
    return bool(stamp)


def _go_on(obj: bpy.types.Object, stamp: str, frame: float, depsgraph: bpy.types.Depsgraph) -> None:
    """Take the pins to where their controls want them. Raises Refusal and ObjectGone."""
    reason = posing_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
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
    beside = running.now() is not None
    to_controls.solve(obj, drawing, frame, depsgraph, beside=beside, keeps_hand=True)
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
    return (pose_store.store_of(obj, unkeyed=True).shown.tobytes(), obj.planar.pin_weight, *pins)


def unregister() -> None:
    """Look at nothing any more."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
