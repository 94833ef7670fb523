# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh's edges while the Pose tool is active."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import bpy
import gpu
import numpy as np

from ...model.plane.frame import Indices
from ...scene.pins.pin_list import has_pins
from ...scene.view import snapshot
from ...scene.view.snapshot import Snapshot
from ..tool.tool_state import pose_tool_is_active
from . import vertices
from .in_views import InViews

CLASSES = ()

EDGES = (0.05, 0.05, 0.06, 0.45)

_made: WeakKeyDictionary[Snapshot, gpu.types.GPUBatch] = WeakKeyDictionary()  # for as long as that is kept
_joined: tuple[Indices, gpu.types.GPUIndexBuf] | None = None  # the edges drawn last, which no pose changes


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
        batch = _made[seen] = _make(seen)
    shader.bind()
    shader.uniform_float("color", EDGES)
    gpu.state.blend_set("ALPHA")
    batch.draw(shader)
    gpu.state.blend_set("NONE")


def _make(seen: Snapshot) -> gpu.types.GPUBatch:
    ends = gpu.types.GPUVertBuf(vertices.places(), len(seen.points))
    ends.attr_fill("pos", seen.points.astype(np.float32))
    return gpu.types.GPUBatch(type="LINES", buf=ends, elem=_indices(seen.edges))


def _indices(edges: Indices) -> gpu.types.GPUIndexBuf:
    global _joined
    if _joined is None or _joined[0] is not edges:
        _joined = edges, gpu.types.GPUIndexBuf(type="LINES", seq=edges)
    return _joined[1]


_drawn = InViews(_draw, "POST_VIEW")


def register() -> None:
    _drawn.on()


def unregister() -> None:
    global _joined
    _drawn.off()
    _made.clear()
    _joined = None
