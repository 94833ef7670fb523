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
    poses: int  # how often we have written no more than a pose of it
    frames: int  # how often another frame may have shown it otherwise


Edits = tuple[int, int, int]  # the same without frames, of which what an object holds does not depend
Others = tuple[int, int]  # and without poses that we have written

_files = 0
# By session_uid: objects a pose of which we have written since Blender last told of them.
_written: set[int] = set()
_counts: dict[int, Count] = {}  # by session_uid


def count(obj: bpy.types.Object) -> Count:
    """All that has been told of the object so far."""
    return _counts.setdefault(obj.session_uid, Count(_files, 0, 0, 0))


def edits(obj: bpy.types.Object) -> Edits:
    """The same without frames."""
    return count(obj)[:3]


def others(obj: bpy.types.Object) -> Others:
    """The same without our poses: of what none of them changes."""
    return count(obj)[:2]


def tell(obj: bpy.types.Object) -> None:
    """The object's shape may be another one, its vertex groups, or what joins its points."""
    _add(obj, edits=1)


def tell_frame(obj: bpy.types.Object) -> None:
    """What the object shows may be another one, as the frame is, but what it holds is not."""
    _add(obj, frames=1)


def tell_pose(obj: bpy.types.Object) -> None:
    """We have written the object's shape, or what its pins keep of a posing, and nothing else."""
    _written.add(obj.session_uid)
    _add(obj, poses=1)


def tell_update(obj: bpy.types.Object, *, dragged: bool) -> None:
    """Blender tells of an object that something is another one, and not what.

    While it is `dragged` nobody else writes it: this is of the pose that we have written, if we have.
    """
    if dragged and obj.session_uid in _written:
        _add(obj, poses=1)
    else:
        _add(obj, edits=1)
    _written.discard(obj.session_uid)


def _add(obj: bpy.types.Object, *, edits: int = 0, poses: int = 0, frames: int = 0) -> None:
    old = _counts.get(obj.session_uid)
    if old is not None:
        _counts[obj.session_uid] = Count(old.files, old.edits + edits, old.poses + poses, old.frames + frames)


def tell_all() -> None:
    """Any object may be another one, as after an undo."""
    global _files
    _files += 1
    _counts.clear()
    _written.clear()
