# SPDX-License-Identifier: GPL-3.0-or-later
"""Marks and words drawn in pixels.

Of pins, a disc is a point, a square that turns is a patch, a square on its corner is a point of a lattice. Of
joints, which are drawn as rings, a round one is a hinge, a square one is a weld.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix, Vector

from ...preferences import DEFAULT, looks

RADIUS = DEFAULT.size  # pixels at a UI scale of 1, as all lengths here; the user may want pins larger
OUTLINE = 2.0
TEXT = 11.0

PLAIN = DEFAULT.pin  # of words
OFF = (0.45, 0.45, 0.47, 0.55)
RIM = (0.04, 0.04, 0.05, 0.95)
LIT = (1.0, 1.0, 1.0, 1.0)
FAINT = (0.90, 0.91, 0.93, 0.35)
MISSED = (1.0, 0.22, 0.20, 1.0)

Colour = tuple[float, ...]  # red, green, blue and alpha
Corners = list[tuple[float, float]]

_TURNS = 32
_CIRCLE = [(math.cos(math.tau * i / _TURNS), math.sin(math.tau * i / _TURNS)) for i in range(_TURNS)]
_SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
_DIAMOND = [(-1.35, 0.0), (0.0, -1.35), (1.35, 0.0), (0.0, 1.35)]  # looks as large as the disc
_batches: dict[str, gpu.types.GPUBatch] = {}


@contextmanager
def pixels(region: bpy.types.Region) -> Iterator[None]:
    """Draw in the region's pixels, blended."""
    w, h = region.width, region.height
    to_clip = Matrix(((2 / w, 0, 0, -1), (0, 2 / h, 0, -1), (0, 0, -1, 0), (0, 0, 0, 1)))
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(Matrix())
        gpu.matrix.load_projection_matrix(to_clip)
        gpu.state.blend_set("ALPHA")
        try:
            yield
        finally:
            gpu.state.blend_set("NONE")


def draw_point(centre: Vector, scale: float, fill: Colour, *, lit: bool, active: bool) -> None:
    """A point pin."""
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        _shape("disc", _CIRCLE, RADIUS * scale, fill)
        _rim("circle", _CIRCLE, RADIUS * scale, scale, lit)
        _dot(scale, active)


def draw_lattice_point(centre: Vector, scale: float, fill: Colour, *, lit: bool, active: bool) -> None:
    """A pin on a point of a lattice."""
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        _shape("diamond", _DIAMOND, RADIUS * scale, fill)
        _rim("rhomb", _DIAMOND, RADIUS * scale, scale, lit)
        _dot(scale, active)


def draw_patch(
    centre: Vector, turned: Vector, scale: float, fill: Colour, *, lit: bool, active: bool
) -> None:
    """A patch pin, turned so that its handle points along `turned`."""
    radius = RADIUS * scale
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        gpu.matrix.multiply_matrix(Matrix.Rotation(math.atan2(turned.y, turned.x), 4, "Z"))
        start, end = Vector((radius, 0.0)), Vector((radius * 2.4, 0.0))
        _line(start, end, RIM, 2.0 * OUTLINE * scale)
        _line(start, end, LIT if lit else fill, OUTLINE * scale)
        _shape("box", _SQUARE, radius * 0.92, fill)
        _rim("square", _SQUARE, radius * 0.92, scale, lit)
        _dot(scale, active)


def draw_joint(centre: Vector, scale: float, fill: Colour, *, rigid: bool, lit: bool, active: bool) -> None:
    """A joint of two parts: a ring, between which the drawing is seen."""
    name, corners = ("square", _SQUARE) if rigid else ("circle", _CIRCLE)
    radius = RADIUS * scale * (0.92 if rigid else 1.0)
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        _outline(name, corners, radius, RIM, 3.0 * OUTLINE * scale)
        _outline(name, corners, radius, LIT if lit else fill, 1.5 * OUTLINE * scale)
        _dot(scale, active)


def draw_ring(centre: Vector, radius: float, knob: Vector, scale: float, *, lit: bool) -> None:
    """The ring that turns pins, with a knob in a direction of length 1."""
    color = LIT if lit else looks().selected
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        _outline("circle", _CIRCLE, radius, RIM, (2.5 if lit else 1.75) * OUTLINE * scale)
        _outline("circle", _CIRCLE, radius, color, (1.25 if lit else 0.75) * OUTLINE * scale)
        gpu.matrix.translate((knob.x * radius, knob.y * radius))
        _shape("disc", _CIRCLE, RADIUS * 0.8 * scale, color)
        _outline("circle", _CIRCLE, RADIUS * 0.8 * scale, RIM, OUTLINE * scale)


