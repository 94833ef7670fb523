# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender tells: one handler for each of its events, and all that is done then, in order."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import bpy
from bpy.app.handlers import persistent

from . import compat
from .errors import try_all
from .model.posing import solved_shapes, solver_cache, solving
from .operators import live, stiffness
from .operators.modal import running
from .scene import follow
from .scene.image import file_state, preview, reading
from .scene.lattice import reaching, rig
from .scene.motion import live as live_frames
from .scene.objects import cutout_object, lattice_edits, triangulation
from .scene.pins import following
from .scene.sequence import pose_showing
from .scene.storage import changes, digests, migration, vertex_groups
from .scene.view import coarseness, onion, snapshot

CLASSES = ()


def _on_update(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Blender has evaluated something anew.

    Called for every movement of anything, so nothing is asked of an object that has only moved, unless it is
    a lattice.
    """
    pose_showing.keep_brought_back()
    changed = []  # objects of which more than the transform may be another one, and lattices
    for update in depsgraph.updates:
        if not isinstance(update.id, bpy.types.Object):
            continue
        shape = update.is_updated_geometry
        if shape or update.is_updated_shading or update.id.type == "LATTICE":
            changed.append(update.id.original)
            if shape:
                changes.tell_update(changed[-1], dragged=snapshot.following(changed[-1]))
    for obj in dict.fromkeys(changed):
        follow.match(obj)
        follow.match_uv_map(obj, depsgraph)
        live_frames.note(obj)
    live.carry(depsgraph)
    stiffness.changed()
    live.changed()


def _on_frame_change(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    changed = [
        update.id.original
        for update in depsgraph.updates
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object)
    ]
    for obj in changed:
        changes.tell_frame(obj)
        if depsgraph.mode == "VIEWPORT":
            follow.match_uv_map(obj, depsgraph)
    if not live_frames.is_paused():
        follow.activate_shown_pose(scene, depsgraph)
    live.follow_frame(scene, depsgraph)
    if depsgraph.mode == "VIEWPORT":
        live.changed()


def _before_undo(*_: object) -> None:
    running.let_go()
    preview.forget()


def _after_undo(*_: object) -> None:
    changes.tell_all()
    following.undone()
    pose_showing.undone()
    stiffness.undone()
    _note_live()
    live.undone()


def _before_load(*_: object) -> None:
    try_all((running.let_go, *RESET))


def _after_load(*_: object) -> None:
    _on_new_data()
    for obj in bpy.data.objects:
        follow.match(obj)
    _note_live()


def _note_live() -> None:
    live.forget()
    live_frames.note_all()
    live.changed()


def _before_render(*_: object) -> None:
    live.render_begins()


def _on_new_data(*_: object) -> None:
    """A file is loaded, something appended; or what is to be saved may have become local since."""
    migration.migrate_all()


# Keeps nothing of the file: its objects go, and others may get their names and identities.
RESET: tuple[Callable[[], None], ...] = (
    running.stop_clocks,
    solving.halt,
    solver_cache.clear,
    solved_shapes.clear,
    triangulation.forget,
    cutout_object.forget,
    changes.tell_all,
    digests.forget,
    vertex_groups.forget,
    reaching.forget,
    rig.forget,
    snapshot.forget,
    onion.forget,
    coarseness.forget,
    file_state.forget,
    stiffness.forget,
    live.forget,
    live_frames.forget,
    following.forget,
    lattice_edits.forget,
    preview.forget,
    reading.forget,
)


HANDLERS: dict[str, Callable[..., None]] = {  # of bpy.app.handlers, by name
    "depsgraph_update_post": _on_update,
    "frame_change_post": _on_frame_change,
    "undo_pre": _before_undo,
    "redo_pre": _before_undo,
    "undo_post": _after_undo,
    "redo_post": _after_undo,
    "load_pre": _before_load,
    "load_post": _after_load,
    "render_init": _before_render,
    **dict.fromkeys(("save_pre", *compat.AFTER_IMPORT), _on_new_data),
}


def register() -> None:
    """Listen from now on."""
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(persistent(handler))


def unregister() -> None:
    """Listen no more, end what runs, perhaps in the middle of a drag, and keep nothing."""
    deaf = (partial(getattr(bpy.app.handlers, name).remove, handler) for name, handler in HANDLERS.items())
    try_all((*deaf, running.end, *RESET))
