# SPDX-License-Identifier: GPL-3.0-or-later
"""What shapes are, in short, kept while no shape changes: panels ask for it in every redraw."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import bpy
from bpy.app.handlers import persistent

CLASSES = ()

_known: dict[tuple[int, float], str] = {}  # by the object's session_uid and the shape key's place


def of_block(obj: bpy.types.Object, place: float, read: Callable[[], bytes]) -> str:
    """The digest of the shape key of an object at a place; `read` gives its bits."""
    found = _known.get((obj.session_uid, place))
    if found is None:
        found = _known[obj.session_uid, place] = digest(read())
    return found


def digest(data: bytes) -> str:
    """A short name of these bits."""
    return hashlib.blake2b(data, digest_size=12).hexdigest()


@persistent
def forget(*_):
    """Anything may have changed."""
    _known.clear()


@persistent
def _forget_changed(_scene, depsgraph):
    shapes = bpy.types.Mesh, bpy.types.Curve, bpy.types.Key
    if any(isinstance(update.id, shapes) for update in depsgraph.updates):
        forget()


HANDLERS = {
    "depsgraph_update_post": _forget_changed,
    **dict.fromkeys(("undo_post", "redo_post", "load_post"), forget),
}
