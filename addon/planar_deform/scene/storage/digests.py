# SPDX-License-Identifier: GPL-3.0-or-later
"""What shapes are, in short, kept while those of their object do not change: panels ask in every redraw."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import bpy

from . import changes

CAPACITY = 8  # objects

# By the object's session_uid: since when nothing has changed, and the digests by the shape key's eval_time.
_known: dict[int, tuple[changes.Edits, dict[float, str]]] = {}


def of_block(obj: bpy.types.Object, eval_time: float, read: Callable[[], bytes]) -> str:
    """The digest of the shape key of an object at an eval_time; `read` gives its bits."""
    edits, known = changes.edits(obj), _known.pop(obj.session_uid, None)
    if known is None or known[0] != edits:
        known = edits, {}
        if len(_known) >= CAPACITY:
            _known.pop(next(iter(_known)))
    _known[obj.session_uid] = known  # as the last one asked for
    digests = known[1]
    if eval_time not in digests:
        digests[eval_time] = digest(read())
    return digests[eval_time]


def digest(data: bytes) -> str:
    """A short name of these bits."""
    return hashlib.blake2b(data, digest_size=12).hexdigest()


def forget() -> None:
    """Keep none."""
    _known.clear()
