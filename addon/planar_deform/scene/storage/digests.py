# SPDX-License-Identifier: GPL-3.0-or-later
"""What shapes are, in short, kept while no shape changes: panels ask for it in every redraw."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import bpy

_known: dict[tuple[int, float], str] = {}  # by the object's session_uid and the shape key's place


def of_block(obj: bpy.types.Object, place: float, read: Callable[[], bytes]) -> str:
    """The digest of the shape key of an object at a place; `read` gives its bits."""
    found = _known.get((obj.session_uid, place))
    if found is None:
        found = _known[obj.session_uid, place] = digest(read())
    return found


def digest(data: bytes) -> str:
    """A short name of these bits."""
    return hashlib.blake2b(data, digest_size=12).hexdigest()


def forget() -> None:
    """Any shape may have changed."""
    _known.clear()
