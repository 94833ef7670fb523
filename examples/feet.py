# SPDX-License-Identifier: GPL-3.0-or-later
"""Feet between two poses in which they stand: held by their middle alone, and each."""

from __future__ import annotations

import numpy as np

import planar_native
from arcs import FINELY, SHARES, Cell, Motion, mesh_rows
from contact_sheet import View

EDGE = 0.05
LEAN, SHIFT = -0.9, (0.6, -0.1)  # of the back
LEGS, SOLES, BACK = ((0, 4), (16, 20)), 14, 6  # columns of the legs, rows of them and of the back


def walker() -> tuple[np.ndarray, np.ndarray]:
    """A back on two legs: points, and triangles of squares."""
    columns, rows = 20, SOLES + BACK
    square = [
        (column, row)
        for row in range(rows)
        for column in range(columns)
        if row >= SOLES or any(low <= column < high for low, high in LEGS)
    ]
    corner = np.array(square)[:, None] + [[0, 0], [1, 0], [1, 1], [0, 1]]
    points, index = np.unique(corner.reshape(-1, 2), axis=0, return_inverse=True)
    quads = index.reshape(-1, 4)
    return EDGE * points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def rows() -> list[list[Cell]]:
    """A walker that leans far over, its feet where they are."""
    rest, triangles = walker()
    feet = np.flatnonzero(rest[:, 1] < 0.5 * EDGE)
    back = np.flatnonzero(rest[:, 1] > rest[:, 1].max() - 0.5 * EDGE)
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles(np.concatenate([feet, back]))
    middle = rest[back].mean(axis=0)
    for share in np.linspace(0, 1, 21)[1:]:
        c, s = np.cos(LEAN * share), np.sin(LEAN * share)
        leant = middle + share * np.array(SHIFT) + (rest[back] - middle) @ [[c, s], [-s, c]]
        poser.move(np.concatenate([rest[feet], leant]))
    keys = [rest, poser.settle()]
    options = {"triangles": triangles, "rest": rest, "anchor": feet}
    marked = [feet[0], feet[len(feet) // 2 - 1], feet[len(feet) // 2], feet[-1]]
    motions = []
    for name, pins in (("By their middle", {}), ("Each", {"pins": feet})):
        frames, ways = (
            np.array(planar_native.inbetween(keys, shares, **options, **pins)) for shares in (SHARES, FINELY)
        )
        off = np.linalg.norm(ways[:, feet] - rest[feet], axis=2).max() / np.hypot(*np.ptp(rest, axis=0))
        print(f"feet held {name.lower()}: {100 * off:.2g} % of the diagonal off")
        motions.append(Motion(name, frames, ways))
    return mesh_rows(motions, rest, triangles, marked, View.around(0.7, -0.1, 1.45, 350, 290))
