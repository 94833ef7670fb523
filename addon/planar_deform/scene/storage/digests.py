# SPDX-License-Identifier: GPL-3.0-or-later
"""What shapes are, in short, kept while those of their object do not change: panels ask in every redraw."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import bpy

from . import changes
from .vertex_groups import members

CAPACITY = 64  # objects

_Of = float | tuple[str, ...]  # a shape key's eval_time, or names of vertex groups


@dataclass
class _Known:
    """Of one object."""

    edits: changes.Edits
    digests: dict[_Of, tuple[bytes, str]]  # with the bits that they are of: to compare these is much faster
    current: set[_Of]  # those that have been asked for since those edits


_known: dict[int, _Known] = {}  # by the object's session_uid, the last one asked for at the end


def of_block(obj: bpy.types.Object, eval_time: float, read: Callable[[], bytes]) -> str:
    """The digest of the shape key of an object at an eval_time; `read` gives its bits."""
    return _of(obj, eval_time, read)


def of_groups(obj: bpy.types.Object, names: Iterable[str]) -> str:
    """The digest of which vertices are in these vertex groups, with any weight; their names do not count."""
    chosen = tuple(sorted(set(names)))

    def read() -> bytes:
        groups = [rows[weights > 0.0].tobytes() for rows, weights in members(obj, chosen).values()]
        return b"|".join(sorted(groups))

    return _of(obj, chosen, read)


def _of(obj: bpy.types.Object, what: _Of, read: Callable[[], bytes]) -> str:
    edits, known = changes.edits(obj), _known.pop(obj.session_uid, None)
    if known is None:
        known = _Known(edits, {}, set())
        if len(_known) >= CAPACITY:
            _known.pop(next(iter(_known)))
    _known[obj.session_uid] = known
    if known.edits != edits:
        known.digests = {asked: known.digests[asked] for asked in known.current}  # others are of no use
        known.edits, known.current = edits, set()
    if what not in known.current:
        bits = read()
        if what not in known.digests or known.digests[what][0] != bits:
            known.digests[what] = bits, digest(bits)
        known.current.add(what)
    return known.digests[what][1]


def digest(data: bytes) -> str:
    """A short name of these bits."""
    return hashlib.blake2b(data, digest_size=12).hexdigest()


def forget() -> None:
    """Keep none."""
    _known.clear()
