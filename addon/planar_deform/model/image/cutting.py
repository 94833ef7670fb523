# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of an image's art, by the settings of a panel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ... import native
from ..plane.frame import Array, Indices
from ..work import Progress
from .art import OPAQUE, Alpha
from .glow import MUCH, share_cut_off
from .placement import Window


class NoArt(Exception):  # noqa: N818 - a reason, as a Refusal is
    """There is nothing to make a cutout of; the message says why, and what to do."""


@dataclass(frozen=True)
class Settings:
    """Lengths are in pixels; None: chosen by the length of edges, see native/include/planar/cutout.h."""

    vertices: int = 1500
    edge: float | None = None  # counts instead of the vertices
    margin: float | None = None
    threshold: float = 0.05
    holes: Literal["KEEP", "FILL"] = "KEEP"
    smallest: float | None = None  # of the art
    finest: float = 6.0


@dataclass(frozen=True)
class Drawing:
    """A cutout in pixels of its image."""

    points: Array  # n x 2, from the image's lower left corner
    triangles: Indices  # m x 3, counter-clockwise in the image
    islands: Indices  # n, the island of each point, from 0
    rings: list[Indices]  # the vertices along each closed boundary, the art on their left
    said: list[str]  # a sentence each

    def separated(self) -> list[Drawing]:
        """A drawing of each island, the largest first."""
        a, b, c = (self.points[self.triangles[:, corner]] for corner in range(3))
        areas = np.bincount(self.islands[self.triangles[:, 0]], _areas(b - a, c - a))
        return [self._island(number) for number in np.argsort(-areas, kind="stable").tolist()]

    def _island(self, number: int) -> Drawing:
        kept = np.flatnonzero(self.islands == number)
        row = np.full(len(self.points), -1, np.int32)
        row[kept] = np.arange(len(kept), dtype=np.int32)
        triangles = row[self.triangles[self.islands[self.triangles[:, 0]] == number]]
        rings = [row[ring] for ring in self.rings if self.islands[ring[0]] == number]
        return Drawing(self.points[kept], triangles, np.zeros(len(kept), np.int32), rings, [])


def cut(
    alpha: Alpha, settings: Settings, *, window: Window | None = None, progress: Progress | None = None
) -> Drawing:
    """The cutout of an image's art, of what its window shows. Takes no Blender data.

    Raises NoArt, native.Cancelled where `progress` returned False, and native.SolveError.
    """
    window = window or Window(0, 0, alpha.shape[1], alpha.shape[0])
    shown = alpha[window.bottom : window.top, window.left : window.right]
    if not (shown > settings.threshold * OPAQUE).any():
        raise NoArt(_why_empty(shown, settings.threshold))
    # No edge is longer than the image; the margin would be many times as wide, and take minutes.
    edge = None if settings.edge is None else min(settings.edge, float(max(shown.shape)))
    try:
        found = native.cutout(
            np.ascontiguousarray(shown),
            vertices=settings.vertices,
            edge=edge,
            margin=settings.margin,
            threshold=settings.threshold,
            holes=settings.holes,
            smallest=settings.smallest,
            finest=settings.finest,
            progress=progress,
        )
    except ValueError as error:  # an edge that makes millions of vertices, say
        raise NoArt(str(error)) from error
    said = list(found.said)
    if share_cut_off(shown, settings.threshold, found.points, found.rings) > MUCH:
        said.append("a soft glow is cut off: lower the Threshold")
    points = found.points + np.array([window.left, window.bottom], np.float64)
    return Drawing(points, found.triangles, found.parts, list(found.rings), said)


def _areas(first: Array, second: Array) -> Array:
    """Twice those of triangles with these two sides, k x 2."""
    areas: Array = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    return areas


def _why_empty(alpha: Alpha, threshold: float) -> str:
    most = alpha.max() / OPAQUE
    if most == 0.0:
        return "all of it is transparent: export it with its drawing visible"
    return f"no pixel of it has an alpha above the threshold of {threshold:.2f}: lower that below {most:.2f}"
