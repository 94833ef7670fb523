# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings with Live on, which show in every frame where what their pins follow is then.

Blender evaluates a frame once more after a handler has changed anything, so that what is written here is in
the picture: in the viewport, while the timeline plays, and in renders. Those of a window run in a thread of
their own, and may only write what the window does not draw meanwhile: it has to be locked.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy

from ...errors import Refusal
from ..lattice import rig
from ..lattice.posed import posing_refusal, read_posed
from ..objects import pose_store
from ..pins import controls, dependencies, followed_mesh, pin_list
from ..sequence import pose_showing, pose_state
from ..storage import points
from . import to_controls

Places = frozenset[tuple[str, str]]  # that pins follow: names of carriers and of their groups

_live: dict[int, tuple[str, Places]] = {}  # names of objects with Live on, by session_uid
_paused = False


def note(obj: bpy.types.Object) -> None:
    """An object may have been set to follow, or no more to."""
    if obj.library is None and obj.is_property_set("planar") and obj.planar.live:
        followed = (pin for pin in obj.planar.pins if pin.follow_group and pin.follow is not None)
        places = frozenset((pin.follow.name, pin.follow_group) for pin in followed)
        _live[obj.session_uid] = obj.name, places
    else:
        _live.pop(obj.session_uid, None)


def note_all() -> None:
    """Other data are there."""
    forget()
    for obj in bpy.data.objects:
        note(obj)


def forget() -> None:
    """The objects are another file's, or are no more."""
    _live.clear()


def objects() -> list[bpy.types.Object]:
    """Those with Live on, what is followed before what follows it."""
    found = {uid: bpy.data.objects.get(name) for uid, (name, _) in _live.items()}
    if any(obj is None or obj.session_uid != uid for uid, obj in found.items()):  # renamed, or gone
        found = {obj.session_uid: obj for obj in bpy.data.objects if obj.session_uid in _live}
        gone = [places for uid, (_, places) in _live.items() if uid not in found]
        _live.clear()
        for obj in found.values():
            note(obj)
        for name, group in frozenset().union(*gone):
            carrier = bpy.data.objects.get(name)
            if carrier is not None and carrier.type == "MESH" and carrier.library is None:
                followed_mesh.remove_unused(carrier, {group})
    there = [obj for obj in found.values() if obj is not None]
    return dependencies.in_order(there) if len(there) > 1 else there


def switched(obj: bpy.types.Object) -> None:
    """Live has been turned on or off: the poses of an object play only where it is off."""
    note(obj)
    obj.planar.followed = ""  # the pins may have been anywhere since
    if obj.type in points.TYPES and pose_state.is_ours(obj):
        if pose_state.refusal(obj) is None:
            pose_showing.let_play(obj, not obj.planar.live)
        elif not obj.planar.live:
            pose_showing.let_strip_play(obj)


@contextlib.contextmanager
def paused() -> Iterator[None]:
    """Frames are gone through only to look at them: nothing follows that."""
    global _paused
    before, _paused = _paused, True
    try:
        yield
    finally:
        _paused = before


def is_paused() -> bool:
    """Whether the frame changes only to be looked at."""
    return _paused


def shows_frame(obj: bpy.types.Object, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """After a change of the frame: let a drawing with Live on show what belongs to it.

    Whether the frame shows that; not so where it must not be written now. What a lattice deforms follows
    later, in no render, where Blender alone can tell what reaches it. Raises Refusal and ObjectGone.
    """
    if (
        _paused
        or obj.mode != "OBJECT"
        or dependencies.waits(obj)
        or not obj.evaluated_get(depsgraph).is_evaluated
    ):
        return True
    dependencies.find_lost(obj)
    frame = scene.frame_current_final
    stamp = controls.stamp(obj, frame, depsgraph)
    if not stamp or (stamp == obj.planar.followed and _shows_it(obj, frame)):
        return True
    if obj.type == "LATTICE" and not rig.is_known(obj, posed=depsgraph.mode == "VIEWPORT"):
        return bool(depsgraph.mode != "RENDER")
    if _is_drawn(scene, depsgraph):
        return False
    reason = posing_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    if pose_state.is_ours(obj):
        pose_showing.let_play(obj, False)  # Blender would read the curve once more, behind this
    to_controls.solve(obj, read_posed(obj, unkeyed=True), frame, depsgraph)
    followed_mesh.wrote(obj, pose_store.shown_by(obj))
    obj.planar.followed = stamp
    return True


def stands(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """What an object shows is what belongs to where its controls are: it stays until these move.

    Raises Refusal.
    """
    obj.planar.followed = controls.stamp(obj, depsgraph.scene.frame_current_final, depsgraph)


def _shows_it(obj: bpy.types.Object, frame: float) -> bool:
    """Whether the frame has not shown a pose again, and is the one at which it was posed by hand, if any."""
    if not pose_state.is_ours(obj):
        return True
    by_hand_elsewhere = obj.planar.posed_at != pin_list.NO_FRAME and not pin_list.posed_by_hand(obj, frame)
    return pose_state.unkeyed(obj) and not by_hand_elsewhere


def _is_drawn(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether a window may be drawing in this moment what is to be written."""
    return (
        depsgraph.mode == "RENDER"
        and not bpy.app.background
        and bpy.app.is_job_running("RENDER")
        and not scene.render.use_lock_interface
    )
