# SPDX-License-Identifier: GPL-3.0-or-later
"""Which ease new keys of an object's poses get: what is chosen for the object, else in the preferences."""

from __future__ import annotations

import bpy

from ...model.timing.ease import KeyEase, meaning


def of_new_keys(obj: bpy.types.Object) -> KeyEase:
    """The object's own ease, else that of the add-on's preferences, else Blender's for new keyframes."""
    preferences = bpy.context.preferences
    add_on = preferences.addons.get(__package__.partition(".scene.")[0])
    own = getattr(None if add_on is None else add_on.preferences, "ease", "")
    edit = preferences.edit
    blenders = KeyEase(edit.keyframe_new_interpolation_type, handles=edit.keyframe_new_handle_type)
    return meaning([obj.planar.ease, own], blenders)
