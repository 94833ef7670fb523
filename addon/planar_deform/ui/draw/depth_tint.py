# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours on the drawing for a moment after a depth has been changed: warm in front, cold behind."""

from __future__ import annotations

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...model.plane.frame import Array, Array32
from ...scene.objects.cutout_object import CutoutObject
from ...scene.pins import pin_depths
from ...scene.storage import redraw
from ...scene.view import snapshot
from .in_views import InViews

CLASSES = ()

FRONT, BEHIND = (1.0, 0.45, 0.05), (0.05, 0.35, 1.0)
STRONGEST = 0.7  # the drawing is seen through it
LEAST = 1.0  # a depth of as much at least has the full colour


def colours(depths: Array) -> Array32:
    """The colours (n x 4 float32) of n depths, clear at 0."""
    shares = np.abs(depths) / max(LEAST, float(np.abs(depths).max(initial=0.0)))
    sides = np.where((depths > 0.0)[:, None], FRONT, BEHIND)
    return np.column_stack([sides, STRONGEST * shares]).astype(np.float32)


def _draw() -> None:
    context = bpy.context
    obj = context.object
    if context.mode != "OBJECT" or obj is None or pin_depths.seconds_shown(obj) <= 0.0:
        return
    if not context.space_data.overlay.show_overlays:
        return
    seen = snapshot.in_view(context)
    if seen is None or seen.shape is None or not isinstance(seen.shape[0], CutoutObject):
        return
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    content = {"pos": seen.points.astype(np.float32), "color": colours(seen.shape[0].depths)}
    batch = batch_for_shader(shader, "TRIS", content, indices=seen.triangles)
    gpu.state.blend_set("ALPHA")
    batch.draw(shader)
    gpu.state.blend_set("NONE")
    if not bpy.app.timers.is_registered(_clear):
        bpy.app.timers.register(_clear, first_interval=pin_depths.seconds_shown(obj))


def _clear() -> None:
    redraw.views()


_drawn = InViews(_draw, "POST_VIEW")


def register() -> None:
    """Draw from now on."""
    _drawn.on()


def unregister() -> None:
    """Draw no more."""
    _drawn.off()
    if bpy.app.timers.is_registered(_clear):
        bpy.app.timers.unregister(_clear)
