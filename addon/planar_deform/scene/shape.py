# SPDX-License-Identifier: GPL-3.0-or-later
"""Any flat object whose shapes over time can be keyed: what pose sequences are made of."""

from __future__ import annotations

import bpy

from . import access
from .access import SceneCutout

SceneShape = SceneCutout


def shape_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why poses of this object cannot be keyed or shown, and what to do; cheap enough for polls."""
    return access.pose_refusal(obj)


def begin_shape(context: bpy.types.Context, *, unkeyed: bool = False) -> SceneShape:
    """The active object's shape at the start of an action, its transforms up to date. Raises Refusal.

    `unkeyed`: what the action writes is shown, and never becomes a keyed pose by itself.
    """
    return access.begin(context, unkeyed=unkeyed)


def read_shape(obj: bpy.types.Object | None) -> SceneShape:
    """The object's shape, as it is shown. Raises Refusal; changes nothing."""
    return access.read_cutout(obj)
