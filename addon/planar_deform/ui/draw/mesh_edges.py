# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh's edges while the Pose tool is active."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ...scene.pins.pin_list import has_pins
from ...scene.view import snapshot
from ...scene.view.snapshot import Snapshot
from ..tool.tool_state import pose_tool_is_active
from .in_views import InViews

CLASSES = ()

EDGES = (0.05, 0.05, 0.06, 0.45)

_made: WeakKeyDictionary[Snapshot, gpu.types.GPUBatch] = WeakKeyDictionary()  # for as long as that is kept


def _draw() -> None:
    context = bpy.context
    if not pose_tool_is_active(context) or not context.space_data.overlay.show_overlays:
        return
    if not has_pins(context.object) or not context.object.planar.show_mesh:
        return
    seen = snapshot.in_view(context)
    if seen is None or not len(seen.edges):
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    batch = _made.get(seen)
    if batch is None:
        content = {"pos": seen.points.astype("float32")}
        batch = _made[seen] = batch_for_shader(shader, "LINES", content, indices=seen.edges)
    shader.bind()
    shader.uniform_float("color", EDGES)
    gpu.state.blend_set("ALPHA")
    batch.draw(shader)
    gpu.state.blend_set("NONE")


_drawn = InViews(_draw, "POST_VIEW")


def register() -> None:
    _drawn.on()


def unregister() -> None:
    _drawn.off()
    _made.clear()
