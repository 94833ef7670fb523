# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers everything, in order, and undoes it in reverse."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import bpy

from . import batch, events, preferences
from .errors import try_all
from .operators import (
    attach,
    bake,
    box_select,
    breakdown,
    carry,
    click,
    cutout,
    depth,
    drag,
    flatten,
    follow,
    inbetweens,
    lattice,
    live,
    motion,
    pin_paths,
    pin_radius,
    pins,
    pose_mirror,
    pose_travel,
    poses,
    record,
    refine,
    remesh,
    rest,
    settle,
    stiffness,
)
from .scene import properties
from .ui import menus
from .ui.draw import cutout_preview, depth_tint, gestures, mesh_edges, onion_skin, quality
from .ui.panels import (
    bake_panel,
    flatten_panel,
    follow_panel,
    lattice_panel,
    motion_panel,
    pins_panel,
    poses_panel,
    posing_panel,
)
from .ui.tool import gizmos, hint, pin_menu, pose_tool

# Each has CLASSES, and register() and unregister() where these are not all; those run with the classes in.
# The last one is undone first: it ends what is running.
MODULES = (
    preferences,
    properties,
    cutout,
    pins,
    attach,
    rest,
    refine,
    remesh,
    drag,
    settle,
    record,
    click,
    box_select,
    pin_paths,
    pin_radius,
    depth,
    stiffness,
    poses,
    inbetweens,
    pose_mirror,
    pose_travel,
    motion,
    bake,
    breakdown,
    carry,
    lattice,
    flatten,
    follow,
    live,
    batch,
    gizmos,
    pin_menu,
    hint,
    pose_tool,
    gestures,
    quality,
    depth_tint,
    mesh_edges,
    cutout_preview,
    onion_skin,
    pins_panel,
    follow_panel,
    posing_panel,
    poses_panel,
    lattice_panel,
    flatten_panel,
    motion_panel,
    bake_panel,
    menus,
    events,
)


_undo: list[Callable[[], None]] = []


def register() -> None:
    """Register all modules; an error undoes what was done and is passed on."""
    try:
        for module in MODULES:
            for cls in module.CLASSES:
                bpy.utils.register_class(cls)
                _undo.append(partial(bpy.utils.unregister_class, cls))
            if hasattr(module, "register"):
                module.register()
            if hasattr(module, "unregister"):
                _undo.append(module.unregister)
    except Exception:
        unregister()
        raise


def unregister() -> None:
    """Leave nothing behind: goes on after a failure, and tells of all in the end."""
    steps = _undo[::-1]
    _undo.clear()
    try_all(steps)
