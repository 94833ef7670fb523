# SPDX-License-Identifier: GPL-3.0-or-later
"""Onion skin: outlines of the poses keyed before and behind the present frame."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import bpy
import gpu
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ...scene.view import onion
from ...scene.view.onion import Onion
from . import marks
from .in_views import InViews
from .marks import Colour

CLASSES = ()

# Green and blue as Grease Pencil's, lighter, to be seen on a dark view as well.
BEFORE = (0.22, 0.68, 0.20, 0.9)
BEHIND = (0.30, 0.42, 1.0, 0.9)
WIDTH = 1.75  # pixels at a UI scale of 1


Skins = tuple[tuple[Colour, gpu.types.GPUBatch], ...]  # colour and outline of each

_made: WeakKeyDictionary[Onion, Skins] = WeakKeyDictionary()  # for as long as that is kept


def _draw() -> None:
    context = bpy.context
    if not context.space_data.overlay.show_overlays or context.screen.is_animation_playing:
        return  # as Grease Pencil does: the motion is to be seen
    seen = onion.of_active(context)
    if seen is None or not context.object.visible_get(viewport=context.space_data):
        return
    width = WIDTH * context.preferences.system.ui_scale
    skins = _made.get(seen)
    if skins is None:
        pen = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        skins = _made[seen] = tuple(
            (colour, batch_for_shader(pen, "LINES", {"pos": shape[seen.edges.ravel()]}))
            for colour, shape in ((BEFORE, seen.before), (BEHIND, seen.behind))
            if shape is not None
        )
    gpu.state.blend_set("ALPHA")
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(Matrix(context.object.matrix_world))
        for colour, skin in skins:
            skin.draw(marks.pen(colour, width))
    gpu.state.blend_set("NONE")


_drawn = InViews(_draw, "POST_VIEW")


def register() -> None:
    _drawn.on()


def unregister() -> None:
    _drawn.off()
    _made.clear()
