# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow their targets while these are moved, where Live is on.

Nothing is solved while Blender evaluates: what has moved is looked at soon after it. That is in no undo step
of its own, but in the one of what moved the target, or in the next one.
"""

from __future__ import annotations

import traceback

import bpy

from ..errors import ObjectGone, Refusal
from ..scene.lattice.posed import posing_refusal, read_posed
from ..scene.motion import to_targets
from ..scene.pins import targets
from ..scene.telling import tell
from .modal import running

SOON = 0.05  # seconds between looks while something else is on

CLASSES = ()

_live: set[str] = set()  # objects with Live on, by name


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
    return None


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
            reason = posing_refusal(obj)
            if reason is not None:
                raise Refusal(reason)
            to_targets.solve(obj, read_posed(obj, unkeyed=True))
        obj.planar.followed = stamp
    except (Refusal, ObjectGone) as refusal:
        obj.planar.live = False
        _live.discard(obj.name)
        tell(f"{obj.name}: {refusal}", title="Live Is Off")


def unregister() -> None:
    """Look at nothing any more."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
