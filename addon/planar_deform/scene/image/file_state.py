# SPDX-License-Identifier: GPL-3.0-or-later
"""What an image's file was when a cutout was made of it, to tell that it has been painted on since.

A file that has been copied, unpacked or checked out has another time, so its bytes are kept as well. They are
looked at again only where the time is another and the size is not; those of sequences never are.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from functools import partial
from hashlib import sha1
from pathlib import Path

import bpy

from ...errors import Refusal
from ...model.image import image_files
from ...model.image.image_files import ImageFile
from ..storage import migration
from . import reading
from .reading import path_of

LOOK = 1.0  # seconds between two looks at a file: panels ask in every redraw

_seen: dict[str, tuple[float, str]] = {}  # by path: when it was looked at, and what it was
_read: dict[str, str] = {}  # by the same: what the file was when it was read again
_digests: dict[str, tuple[str, str]] = {}  # by the same: what the file was, and the digest of its bytes then


def remember(obj: bpy.types.Object) -> None:
    """Keep what the files of an object's images are now: its mesh is of them."""
    _seen.clear()
    migration.migrate(obj)
    found = _files(obj, measured=True)
    for image, file in found.items():
        if image.source == "FILE" and file.state:
            found[image] = file._replace(state=f"{file.state}/{_digest(path_of(image))}")
    obj.planar.image_state = image_files.packed(found.values())


def is_changed(obj: bpy.types.Object) -> bool:
    """Whether a file has been written since; not where that is not known, or no file is there."""
    if not obj.planar.image_state:
        return False
    now = _files(obj)
    kept = _kept(obj, now.values())
    states = [file.state for file in kept]
    for image, file in now.items():
        if image.source == "FILE":
            digest = partial(_digest, path_of(image))
            now[image] = file._replace(state=image_files.recognised(file.state, states, digest))
    return image_files.is_changed(kept, list(now.values()))


def size_before(obj: bpy.types.Object, image: bpy.types.Image) -> tuple[int, int] | None:
    """The size that an image had when the mesh was made of it; None where that is not known."""
    now = _files(obj).values()
    return image_files.size_of(_kept(obj, now), now, path_of(image).name)


def reload(obj: bpy.types.Object) -> None:
    """Read the object's images again.

    Raises Refusal, with nothing changed, where one cannot be read or has pixels that no file has.
    """
    images = [image for image in _with_files(obj) if image.source in {"FILE", "SEQUENCE"}]
    for image in images:
        if image.is_dirty:
            raise Refusal(
                f"'{image.name}' has been painted on in Blender, which is lost when its file is read: save "
                "it first, in the Image Editor with Image > Save As"
            )
        reading.check_readable(image)  # Blender would drop the pixels that it has
    _seen.clear()
    for image in images:
        image.reload()
        _read[str(path_of(image))] = _of_file(path_of(image))


def is_read(obj: bpy.types.Object) -> bool:
    """Whether Blender's pixels are surely those of the files: reload() has read them, of any object."""
    paths = [path_of(image) for image in _with_files(obj) if image.source == "FILE"]
    return all(_read.get(str(path)) == _of_file(path) for path in paths)


def images_of(obj: bpy.types.Object) -> list[bpy.types.Image]:
    """The images that the object's materials show, each once."""
    return list(dict.fromkeys(node.image for node in _textures(obj)))


def _with_files(obj: bpy.types.Object) -> list[bpy.types.Image]:
    return [image for image in images_of(obj) if image.packed_file is None]


def _textures(obj: bpy.types.Object) -> list[bpy.types.ShaderNodeTexImage]:
    trees = (slot.material.node_tree for slot in obj.material_slots if slot.material is not None)
    nodes = (node for tree in trees if tree is not None for node in tree.nodes if node.type == "TEX_IMAGE")
    return [node for node in nodes if node.image is not None]


def _kept(obj: bpy.types.Object, now: Iterable[ImageFile]) -> list[ImageFile]:
    return image_files.unpacked(obj.planar.image_state, [file.name for file in now])


def _files(obj: bpy.types.Object, *, measured: bool = False) -> dict[bpy.types.Image, ImageFile]:
    """Not `measured`: without the sizes of sequences, for which a frame is read."""
    found: dict[bpy.types.Image, ImageFile] = {}
    for node in _textures(obj):
        image = node.image
        if image in found or image.packed_file is not None:
            continue
        name = path_of(image).name
        if image.source == "FILE":
            size = image.size if image.has_data else (0, 0)
            found[image] = ImageFile(name, _of_file(path_of(image)), *size)
        elif image.source == "SEQUENCE":
            states = [_of_file(path) for path in reading.frame_paths(image, node.image_user)]
            state = sha1("+".join(states).encode()).hexdigest() if any(states) else ""
            found[image] = ImageFile(name, state, *(_frame_size(image) if measured else (0, 0)))
    return found


def _frame_size(image: bpy.types.Image) -> tuple[int, int]:
    try:
        return reading.size_of(image)
    except Refusal:
        return 0, 0


def _of_file(path: Path) -> str:
    now = time.monotonic()
    found = _seen.get(str(path))
    if found is None or now - found[0] > LOOK:
        try:
            told = path.stat()
            state = f"{told.st_mtime_ns}/{told.st_size}"
        except OSError:
            state = ""
        found = _seen[str(path)] = now, state
    return found[1]


def _digest(path: Path) -> str:
    """Of the bytes of a file; empty where they cannot be read."""
    state = _of_file(path)
    if _digests.get(str(path), ("", ""))[0] != state:
        try:
            digest = sha1(path.read_bytes()).hexdigest()
        except OSError:
            digest = ""
        _digests[str(path)] = state, digest
    return _digests[str(path)][1]


def forget() -> None:
    """Keep none."""
    _seen.clear()
    _read.clear()
    _digests.clear()
