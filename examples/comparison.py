# SPDX-License-Identifier: GPL-3.0-or-later
"""The same drags by each method, beside the distortion that each leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import planar_native
from contact_sheet import FINE, View
from planar_deform.model.posing.posing import Sample
from planar_deform.ui.draw import quality

METHODS = {"HOLD": "Hold Shape", "AKVF": "AKVF", "ARAP": "ARAP"}
STEPS = 40  # mouse positions of a way
GROUND = (52, 50, 56)
INK = (236, 234, 230)


@dataclass(frozen=True)
class Trial:
    """Ways that pins are led from rest, one after the other; only the pins named here are on."""

    name: str
    ways: Sequence[tuple[str, Sequence[Sample]]]
    holding: Sequence[str]

    @property
    def pins(self) -> set[str]:
        """All pins that are on."""
        return {*self.holding, *(pin for pin, _ in self.ways)}

    @property
    def returns(self) -> bool:
        """Whether all pins end where they began."""
        return all(way[-1] == (0.0, 0.0, 0.0) for _, way in self.ways)


def arc(offset: tuple[float, float], lift: float, turn: float) -> list[Sample]:
    """To an offset, in an arc that is `lift` above the straight way at its middle; turned by degrees."""
    share = np.linspace(0, 1, STEPS + 1)[1:]
    rise = 4 * lift * share * (1 - share)
    return [
        (offset[0] * t, offset[1] * t + r, np.radians(turn) * t) for t, r in zip(share, rise, strict=True)
    ]


def loop(radius: float) -> list[Sample]:
    """Round a circle that lies to the left of the start (to its right with a negative radius), and back."""
    angles = np.linspace(0, 2 * np.pi, STEPS + 1)[1:-1]
    return [*((radius * (np.cos(a) - 1), radius * np.sin(a), 0.0) for a in angles), (0.0, 0.0, 0.0)]


def coloured(
    view: View, points: np.ndarray, triangles: np.ndarray, measure: planar_native.Distortion
) -> Image.Image:
    """The triangles in the colours of the viewport's quality overlay, by angle distortion, with its scale."""
    paper = Image.new("RGB", (view.width * FINE, view.height * FINE), GROUND)
    draw = ImageDraw.Draw(paper)
    corners = (view.pixels(points) * FINE)[triangles]
    for shape, colour in zip(corners, _colours(quality.share(measure.triangle_angle)), strict=True):
        draw.polygon([tuple(corner) for corner in shape.tolist()], fill=colour)

    left, top, width, bottom = 20 * FINE, 18 * FINE, 96 * FINE, 27 * FINE
    for x, colour in enumerate(_colours(np.linspace(0, 1, width))):
        draw.line((left + x, top, left + x, bottom), fill=colour)
    font = ImageFont.load_default(13 * FINE)
    for value, text in (quality.TICKS[0], quality.TICKS[-1]):
        at = left + width * float(quality.share(value))
        draw.text((at, bottom + 5 * FINE), text, font=font, fill=INK, anchor="ma")
    return paper.resize((view.width, view.height), Image.Resampling.LANCZOS)


def _colours(shares: np.ndarray) -> list[tuple[int, int, int]]:
    colours = np.rint(255 * quality.colours(shares)[:, :3]).astype(int)
    return [(red, green, blue) for red, green, blue in colours.tolist()]
