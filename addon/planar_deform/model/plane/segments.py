# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances from straight segments."""

from __future__ import annotations

import numpy as np

from .frame import Array


def nearest_segment(place: Array, starts: Array, ends: Array) -> int:
    """Which of the segments between two places each (k x d) is nearest to one place (d,)."""
    along = ends - starts
    squares = (along * along).sum(axis=1)
    shares = ((place - starts) * along).sum(axis=1) / np.where(squares > 0.0, squares, 1.0)
    nearest = starts + np.clip(shares, 0.0, 1.0)[:, None] * along
    return int(np.argmin(((nearest - place) ** 2).sum(axis=1)))
