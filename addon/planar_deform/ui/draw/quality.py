# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours on the drawing for how much its pose distorts it, with a legend."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from numpy.typing import NDArray

from ...model.plane.frame import Array, Array32
from ...scene.pins.pin_list import has_pins
from ...scene.view import snapshot
from ...scene.view.snapshot import Snapshot
from . import marks, vertices
from .in_views import InViews

CLASSES = ()

# 2 is no distortion. Equal steps of colour are equal ratios of stretch s, as distortion is s + 1/s; the scale
# ends where a triangle has twice the area, or is stretched to twice its width.
WORST = 2.5
TICKS = ((2.0, "2"), (2.05, "2.05"), (2.2, "2.2"), (WORST, "2.5+"))

# From little to much: ever darker, from blue to red, which colour-blind people tell apart. The drawing is
# seen through it, the less the more it is distorted.
_STOPS = np.array(
    [
        (0.78, 0.90, 0.98, 0.45),
        (0.99, 0.86, 0.50, 0.72),
        (0.97, 0.60, 0.24, 0.82),
        (0.85, 0.23, 0.14, 0.88),
        (0.47, 0.00, 0.14, 0.92),
    ]
)
_STEPS = 256
_SCALE = np.stack(
    [np.interp(np.linspace(0, 1, _STEPS), np.linspace(0, 1, len(_STOPS)), stop) for stop in _STOPS.T], axis=1
).astype(np.float32)
FLIPPED = (0.80, 0.0, 0.85, 1.0)
# The same in bytes, behind them what is flipped.
_BYTES = np.rint(255.0 * np.concatenate([_SCALE, np.array([FLIPPED])])).astype(np.uint8)

# Pixels at a UI scale of 1.
BAR = (180.0, 10.0)
MARGIN, GAP = 16.0, 5.0
BORDER = 3.0
BACK = (0.08, 0.08, 0.09, 0.80)


@dataclass(frozen=True)
class _Made:
    """What the graphics card has for one snapshot."""

    kind: str
    fill: gpu.types.GPUBatch
    flipped: gpu.types.GPUBatch | None


_made: WeakKeyDictionary[Snapshot, _Made] = WeakKeyDictionary()  # for as long as that is kept
_bar: gpu.types.GPUBatch | None = None


def colours(shares: Array) -> Array32:
    """The colours (k x 4 float32) of places (k,) on the scale, from 0 to 1."""
    result: Array32 = _SCALE[_place(shares)]
    return result


def _place(shares: Array) -> NDArray[np.intp]:
    result: NDArray[np.intp] = np.rint(shares * (_STEPS - 1)).astype(np.intp)
    return result


def share(distortion: Array | float) -> Array:
    """Where values of distortion, from 2 to infinity, are on the scale."""
    result: Array = np.minimum(np.arccosh(np.maximum(distortion, 2.0) / 2.0) / np.arccosh(WORST / 2.0), 1.0)
    return result


def _shown(context: bpy.types.Context) -> tuple[Snapshot, str] | None:
    """The snapshot to colour, and by what; None where there is nothing to show."""
    obj = context.object
    if context.mode != "OBJECT" or not has_pins(obj) or obj.planar.show_quality == "OFF":
        return None
    if not context.space_data.overlay.show_overlays:
        return None
    seen = snapshot.in_view(context)
    return None if seen is None or seen.distortion is None else (seen, obj.planar.show_quality)


def _draw_colours() -> None:
    shown = _shown(bpy.context)
    if shown is None:
        return
    seen, kind = shown
    made = _made.get(seen)
    if made is None or made.kind != kind:
        made = _made[seen] = _make(seen, kind)
    gpu.state.blend_set("ALPHA")
    made.fill.draw(gpu.shader.from_builtin("FLAT_COLOR"))
    if made.flipped is not None:
        made.flipped.draw(marks.pen(FLIPPED, BORDER * bpy.context.preferences.system.ui_scale))
    gpu.state.blend_set("NONE")


