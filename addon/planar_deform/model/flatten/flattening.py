# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches laid flat one after the other, some of their vertices perhaps held."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ... import native
from ..plane.cutout import signed_areas
from ..plane.frame import Array, Indices
from ..work import Progress
from .layout import nearest_motion, size_ratio
from .patches import Patches


class PatchError(ValueError):
    """A patch cannot be laid flat; the message says what to do about it."""

    def __init__(self, patch: int, message: str):
        super().__init__(message)
        self.patch = patch


@dataclass(frozen=True)
class Settings:
    """How patches are laid flat, see native.Flattener."""

    method: native.FlattenMethod = "hold"
    weights: native.EdgeWeights = "cotangent"
    iterations: int = 0
    fixed: tuple[int, int] | None = None  # the surface's vertices of an edge


@dataclass(frozen=True)
class Held:
    """Flat vertices that are held where a UV map has them."""

    rows: Indices  # k, in order
    places: Array  # k x 2, in the map

    def of(self, rows: Indices) -> Held:
        """Those among rows in order, counted there."""
        mine = np.isin(self.rows, rows)
        return Held(np.searchsorted(rows, self.rows[mine]).astype(np.int32), self.places[mine])


@dataclass(frozen=True)
class Flat:
    """Patches laid flat."""

    places: Array  # n x 2, true to scale, each patch about 0 unless it is held
    unit: float  # how large a unit of the UV map is, by what is held there
    held: Indices  # patches with held vertices


def flatten(
    surface: Array, patches: Patches, settings: Settings, progress: Progress, held: Held | None = None
) -> Flat:
    """Lay all patches flat; `surface`: the flat vertices' places on it, n x 3.

    What is held tells how large a unit of the map is, unless it is one vertex a patch: then the largest
    patch fills it.

    Raises PatchError, and native.Cancelled when `progress` tells so.
    """
    places = np.zeros((len(surface), 2))
    shares = np.bincount(patches.patch[patches.triangles[:, 0]], minlength=patches.count) / len(
        patches.triangles
    )
    done = np.cumsum(shares) - shares
    solvers = []
    for patch in range(patches.count):
        part = partial(_share, progress, done[patch], shares[patch])
        rows = patches.rows(patch)
        with_pins = held is not None and bool(np.isin(held.rows, rows).any())
        solver = _solver(patch, surface[rows], patches, settings, part)
        places[rows] = solver.positions
        if with_pins:
            solvers.append((patch, rows, solver))
    if held is None or not solvers:
        return Flat(places, 1.0, np.empty(0, np.int32))
    unit = _unit(places, held, [rows for _, rows, _ in solvers])
    if unit is None:
        unit = max(float(np.ptp(places[patches.rows(patch)], axis=0).max()) for patch in range(patches.count))
    for patch, rows, solver in solvers:
        places[rows] = _taken(patch, solver, held.of(rows), unit)
    return Flat(places, unit, np.array([patch for patch, _, _ in solvers], np.int32))


def turned_over(places: Array, triangles: Indices) -> int:
    """How many triangles of a flat shape are turned over."""
    return int(np.count_nonzero(signed_areas(places, triangles) < 0.0))


def lengths_kept(surface: Array, places: Array, triangles: Indices) -> tuple[float, float]:
    """How many times as long as on the surface (n x 3) edges are laid flat, at the least and at the most."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    before, after = (np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1) for x in (surface, places))
    ratios = after[before > 0.0] / before[before > 0.0]
    return float(ratios.min()), float(ratios.max())


def _share(progress: Progress, done: float, share: float, part: float) -> bool:
    return progress(float(done + share * part))


def _solver(
    patch: int, surface: Array, patches: Patches, settings: Settings, progress: Callable[[float], bool]
) -> native.Flattener:
    fixed = None if settings.fixed is None else patches.edge_of(settings.fixed, patch)
    if fixed is not None:
        fixed = np.searchsorted(patches.rows(patch), fixed)
    try:
        return native.Flattener(
            surface,
            patches.triangles_of(patch),
            method=settings.method,
            weights=settings.weights,
            iterations=settings.iterations,
            fixed=fixed,
            progress=progress,
        )
    except (ValueError, native.SolveError) as error:
        raise PatchError(patch, _plain(str(error), patches.vertices[patches.rows(patch)])) from error


def _unit(places: Array, held: Held, rows: list[Indices]) -> float | None:
    """How large a unit of the map is: what is held in the patches (their rows) against what is flat.

    Patches count by how far apart their held vertices are; None where none has two.
    """
    pairs = []
    for mine in rows:
        pins = held.of(mine)
        free = places[mine][pins.rows]
        pairs.append((free - free.mean(axis=0), pins.places - pins.places.mean(axis=0)))
    return size_ratio(
        np.concatenate([free for free, _ in pairs]), np.concatenate([goal for _, goal in pairs])
    )


def _taken(patch: int, solver: native.Flattener, pins: Held, unit: float) -> Array:
    """The patch with its pins where the map has them, `unit` as large."""
    goals = pins.places * unit
    motion = nearest_motion(solver.positions[pins.rows], goals)  # so that the solver has a short way
    if len(pins.rows) == 1:
        return motion.of(solver.positions)
    solver.set_pins(pins.rows)
    try:
        solver.move(motion.back(goals))
        return motion.of(solver.settle())
    except native.SolveError as error:
        raise PatchError(patch, f"{error}, or unpin some of its UVs") from error


def _plain(message: str, vertices: Indices) -> str:
    """The solver's message with the surface's vertices (k, of the patch), and without an argument's name."""
    message = message.removeprefix("triangles: ").removeprefix("vertices: ")
    return re.sub(
        r"vertices (\d+) and (\d+)",
        lambda found: f"vertices {vertices[int(found[1])]} and {vertices[int(found[2])]}",
        message,
    )
