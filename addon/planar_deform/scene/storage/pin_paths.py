# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths of pins: each belongs to a pin and to the pose, known by its name, from which it leads."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from . import digests
from .curve_lines import line_of

HALVES = {  # of an ease, before and behind a pose on the way
    "LINEAR": ("LINEAR", "LINEAR"),
    "EASE": ("EASE_IN", "EASE_OUT"),
    "EASE_IN": ("EASE_IN", "LINEAR"),
    "EASE_OUT": ("LINEAR", "EASE_OUT"),
}


def path_of(pin: bpy.types.PropertyGroup, pose: str) -> bpy.types.PropertyGroup | None:
    """That of a pin on the way from a pose to the next; None: it has none there."""
    return next((path for path in pin.paths if path.pose == pose), None)


def remove(pin: bpy.types.PropertyGroup, pose: str) -> None:
    """Take the path of a pin behind a pose away."""
    for index in reversed([index for index, path in enumerate(pin.paths) if path.pose == pose]):
        pin.paths.remove(index)


def rename_pose(obj: bpy.types.Object, before: str, name: str) -> None:
    """A pose has got another name."""
    for pin in obj.planar.pins:
        for path in pin.paths:
            if path.pose == before:
                path.pose = name


def forget_pose(obj: bpy.types.Object, pose: str) -> None:
    """A pose is gone."""
    for pin in obj.planar.pins:
        remove(pin, pose)


def forget_all(obj: bpy.types.Object) -> None:
    """All poses are gone."""
    for pin in obj.planar.pins:
        pin.paths.clear()


def split(obj: bpy.types.Object, before: str, between: str) -> list[str]:
    """A pose was made on the way from another one: paths go on behind it. Names of pins whose curves do not.

    Of an ease each half has its own part: slow out of the first pose, slow into the last.
    """
    ended = []
    for pin in obj.planar.pins:
        path = path_of(pin, before)
        if path is None:
            continue
        if path.kind == "CURVE":
            ended.append(pin.name)
            continue
        kind, (first, second) = path.kind, HALVES[path.ease]
        path.ease = first
        added = pin.paths.add()  # which may move the first one in memory
        added.pose, added.kind, added.ease = between, kind, second
    return ended


def stamps(obj: bpy.types.Object) -> dict[str, str]:
    """The paths behind each pose that has some, in short; where a curve lies in the plane does not count."""
    found: dict[str, str] = {}
    for index, pin in enumerate(obj.planar.pins):
        for path in pin.paths if pin.enabled else ():
            curve = _stamp_of(path.curve) if path.kind == "CURVE" else ""
            found[path.pose] = found.get(path.pose, "") + f"{index} {path.kind} {path.ease} {curve};"
    return {pose: digests.digest(text.encode()) for pose, text in found.items()}


def _stamp_of(curve: bpy.types.Object | None) -> str:
    if curve is None:
        return ""
    try:
        line = line_of(curve).astype(np.float32)
    except Refusal:
        return ""
    scale = " ".join(f"{size:.4g}" for size in curve.matrix_world.to_scale())
    return digests.digest(line.tobytes()) + scale