def _make(seen: Snapshot, kind: str) -> _Made:
    distortion = seen.distortion
    assert distortion is not None
    flipped = distortion.triangle_flipped
    values = distortion.triangle_area if kind == "AREA" else distortion.triangle_angle
    places = np.where(flipped, _STEPS, _place(share(values)))
    points = seen.points.astype(np.float32)
    corners = gpu.types.GPUVertBuf(vertices.places(coloured=True), 3 * len(seen.triangles))
    corners.attr_fill("pos", np.take(points, seen.triangles.ravel(), axis=0))
    corners.attr_fill("color", np.repeat(_BYTES[places], 3, axis=0))
    fill = gpu.types.GPUBatch(type="TRIS", buf=corners)
    border = None
    if flipped.any():
        sides = seen.triangles[flipped][:, [0, 1, 1, 2, 2, 0]].ravel()
        pen = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        border = batch_for_shader(pen, "LINES", {"pos": points[sides]})
    return _Made(kind, fill, border)


def _draw_legend() -> None:
    context = bpy.context
    shown = _shown(context)
    if shown is None:
        return
    seen, kind = shown
    assert seen.distortion is not None
    scale = context.preferences.system.ui_scale
    width, height = BAR[0] * scale, BAR[1] * scale
    margin, gap, line = MARGIN * scale, GAP * scale, marks.TEXT * scale * 1.35
    right = (
        _right_edge(context) - margin - 4.0 * gap
    )  # where the bar ends, whose last number is centred there
    left, bottom = right - width, margin + gap
    rows = 3 if seen.distortion.flipped else 2
    top = bottom + rows * line + height + (rows - 1) * gap
    gpu.state.blend_set("ALPHA")
    marks.draw_box(left - 2.0 * gap, margin - gap, right + 4.0 * gap, top + gap, BACK)
    y = top - line
    marks.draw_text(left, y, f"{kind.title()} Distortion (2 is none)", scale)
    y -= gap + height
    _draw_bar(left, y, width, height)
    y -= line
    for value, text in TICKS:
        x = left + float(share(value)) * width
        marks.draw_box(x - 0.5 * scale, y + line - 0.5 * gap, x + 0.5 * scale, y + line, marks.PLAIN)
        marks.draw_text(x, y, text, scale, centred=value > 2.0)
    if seen.distortion.flipped:
        y -= line + gap
        marks.draw_box(left, y, left + 1.5 * height, y + height, FLIPPED)
        marks.draw_text(left + 1.5 * height + gap, y, f"Flipped: {seen.distortion.flipped}", scale)
    gpu.state.blend_set("NONE")


def _right_edge(context: bpy.types.Context) -> float:
    """Where the part of the view begins that the sidebar covers."""
    sidebar = next((region for region in context.area.regions if region.type == "UI"), None)
    width: float = context.region.width
    if sidebar is not None and sidebar.width > 1 and context.preferences.system.use_region_overlap:
        width -= sidebar.width
    return width


def _draw_bar(left: float, bottom: float, width: float, height: float) -> None:
    global _bar
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    if _bar is None:
        shares = np.repeat(np.linspace(0.0, 1.0, 33), 2)
        content = {"pos": np.stack([shares, np.tile([0.0, 1.0], 33)], axis=1).astype(np.float32)}
        content["color"] = colours(shares)
        content["color"][:, 3] = 1.0
        _bar = batch_for_shader(shader, "TRI_STRIP", content)
    with gpu.matrix.push_pop():
        gpu.matrix.translate((left, bottom))
        gpu.matrix.scale((width, height))
        _bar.draw(shader)


_drawn = InViews(_draw_colours, "POST_VIEW"), InViews(_draw_legend, "POST_PIXEL")


def register() -> None:
    """Draw from now on."""
    for drawn in _drawn:
        drawn.on()


def unregister() -> None:
    """Draw no more."""
    global _bar
    for drawn in _drawn:
        drawn.off()
    _made.clear()
    _bar = None
