# SPDX-License-Identifier: GPL-3.0-or-later
"""The outline and the mesh of cutouts that have just been made."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ...scene.image import preview
from ...scene.image.preview import Preview
from . import marks
from .in_views import InViews
from .mesh_edges import EDGES

CLASSES = ()

OUTLINE = (1.0, 0.55, 0.1, 1.0)
WIDTH = 2.0  # of the outline, in pixels at a resolution scale of 1

_made: WeakKeyDictionary[Preview, tuple[gpu.types.GPUBatch, gpu.types.GPUBatch]] = WeakKeyDictionary()


def _draw() -> None:
    context = bpy.context
    shown = preview.now(context)
    if shown is None or not context.space_data.overlay.show_overlays:
        return
    thin = gpu.shader.from_builtin("UNIFORM_COLOR")
    wide = marks.pen(OUTLINE, WIDTH * context.preferences.system.ui_scale)
    batches = _made.get(shown)
    if batches is None:
        content = {"pos": shown.points}
        batches = _made[shown] = (
            batch_for_shader(thin, "LINES", content, indices=shown.edges),
            batch_for_shader(wide, "LINES", content, indices=shown.outline),
        )
    edges, outline = batches
    gpu.state.blend_set("ALPHA")
    thin.bind()
    thin.uniform_float("color", EDGES)
    edges.draw(thin)
    wide.bind()
    outline.draw(wide)
    gpu.state.blend_set("NONE")


_drawn = InViews(_draw, "POST_VIEW")


def register() -> None:
    _drawn.on()


def unregister() -> None:
    _drawn.off()
    _made.clear()