def draw_size_ring(centre: Vector, radius: float, scale: float) -> None:
    """The ring of a point, which turns nothing: it is there to be dragged into a patch."""
    with gpu.matrix.push_pop():
        gpu.matrix.translate((centre.x, centre.y))
        _outline("circle", _CIRCLE, radius, FAINT, 0.75 * OUTLINE * scale)


def draw_strip(corners: Iterable[tuple[float, float]], scale: float) -> None:
    """A line along corners."""
    content = {"pos": list(corners)}
    for color, width in ((RIM, 1.5 * OUTLINE), (PLAIN, 0.5 * OUTLINE)):
        shader = pen(color, width * scale)
        batch_for_shader(shader, "LINE_STRIP", content).draw(shader)


def draw_text(x: float, y: float, text: str, scale: float, *, centred: bool = False) -> None:
    """Words on the drawing."""
    font = 0
    blf.size(font, TEXT * scale)
    blf.color(font, *PLAIN)
    blf.enable(font, blf.SHADOW)
    blf.shadow(font, 5, *RIM)
    blf.position(font, x - 0.5 * blf.dimensions(font, text)[0] * centred, y, 0)
    blf.draw(font, text)
    blf.disable(font, blf.SHADOW)


def draw_gap(place: Vector, target: Vector, scale: float) -> None:
    """From where a pin is to where it was asked to be."""
    _line(place, target, RIM, 2.0 * OUTLINE * scale)
    _line(place, target, MISSED, OUTLINE * scale)
    with gpu.matrix.push_pop():
        gpu.matrix.translate((target.x, target.y))
        _outline("circle", _CIRCLE, RADIUS * 0.6 * scale, RIM, 2.0 * OUTLINE * scale)
        _outline("circle", _CIRCLE, RADIUS * 0.6 * scale, MISSED, OUTLINE * scale)


def draw_box(left: float, bottom: float, right: float, top: float, colour: Colour) -> None:
    """A box, filled."""
    with gpu.matrix.push_pop():
        gpu.matrix.translate((0.5 * (left + right), 0.5 * (bottom + top)))
        gpu.matrix.scale((0.5 * (right - left), 0.5 * (top - bottom)))
        _shape("box", _SQUARE, 1.0, colour)


def forget() -> None:
    """Drop what was made for the graphics card."""
    _batches.clear()


def _dot(scale: float, active: bool) -> None:
    """In the middle of the active pin."""
    if active:
        _shape("disc", _CIRCLE, RADIUS * scale * 0.36, RIM)


def _rim(name: str, corners: Corners, radius: float, scale: float, lit: bool) -> None:
    if lit:
        _outline(name, corners, radius + 1.5 * scale, RIM, 2.5 * OUTLINE * scale)
        _outline(name, corners, radius + 0.5 * scale, LIT, 1.25 * OUTLINE * scale)
    else:
        _outline(name, corners, radius, RIM, OUTLINE * scale)


def _shape(name: str, corners: Corners, radius: float, color: Colour) -> None:
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    if name not in _batches:
        triangles = [(0, i, i + 1) for i in range(1, len(corners) - 1)]
        _batches[name] = batch_for_shader(shader, "TRIS", {"pos": corners}, indices=triangles)
    shader.bind()
    shader.uniform_float("color", color)
    with gpu.matrix.push_pop():
        gpu.matrix.scale_uniform(radius)
        _batches[name].draw(shader)


def _outline(name: str, corners: Corners, radius: float, color: Colour, width: float) -> None:
    shader = pen(color, width)
    if name not in _batches:
        _batches[name] = batch_for_shader(shader, "LINE_STRIP", {"pos": [*corners, corners[0], corners[1]]})
    with gpu.matrix.push_pop():
        gpu.matrix.scale_uniform(radius)
        _batches[name].draw(shader)


def _line(start: Vector, end: Vector, color: Colour, width: float) -> None:
    shader = pen(color, width)
    if "line" not in _batches:
        _batches["line"] = batch_for_shader(shader, "LINES", {"pos": [(0.0, 0.0), (1.0, 0.0)]})
    along = end - start
    with gpu.matrix.push_pop():
        gpu.matrix.translate((start.x, start.y))
        gpu.matrix.multiply_matrix(Matrix.Rotation(math.atan2(along.y, along.x), 4, "Z"))
        gpu.matrix.scale_uniform(along.length)
        _batches["line"].draw(shader)


def pen(color: Colour, width: float) -> gpu.types.GPUShader:
    """What draws lines of a width in pixels."""
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("color", color)
    shader.uniform_float("lineWidth", width)
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    return shader
