# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a cutout with Cycles and lays the pictures out on a labelled sheet."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

PAPER = (250, 245, 234)
INK = (62, 48, 58)
PIN = (238, 70, 92)
SAMPLES = 16
FINE = 2  # marks are drawn at twice the size and scaled down
GAP = 18
CAPTION = 44


@dataclass(frozen=True)
class View:
    """What a cell shows of the front view: lower left corner (x, z), world units a pixel, size in pixels."""

    left: float
    bottom: float
    unit: float
    width: int
    height: int

    @classmethod
    def around(cls, centre_x: float, bottom: float, height_units: float, width: int, height: int) -> View:
        """A view of a cell's size, centred at x, `height_units` tall from `bottom`."""
        unit = height_units / height
        return cls(centre_x - 0.5 * width * unit, bottom, unit, width, height)

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """World points n x 2 (x, z) in pixels from the upper left."""
        return (
            np.column_stack(
                [(points[:, 0] - self.left), self.height * self.unit - (points[:, 1] - self.bottom)]
            )
            / self.unit
        )


def prepare_scene(scene: bpy.types.Scene) -> None:
    """Sets a front camera, Cycles on the CPU with few samples, and colours as drawn."""
    camera = bpy.data.cameras.new("Front")
    camera.type = "ORTHO"
    scene.camera = bpy.data.objects.new("Front", camera)
    scene.camera.rotation_euler = (np.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(scene.camera)
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.transparent_max_bounces = 16


@contextmanager
def silenced_blender() -> Iterator[TextIO]:
    """Drops what Blender's C code prints while it renders and saves, a line for each sample.

    Gives where to print meanwhile.
    """
    sys.stdout.flush()
    with os.fdopen(os.dup(1), "w") as kept, Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            yield kept
        finally:
            os.dup2(kept.fileno(), 1)


def place_camera(scene: bpy.types.Scene, view: View) -> None:
    """Makes the scene's pictures show the view."""
    camera = scene.camera
    camera.data.ortho_scale = max(view.width, view.height) * view.unit
    camera.location = (
        view.left + 0.5 * view.width * view.unit,
        -10.0,
        view.bottom + 0.5 * view.height * view.unit,
    )
    scene.render.resolution_x, scene.render.resolution_y = view.width, view.height


def render(scene: bpy.types.Scene, view: View) -> Image.Image:
    """The scene through a view, transparent where there is nothing."""
    place_camera(scene, view)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "view.png")
        with silenced_blender():
            bpy.ops.render.render(write_still=True)
        with Image.open(scene.render.filepath) as picture:
            return picture.convert("RGBA")


def cell(
    picture: Image.Image, view: View, points: np.ndarray, pins: Mapping[str, np.ndarray], patches: set[str],
    ground: tuple[int, int, int], mesh_edges: np.ndarray | None = None,
) -> Image.Image:  # fmt: skip
    """A picture on coloured ground with its shadow at z = 0, its pins (patches as squares), and its edges."""
    size = (view.width * FINE, view.height * FINE)
    paper = Image.new("RGB", size, ground)
    shadow = Image.new("L", size)
    pixels = view.pixels(points) * FINE
    floor = view.pixels(np.array([[0.0, 0.0]]))[0, 1] * FINE
    left, right = pixels[:, 0].min(), pixels[:, 0].max()
    # The higher the drawing floats above the ground, the narrower and fainter its shadow.
    lift = max(0.0, points[:, 1].min())
    shrink = 0.14 * (right - left) * (1 + min(lift, 1.0))
    ImageDraw.Draw(shadow).ellipse(
        (left + shrink, floor - 16, right - shrink, floor + 16), fill=round(120 - 50 * min(lift, 1.0))
    )
    paper.paste(Image.new("RGB", size, INK), mask=shadow.filter(ImageFilter.GaussianBlur(9)))
    large = picture.resize(size, Image.Resampling.LANCZOS)
    paper.paste(large, mask=large.getchannel("A"))

    draw = ImageDraw.Draw(paper, "RGBA")
    if mesh_edges is not None:
        for a, b in pixels[mesh_edges]:
            draw.line((*a, *b), fill=(255, 255, 255, 120), width=1)
    radius = 7 * FINE // 2 + 3
    for name, point in pins.items():
        x, y = view.pixels(point[None])[0] * FINE
        box = (x - radius, y - radius, x + radius, y + radius)
        (draw.rectangle if name in patches else draw.ellipse)(box, fill=PIN, outline=(255, 255, 255), width=4)
    return paper.resize((view.width, view.height), Image.Resampling.LANCZOS)


def sheet(title: str, rows: Sequence[Sequence[tuple[str, str, Image.Image]]]) -> Image.Image:
    """Rows of cells (label, note, picture) of equal total width under a title."""
    width = max(sum(c.width for _, _, c in row) + GAP * (len(row) + 1) for row in rows)
    height = 84 + sum(row[0][2].height + CAPTION + GAP for row in rows)
    page = Image.new("RGB", (width, height), PAPER)
    draw = ImageDraw.Draw(page)
    draw.text((GAP + 2, 24), title, font=ImageFont.load_default(34), fill=INK)
    y = 84
    for row in rows:
        x = GAP
        for label, note, picture in row:
            mask = Image.new("L", picture.size)
            ImageDraw.Draw(mask).rounded_rectangle(
                (0, 0, picture.width - 1, picture.height - 1), 14, fill=255
            )
            page.paste(picture, (x, y), mask)
            font = ImageFont.load_default(22)
            draw.text((x + 6, y + picture.height + 7), label, font=font, fill=INK)
            indent = x + 6 + draw.textlength(label, font=font) + 12
            draw.text(
                (indent, y + picture.height + 12), note, font=ImageFont.load_default(16), fill=(130, 116, 122)
            )
            x += picture.width + GAP
        y += row[0][2].height + CAPTION + GAP
    return page
