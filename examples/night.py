# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the lamplighter walks: a cobbled street at dusk, before hills and roofs; and its light and shadow."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageFilter
from shapely.geometry import box
from shapely.ops import unary_union

from contact_sheet import View
from drawing import Colour, Layer, blob, ellipse, moved

SKY = (
    ((36, 42, 88), 0.0),
    ((94, 78, 136), 0.45),
    ((206, 118, 116), 0.78),
    ((246, 176, 122), 0.92),
)  # from above
HILLS: Colour = (92, 66, 112)
ROOFS: Colour = (58, 44, 86)
STREET: Colour = (104, 86, 104)
STONES: Colour = (132, 112, 124)
WINDOW: Colour = (255, 214, 122)
LIGHT = (255, 206, 120)
KERB = 0.34  # how high above the ground line the street begins


def backdrop(view: View, scale: float = 2.0) -> Image.Image:
    """The street, the view's size times `scale`."""
    left, right = view.left, view.left + view.width * view.unit
    bottom, top = view.bottom, view.bottom + view.height * view.unit
    pixels = scale / view.unit
    size = (round(view.width * scale), round(view.height * scale))
    paper = _sky(size)
    layer = Layer("Backdrop", 1.0)
    _moon(layer, right - 1.1, top - 0.85)
    _land(layer, left, right, bottom)
    _street(layer, left, right, bottom)
    painted = layer.paint((left, bottom, right, top), pixels)
    paper.alpha_composite(painted.resize(size, Image.Resampling.LANCZOS))
    return paper


def glow(pixels: int = 128) -> Image.Image:
    """The light around a lantern, strongest in the middle."""
    at = np.linspace(-1.0, 1.0, pixels)
    far = np.hypot(at[:, None], at[None, :])
    strength = 0.62 * np.clip(1.0 - far, 0.0, 1.0) ** 2
    return _tinted(LIGHT, strength)


def shadow(width: int = 256, height: int = 48) -> Image.Image:
    """What the walker darkens of the street."""
    x, z = np.linspace(-1.0, 1.0, width), np.linspace(-1.0, 1.0, height)
    strength = 0.55 * np.clip(1.0 - np.hypot(z[:, None], x[None, :]), 0.0, 1.0) ** 0.8
    return _tinted((30, 20, 44), strength)


def _tinted(colour: Colour, strength: np.ndarray) -> Image.Image:
    image = Image.new("RGBA", strength.shape[::-1], (*colour, 0))
    image.putalpha(Image.fromarray(np.rint(255 * strength).astype(np.uint8)))
    return image


def _sky(size: tuple[int, int]) -> Image.Image:
    rows = np.linspace(0.0, 1.0, size[1])
    stops = [stop for _, stop in SKY]
    colours = np.stack([np.interp(rows, stops, [colour[i] for colour, _ in SKY]) for i in range(3)], axis=1)
    paper = Image.fromarray(np.rint(np.repeat(colours[:, None], size[0], axis=1)).astype(np.uint8), "RGB")
    return paper.convert("RGBA").filter(ImageFilter.GaussianBlur(2))


def _moon(layer: Layer, x: float, z: float) -> None:
    disc = ellipse(x, z, 0.36, 0.36)
    halo = ellipse(x, z, 1.5, 1.5)
    layer.gradient(ellipse(x, z, 0.55, 0.55), (255, 236, 200), inside=halo, blur=0.24, opacity=0.5)
    layer.fill(disc, (255, 244, 214), shade=0.0, outline=False)
    layer.fill(moved(disc, -0.13, 0.07).intersection(disc), (255, 250, 236), shade=0.0, outline=False)
    for dx, dz, size in ((-0.10, 0.12, 0.07), (0.12, -0.02, 0.05), (-0.02, -0.16, 0.06)):
        layer.fill(ellipse(x + dx, z + dz, size, size), (240, 222, 186), shade=0.0, outline=False)
    rng = np.random.default_rng(7)
    for dx, dz in rng.uniform((-6.4, -1.1), (0.6, 0.7), (26, 2)):
        if np.hypot(dx, dz) > 0.8:
            layer.fill(ellipse(x + dx, z + dz, 0.016, 0.016), (255, 246, 226), shade=0.0, outline=False)


def _land(layer: Layer, left: float, right: float, bottom: float) -> None:
    ground = box(left - 1, bottom - 1, right + 1, KERB)
    waves = [
        (x, 1.15 + 0.32 * np.sin(1.1 * x + 0.4) + 0.16 * np.sin(2.3 * x))
        for x in np.linspace(left - 1, right + 1, 24)
    ]
    hills = unary_union([blob([*waves, (right + 1, KERB - 0.3), (left - 1, KERB - 0.3)]), ground])
    layer.fill(hills, HILLS, shade=0.0, outline=False)
    rng = np.random.default_rng(3)
    x = left - 0.3
    while x < right:
        width, height = rng.uniform(0.62, 0.95), rng.uniform(0.42, 0.72)
        _house(layer, x, width, height, chimney=rng.uniform(0.15, 0.7), lit=rng.uniform() < 0.75)
        x += width + rng.uniform(0.02, 0.55)


def _house(layer: Layer, x: float, width: float, height: float, chimney: float, lit: bool) -> None:
    wall = box(x, KERB - 0.1, x + width, KERB + height)
    top = KERB + height
    roof = blob([
        (x - 0.07, top, "corner"), (x + 0.5 * width, top + 0.48 * width, "corner"),
        (x + width + 0.07, top, "corner"), (x + 0.5 * width, top - 0.01),
    ])  # fmt: skip
    stack = box(x + chimney * width, top, x + chimney * width + 0.1, top + 0.5 * width)
    layer.fill(unary_union([wall, roof, stack]), ROOFS, shade=0.0, outline=False)
    layer.fill(roof, (74, 54, 98), shade=0.0, outline=False)
    for share in (0.28, 0.66):
        pane = box(
            x + share * width - 0.05,
            KERB + 0.5 * height,
            x + share * width + 0.06,
            KERB + 0.5 * height + 0.15,
        )
        layer.fill(pane, WINDOW if lit and share < 0.5 else (88, 72, 118), shade=0.0, outline=False)


def _street(layer: Layer, left: float, right: float, bottom: float) -> None:
    layer.fill(box(left - 1, bottom - 1, right + 1, KERB), STREET, shade=0.0, outline=False)
    rng = np.random.default_rng(5)
    for row, (low, high) in enumerate(((0.20, 0.31), (0.04, 0.18), (-0.16, 0.02), (-0.42, -0.18))):
        x = left - 0.2 - 0.21 * (row % 2)
        while x < right + 0.2:
            width = (0.34 + 0.10 * row) * rng.uniform(0.85, 1.15)
            stone = box(x + 0.03, low + 0.03, x + width - 0.03, high - 0.03).buffer(0.028)
            shade = tuple(round(part + rng.uniform(-7, 7)) for part in STONES)
            layer.fill(stone, shade, shade=0.025, outline=False)
            x += width
    layer.fill(box(left - 1, KERB - 0.02, right + 1, KERB + 0.03), (150, 126, 132), shade=0.0, outline=False)
