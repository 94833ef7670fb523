# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects added to the scene as Blender's own commands add them."""

from __future__ import annotations

import bpy


def link_beside(context: bpy.types.Context, beside: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Into the collection of an object that is seen, so that the new one is seen as well."""
    own = [collection for collection in beside.users_collection if collection.library is None]
    (own[0] if own else context.scene.collection).objects.link(obj)
    space = context.space_data
    if isinstance(space, bpy.types.SpaceView3D) and space.local_view is not None:
        obj.local_view_set(space, True)


def select_alone(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Make it the active object, and the only one that is selected."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj
