# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers the add-on, or, after an update, only what asks for a restart of Blender.

A process keeps a compiled module until it ends, so that new files of the add-on find the old one in memory.
An error then would have Blender disable the add-on for good.

On Windows a loaded module's file cannot be replaced either. Blender leaves it, takes the rest of the old
wheel away, fails to unpack the new one, removes what is left when it starts next, and does not try again.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import bpy

from . import compat
from .errors import RestartNeeded, try_all

_reason = ""
_undo: list[Callable[[], None]] = []


class PlanarRestartPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.label(text=_reason, icon="INFO")


class PLANAR_PT_restart(bpy.types.Panel):
    bl_label = "Planar Deform"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Planar"

    def draw(self, _context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.label(text="Restart Blender", icon="INFO")
        column.label(text="to finish the update")


WAITING: tuple[Any, ...] = (PlanarRestartPreferences, PLANAR_PT_restart)


def register() -> None:
    """Raises ImportError where the compiled module is missing, or is another one than a restart brings."""
    global _reason
    try:
        registration = _registration()
    except RestartNeeded as reason:
        _reason = str(reason)
        print(_reason, flush=True)
        for cls in WAITING:
            bpy.utils.register_class(cls)
            _undo.append(partial(bpy.utils.unregister_class, cls))
        return
    _undo.append(registration.unregister)
    try:
        registration.register()
    except Exception:
        _undo.clear()
        raise


def unregister() -> None:
    """Leave nothing behind: goes on after a failure, and tells of all in the end."""
    steps = _undo[::-1]
    _undo.clear()
    try_all(steps)


def _registration() -> Any:
    name = f"{__package__}.registration"
    try:
        return importlib.import_module(name)
    except RestartNeeded:
        raise
    except ImportError:
        if not compat.unpack_wheels(__package__):
            raise
    sys.path_importer_cache.clear()  # what was not there may be now
    return importlib.import_module(name)
