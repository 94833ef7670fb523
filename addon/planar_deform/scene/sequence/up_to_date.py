# SPDX-License-Identifier: GPL-3.0-or-later
"""Which in-betweens were up to date when their object was last seen.

What takes poses and in-betweens along alike leaves them so.
"""

from __future__ import annotations

from collections.abc import Mapping

import bpy

from . import pose_state, stretches

# By session_uid: the poses (indices) behind which they were, and whether these have been edited.
_seen: dict[int, dict[int, bool]] = {}


def see(obj: bpy.types.Object) -> None:
    """Remember what is up to date of an object now."""
    _seen[obj.session_uid] = found(obj)


def seen(obj: bpy.types.Object) -> dict[int, bool]:
    """Behind which poses in-betweens were up to date when last seen, and whether these had been edited."""
    return dict(_seen.get(obj.session_uid, {}))


def carry(obj: bpy.types.Object) -> None:
    """All poses and in-betweens have been taken along alike: what was up to date when seen stays so."""
    mark(obj, seen(obj))


def mark(obj: bpy.types.Object, fresh: Mapping[int, bool]) -> None:
    """What is generated behind these poses belongs to them as they are now."""
    for pose, by_hand in fresh.items():
        stretches.mark(obj, [pose], edited=by_hand)


def forget() -> None:
    """Of another file nothing is known."""
    _seen.clear()


def found(obj: bpy.types.Object) -> dict[int, bool]:
    """Behind which poses in-betweens are up to date now, and whether these have been edited."""
    if not (pose_state.is_ours(obj) and stretches.has_inbetweens(obj)):
        return {}
    stale = {first for first, _ in stretches.stale(obj)}
    return {
        index: pose.edited
        for index, pose in enumerate(obj.planar.poses)
        if pose.generated and index not in stale
    }
