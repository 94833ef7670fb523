# SPDX-License-Identifier: GPL-3.0-or-later
"""What of an image is too faint for its cutout, and lies outside of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..plane.frame import Array, Indices, Mask
from .art import OPAQUE, Alpha

HAZE = 1  # of 255: such pixels cannot be seen
MUCH = 0.005  # of all alpha: plain drawings have up to 0.0002, glows that reach a tenth of their size 0.01


def share_cut_off(alpha: Alpha, threshold: float, points: Array, rings: Sequence[Indices]) -> float:
    """The share of an image's alpha that is below the threshold and outside of the rings of points."""
    faint = np.where((alpha > HAZE) & (alpha <= threshold * OPAQUE), alpha, 0)
    total = float(alpha.sum(dtype=np.int64))
    if faint.sum(dtype=np.int64) <= MUCH * total:
        return 0.0
    return float(faint[~_inside(alpha.shape, points, rings)].sum(dtype=np.int64)) / total


def _inside(shape: tuple[int, ...], points: Array, rings: Sequence[Indices]) -> Mask:
    """The pixels whose middles have an odd number of sides of the rings at their left."""
    height, width = shape
    starts = np.concatenate([points[ring] for ring in rings])
    ends = np.concatenate([points[np.roll(ring, -1)] for ring in rings])
    low, high = np.minimum(starts[:, 1], ends[:, 1]), np.maximum(starts[:, 1], ends[:, 1])
    first = np.clip(np.ceil(low - 0.5), 0, height).astype(np.int64)
    counts = np.clip(np.ceil(high - 0.5), 0, height).astype(np.int64) - first
    side = np.repeat(np.arange(len(starts)), counts)
    rows = np.arange(len(side)) - np.repeat(np.cumsum(counts) - counts, counts) + first[side]
    along = (rows + 0.5 - starts[side, 1]) / (ends[side, 1] - starts[side, 1])
    across = starts[side, 0] + along * (ends[side, 0] - starts[side, 0])
    columns = np.clip(np.ceil(across - 0.5), 0, width).astype(np.int64)
    crossings = np.zeros((height, width + 1), np.uint8)
    np.add.at(crossings, (rows, columns), 1)
    inside: Mask = (np.cumsum(crossings[:, :width], axis=1, dtype=np.uint8) & 1).astype(bool)
    return inside
