# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that were solved, so that frames that are played again are not solved again.

A shape belongs to a solver, which is another one when its drawing is, and to all that the solver was told.
May be dropped at any moment.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Iterable
from typing import Any
from weakref import WeakKeyDictionary

from ..plane.frame import Array

ROOM = 100_000_000  # bytes: of 5000 vertices some 1200 shapes, of 100,000 some 60

Key = bytes

_kept: WeakKeyDictionary[Any, OrderedDict[Key, Array]] = WeakKeyDictionary()


def key_of(told: Iterable[Any]) -> Key:
    """Tells all that a solver was told, arrays, from any other."""
    found = hashlib.blake2b(digest_size=16)
    for array in told:
        found.update(repr((array.shape, array.dtype.str)).encode())
        found.update(array.tobytes())
    return found.digest()


def shape_of(solver: Any, key: Key) -> Array | None:
    """What the solver has come to from this, if that is still there."""
    shapes = _kept.get(solver)
    if shapes is None or key not in shapes:
        return None
    shapes.move_to_end(key)
    return shapes[key]


def keep(solver: Any, key: Key, shape: Array) -> None:
    """The solver has come to this shape, which nobody changes."""
    shapes = _kept.setdefault(solver, OrderedDict())
    shapes[key] = shape
    while len(shapes) > 1 and len(shapes) * shape.nbytes > ROOM:
        shapes.popitem(last=False)


def clear() -> None:
    """Keep none."""
    _kept.clear()
