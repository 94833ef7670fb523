# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins follow what has been done to their mesh, in the order in which one depends on the other."""

from __future__ import annotations

import bpy

from ..objects import mesh_edits
from . import joining, pin_list, places


def follow(obj: bpy.types.Object) -> None:
    """After an update of a mesh object: a join, an edit, a transform, a change of its groups."""
    pinned = pin_list.has_pins(obj)
    if pinned:
        joining.undone(obj)
        pin_list.sync(obj)
    if not mesh_edits.is_followed(obj):
        return
    joined = mesh_edits.follow(obj)
    if joined:
        joining.take_in(obj, joined)
    if pin_list.has_pins(obj):
        places.follow(obj)
        joining.remember(obj)


def forget() -> None:
    """Of another file nothing is known."""
    mesh_edits.forget()
    joining.forget()
