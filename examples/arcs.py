# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens beside linear blending of the same two poses, with the ways that some points take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from PIL import Image, ImageDraw

import contact_sheet
import planar_native
from contact_sheet import FINE, PIN, View
from planar_deform.scene.inbetweens import planning
from planar_deform.scene.objects.any_object import read_shape

SHARES = np.linspace(0.0, 1.0, 5)  # of the way, one a picture
FINELY = np.linspace(0.0, 1.0, 61)  # where ways are sampled
PAPER_CELL, BAR, BAR_EDGE = (226, 232, 238), (120, 170, 200), (70, 110, 140)

Cell = tuple[str, str, Image.Image]  # label, note, picture


@dataclass(frozen=True)
class Motion:
    """Frames of a way from one pose to another, f x n x 2 (x, z): at SHARES, and at FINELY."""

    name: str
    frames: np.ndarray
    ways: np.ndarray


def linear(before: np.ndarray, after: np.ndarray) -> Motion:
    """What a shape key's value does."""
    frames, ways = (
        (1 - share)[:, None, None] * before + share[:, None, None] * after for share in (SHARES, FINELY)
    )
    return Motion("Linear", frames, ways)


def generated(obj: bpy.types.Object, poses: tuple[int, int]) -> tuple[Motion, Motion]:
    """Both between two of an object's keyed poses: blended, and what the add-on generates."""
    way = planning.way(read_shape(obj), poses, (0.0, 1.0))
    motion = way.motion()
    return linear(*way.keys), Motion("In-between", motion.at(SHARES), motion.at(FINELY))


def rows(
    obj: bpy.types.Object, motions: Sequence[Motion], marked: Sequence[int], view: View,
    ground: tuple[int, int, int], rest: np.ndarray, triangles: np.ndarray,
) -> list[list[Cell]]:  # fmt: skip
    """A row of pictures for each motion, with the ways of the marked vertices.

    The view is relative to where the object stands. A stand-in is rendered.
    """
    shown = View(view.left + obj.location.x, view.bottom, view.unit, view.width, view.height)
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    stand_in = bpy.data.objects.new("Stand-in", bpy.data.meshes.new_from_object(shape))
    stand_in.location = obj.location
    bpy.context.scene.collection.objects.link(stand_in)
    hidden, obj.hide_render = obj.hide_render, True
    found = []
    for motion in motions:
        cells = []
        for share, points in zip(SHARES, motion.frames, strict=True):
            coordinates = np.empty(3 * len(points), np.float32)
            stand_in.data.vertices.foreach_get("co", coordinates)
            coordinates.reshape(-1, 3)[:, (0, 2)] = points
            stand_in.data.vertices.foreach_set("co", coordinates)
            stand_in.data.update()
            picture = contact_sheet.cell(
                contact_sheet.render(bpy.context.scene, shown), view, points, {}, set(), ground
            )
            draw_ways(picture, view, motion, marked, points)
            measure = planar_native.distortion(rest, points, triangles)
            cells.append((f"{motion.name} {100 * share:.0f} %", f"area {measure.area:.2f}", picture))
        found.append(cells)
    obj.hide_render = hidden
    bpy.data.meshes.remove(stand_in.data)  # and with it the stand-in
    return found


def bar_rows(degrees: float) -> list[list[Cell]]:
    """The same of a bar that is rolled up."""
    columns, height = 60, 0.06
    along, across = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(-height, height, 5))
    rest = np.column_stack([along.ravel(), across.ravel()])
    a = (np.arange(columns) + (columns + 1) * np.arange(4)[:, None]).ravel()
    above = a + columns + 1
    triangles = np.concatenate(
        [np.column_stack([a, a + 1, above]), np.column_stack([a + 1, above + 1, above])]
    )
    radius = 1 / np.radians(degrees)
    turn = (rest[:, 0] - 0.5) / radius
    rolled = np.column_stack(
        [0.5 + (radius - rest[:, 1]) * np.sin(turn), radius - (radius - rest[:, 1]) * np.cos(turn)]
    )
    frames, ways = (
        planar_native.inbetween([rest, rolled], shares, triangles=triangles) for shares in (SHARES, FINELY)
    )
    view = View.around(0.5, -0.22, 0.75, 350, 190)
    corners = [0, columns, 4 * (columns + 1), 5 * (columns + 1) - 1]
    motions = linear(rest, rolled), Motion("In-between", frames, ways)
    return mesh_rows(motions, rest, triangles, corners, view)


def mesh_rows(
    motions: Sequence[Motion], rest: np.ndarray, triangles: np.ndarray, marked: Sequence[int], view: View
) -> list[list[Cell]]:
    """A row of drawn meshes for each motion, with the ways of the marked vertices."""
    found = []
    for motion in motions:
        cells = []
        for share, points in zip(SHARES, motion.frames, strict=True):
            picture = Image.new("RGB", (view.width * FINE, view.height * FINE), PAPER_CELL)
            draw = ImageDraw.Draw(picture)
            pixels = view.pixels(points) * FINE
            for corner in triangles:
                draw.polygon([tuple(pixels[i]) for i in corner], fill=BAR, outline=BAR_EDGE)
            picture = picture.resize((view.width, view.height), Image.Resampling.LANCZOS)
            draw_ways(picture, view, motion, marked, points)
            measure = planar_native.distortion(rest, points, triangles)
            cells.append((f"{motion.name} {100 * share:.0f} %", f"area {measure.area:.2f}", picture))
        found.append(cells)
    return found


def draw_ways(
    picture: Image.Image, view: View, motion: Motion, marked: Sequence[int], points: np.ndarray
) -> None:
    """Draws the ways of some vertices on a picture, and where on it they are."""
    large = Image.new("RGBA", (view.width * FINE, view.height * FINE))
    draw = ImageDraw.Draw(large)
    for vertex in marked:
        way = view.pixels(motion.ways[:, vertex]) * FINE
        draw.line([tuple(point) for point in way.tolist()], fill=(*PIN, 255), width=2 * FINE, joint="curve")
        for x, y in (view.pixels(motion.frames[:, vertex]) * FINE).tolist():
            draw.ellipse((x - 5, y - 5, x + 5, y + 5), fill=(255, 255, 255), outline=PIN, width=2)
        x, y = view.pixels(points[vertex][None])[0] * FINE
        draw.ellipse((x - 9, y - 9, x + 9, y + 9), fill=PIN, outline=(255, 255, 255), width=3)
    small = large.resize(picture.size, Image.Resampling.LANCZOS)
    picture.paste(small, mask=small.getchannel("A"))
