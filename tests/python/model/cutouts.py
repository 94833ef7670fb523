# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts and pins to test on."""

import numpy as np

from planar_deform.model.plane.cutout import Cutout, make_cutout
from planar_deform.model.posing.pins import Pin


def grid_cutout(nx: int, ny: int) -> Cutout:
    """A grid of nx x ny unit squares, vertex j * (nx + 1) + i at (i, j)."""
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0))
    rest = np.stack([x.ravel(), y.ravel()], axis=1)
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    lower = np.stack([first, first + 1, first + nx + 2], axis=1)
    upper = np.stack([first, first + nx + 2, first + nx + 1], axis=1)
    return make_cutout(rest, np.concatenate([lower, upper]).astype(np.int32), np.zeros(len(rest), np.int32))


def pin(vertices, *, key=0, kind="POINT", weights=None, **options) -> Pin:
    vertices = np.array(vertices, np.int32)
    weights = np.ones(len(vertices)) if weights is None else np.array(weights, float)
    return Pin(key, kind, vertices, weights, **options)


def rectangles(*boxes, cell=0.2) -> Cutout:
    """A part for each box (left, bottom, right, top), of cells about so large."""
    rest, triangles, parts = [], [], []
    for part, (left, bottom, right, top) in enumerate(boxes):
        shorter = min(right - left, top - bottom)
        step = min(cell, shorter / 2.0)
        nx, ny = (max(2, round(side / step)) for side in (right - left, top - bottom))
        grid = grid_cutout(nx, ny)
        first = sum(map(len, rest))
        rest.append(grid.rest / (nx, ny) * (right - left, top - bottom) + (left, bottom))
        triangles.append(grid.triangles + first)
        parts.append(np.full(len(grid.rest), part, np.int32))
    return make_cutout(
        np.concatenate(rest), np.concatenate(triangles).astype(np.int32), np.concatenate(parts)
    )
