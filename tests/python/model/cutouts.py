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
