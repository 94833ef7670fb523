# SPDX-License-Identifier: GPL-3.0-or-later
"""Solvers kept between posings. May be dropped at any moment: everything that lasts is in the .blend."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from ... import native
from ..latest import make_room
from ..plane.cutout import Cutout
from ..plane.frame import Array
from ..work import Progress
from .joints import Ties

ROOM = 320_000  # triangles together; the factor of 20,000 takes some 20 MB

Solver = TypeVar("Solver")
Recipe = tuple[Any, ...]  # arrays, and what else a solver is made of
Key = int | tuple[str, int]  # of an object: its number; what else is kept of it has a name before that


@dataclass
class _Entry:
    recipe: Recipe
    solver: Any

    @property
    def size(self) -> int:
        """Triangles, of which there are some two a vertex."""
        return max((len(part) for part in self.recipe if isinstance(part, np.ndarray)), default=0)


_entries: OrderedDict[Key, _Entry] = OrderedDict()
_changing = threading.Lock()  # solvers are asked for in the solving thread, and dropped in Blender's


def kept(key: Key, recipe: Recipe, make: Callable[[], Solver]) -> Solver:
    """The solver for the object with this key, made anew unless its recipe is the same to the bit."""
    entry = _entries.get(key)
    if entry is None or not _same(entry.recipe, recipe):
        entry = _Entry(recipe, make())
    with _changing:
        _entries[key] = entry
        _entries.move_to_end(key)
        make_room(_entries, ROOM, lambda kept: kept.size)
    solver: Solver = entry.solver
    return solver


def poser_for(
    key: int,
    cutout: Cutout,
    method: native.Method,
    positions: Array,
    ties: Ties | None = None,
    *,
    progress: Progress | None = None,
) -> native.Poser:
    """A solver for the object with this key, standing at n x 2 `positions`, its parts tied by joints if any.

    It is always reset, so that a posing gives the same bits whether or not the solver was there before.
    `progress` is asked while a coarse mesh is made for it; False from it raises native.Cancelled.
    """
    rest, triangles, stiffness, cage = cutout.rest, cutout.triangles, cutout.stiffness, cutout.cage

    def make() -> native.Poser:
        poser = native.Poser(
            rest, triangles, method=method, stiffness=stiffness, cage=cage, progress=progress
        )
        if ties is not None:
            poser.set_joints(ties.first, ties.second, strength=ties.strength)
        return poser

    joined = () if ties is None else ties.recipe
    poser = kept(key, (method, triangles, rest, stiffness, cage, *joined), make)
    poser.reset(positions)
    return poser


def clear() -> None:
    """Drop every solver."""
    with _changing:
        _entries.clear()


def _same(a: Recipe, b: Recipe) -> bool:
    """Whether two recipes are equal; arrays are never equal to anything else."""
    return len(a) == len(b) and all(
        one is other
        or (isinstance(one, np.ndarray) == isinstance(other, np.ndarray) and np.array_equal(one, other))
        for one, other in zip(a, b, strict=True)
    )
