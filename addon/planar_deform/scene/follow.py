# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps pins matched to the vertex groups while the user renames, removes or edits things."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..model import solver_cache
from .pins import sync

CLASSES = ()


@persistent
def follow_edits(scene, depsgraph):
    """After each update: pins and stiffness follow the groups of their object."""
    for update in depsgraph.updates:
        obj = update.id.original
        if not isinstance(obj, bpy.types.Object) or obj.type != "MESH":
            continue
        if not obj.planar.pins and not obj.planar.stiffness_group:
            continue
        if obj.library is None and obj.mode in {"OBJECT", "WEIGHT_PAINT"}:
            sync(obj)


@persistent
def forget_solvers(*_):
    """Another file: its objects are others, whatever their identities."""
    solver_cache.clear()


HANDLERS = {"depsgraph_update_post": follow_edits, "load_pre": forget_solvers}
