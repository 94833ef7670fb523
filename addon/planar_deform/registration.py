# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers everything, in order, and undoes it in reverse."""

from __future__ import annotations

import bpy

from .model import solver_cache
from .operators import pins, rest
from .scene import follow, properties

# Modules with CLASSES, and register() and unregister() where classes are not all: those run after the classes
# are in.
MODULES = (properties, pins, rest, follow)


def register() -> None:
    """Register all modules; an error undoes what was done and is passed on."""
    done = []
    try:
        for module in MODULES:
            done.append(module)
            for cls in module.CLASSES:
                bpy.utils.register_class(cls)
            if hasattr(module, "register"):
                module.register()
    except Exception:
        _undo(done)
        raise


def unregister() -> None:
    """Leave nothing behind."""
    _undo(list(MODULES))
    solver_cache.clear()


def _undo(modules: list) -> None:
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            if cls.is_registered:
                bpy.utils.unregister_class(cls)
