# SPDX-License-Identifier: GPL-3.0-or-later
"""Solvers kept between posings. May be dropped at any moment: everything that lasts is in the .blend."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np

from ... import native
from ..plane.cutout import Cutout
from ..plane.frame import Array

CAPACITY = 8  # objects; a 10k-vertex factor takes some 20 MB


@dataclass
class _Entry:
    cutout: Cutout
    method: native.Method
    poser: native.Poser


_entries: OrderedDict[int, _Entry] = OrderedDict()
_changing = threading.Lock()  # solvers are asked for in the solving thread, and dropped in Blender's


def poser_for(key: int, cutout: Cutout, method: native.Method, positions: Array) -> native.Poser:
    """A solver for the object with this key, standing at n x 2 `positions`.

    A kept one is used only when triangles, rest shape, stiffness and method are the same to the bit. It is
    always reset, so that a posing gives the same bits whether or not the solver was there before.
    """
    entry = _entries.get(key)
    if entry is None or entry.method != method or not _same(entry.cutout, cutout):
        poser = native.Poser(cutout.rest, cutout.triangles, method=method, stiffness=cutout.stiffness)
        entry = _Entry(cutout, method, poser)
    with _changing:
        _entries[key] = entry
        _entries.move_to_end(key)
        while len(_entries) > CAPACITY:
            _entries.popitem(last=False)
    entry.poser.reset(positions)
    return entry.poser


def clear() -> None:
    """Drop every solver."""
    with _changing:
        _entries.clear()


def _same(a: Cutout, b: Cutout) -> bool:
    if a.stiffness is None or b.stiffness is None:
        if a.stiffness is not b.stiffness:
            return False
    elif not np.array_equal(a.stiffness, b.stiffness):
        return False
    return np.array_equal(a.triangles, b.triangles) and np.array_equal(a.rest, b.rest)
