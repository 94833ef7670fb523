# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the shape of an object may have become another one, so that what is kept of it is read again.

Blender tells it of the object (see events.py) whenever its mesh or curve, its shape keys or its vertex groups
have changed or are animated, and of nothing that has only been moved. Numbers are kept of those objects alone
of which anything has been read.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy


class Count(NamedTuple):
    """Equal as long as nothing has been told of the object."""

    files: int  # how often all objects may have become others
    edits: int  # how often the object's own data may have
    frames: int  # how often another frame may have shown it otherwise


Edits = tuple[int, int]  # the same without frames, of which what an object holds does not depend

_files = 0
_counts: dict[int, Count] = {}  # by session_uid


def count(obj: bpy.types.Object) -> Count:
    """All that has been told of the object so far."""
    return _counts.setdefault(obj.session_uid, Count(_files, 0, 0))


def edits(obj: bpy.types.Object) -> Edits:
    """The same without frames."""
    files, edits, _ = count(obj)
    return files, edits


def tell(obj: bpy.types.Object, *, frame: bool = False) -> None:
    """The object's shape may be another one, its vertex groups, or what joins its points.

    `frame`: what it shows may be another one, as the frame is, but what it holds is not.
    """
    old = _counts.get(obj.session_uid)
    if old is not None:
        _counts[obj.session_uid] = Count(old.files, old.edits + (not frame), old.frames + frame)


def tell_all() -> None:
    """Any object may be another one, as after an undo."""
    global _files
    _files += 1
    _counts.clear()
