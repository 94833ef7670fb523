# SPDX-License-Identifier: GPL-3.0-or-later
"""What an image's file was when a cutout was made of it, to tell that it has been painted on since."""

from __future__ import annotations

import time

import bpy

from ..storage import migration
from .reading import path_of

LOOK = 1.0  # seconds between two looks at a file: panels ask in every redraw

_seen: dict[str, tuple[float, str]] = {}  # by path: when it was looked at, and what it was


def remember(obj: bpy.types.Object) -> None:
    """Keep what the files of an object's images are now: its mesh is of them."""
    _seen.clear()
    migration.migrate(obj)
    obj.planar.image_state = _state(obj)


def is_changed(obj: bpy.types.Object) -> bool:
    """Whether a file has been written since; not where that is not known, or no file is there."""
    kept = obj.planar.image_state
    if not kept:
        return False
    pairs = zip(kept.split("|"), _state(obj).split("|"), strict=False)
    return any(then and now and then != now for then, now in pairs)


def reload(obj: bpy.types.Object) -> None:
    """Read the object's images again."""
    for image in images_of(obj):
        if image.source in {"FILE", "SEQUENCE"} and image.packed_file is None:
            image.reload()


def images_of(obj: bpy.types.Object) -> list[bpy.types.Image]:
    """The images that the object's materials show, each once."""
    trees = (slot.material.node_tree for slot in obj.material_slots if slot.material is not None)
    nodes = (node for tree in trees if tree is not None for node in tree.nodes if node.type == "TEX_IMAGE")
    return list(dict.fromkeys(node.image for node in nodes if node.image is not None))


def _state(obj: bpy.types.Object) -> str:
    images = (image for image in images_of(obj) if image.source == "FILE" and image.packed_file is None)
    return "|".join(_of_file(image) for image in images)


def _of_file(image: bpy.types.Image) -> str:
    path, now = path_of(image), time.monotonic()
    found = _seen.get(str(path))
    if found is None or now - found[0] > LOOK:
        try:
            told = path.stat()
            state = f"{told.st_mtime_ns}/{told.st_size}"
        except OSError:
            state = ""
        found = _seen[str(path)] = now, state
    return found[1]


def forget() -> None:
    """Keep none."""
    _seen.clear()
