# SPDX-License-Identifier: GPL-3.0-or-later
"""Image planes imported by Blender's own operator, and everything taken back where that leads to nothing."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy

from ...errors import Refusal, Refusals
from . import image_plane, reading
from .image_plane import ImagePlane

# Of bpy.data, in the order in which they may go: who uses comes before what is used.
KINDS = ("objects", "meshes", "materials", "node_groups", "images")


class Undoing:
    """Remembers what has been made, and what was selected, to put back all of it."""

    def __init__(self, context: bpy.types.Context):
        self._made: list[tuple[str, int]] = []
        self._selected = [obj.name for obj in context.selected_objects]
        active = context.view_layer.objects.active
        self._active = None if active is None else active.name
        self._images: list[tuple[int, str, str]] = []

    @contextmanager
    def noting(self) -> Iterator[None]:
        """Whatever is made meanwhile counts."""
        before = {kind: _identities(kind) for kind in KINDS}
        try:
            yield
        finally:
            for kind in KINDS:
                self._made += [(kind, uid) for uid in _identities(kind) - before[kind]]

    def note_image(self, image: bpy.types.Image) -> None:
        """This one was there before; Blender's import may change its settings."""
        self._images.append((image.session_uid, image.alpha_mode, image.filepath))

    def take_back(self, context: bpy.types.Context) -> None:
        """Leave nothing of it."""
        for kind in KINDS:
            gone = {uid for made, uid in self._made if made == kind}
            blocks = getattr(bpy.data, kind)
            for block in [block for block in blocks if block.session_uid in gone]:
                blocks.remove(block)
        for uid, alpha_mode, filepath in self._images:
            image = next((image for image in bpy.data.images if image.session_uid == uid), None)
            if image is not None:
                _restore(image, "alpha_mode", alpha_mode)
                _restore(image, "filepath", filepath)
        context.view_layer.update()  # before its objects are gone through: 4.2 would crash
        objects = context.view_layer.objects
        for obj in list(objects):
            obj.select_set(obj.name in self._selected)
        objects.active = None if self._active is None else objects.get(self._active)


def load(
    undoing: Undoing, paths: Sequence[Path], *, sequences: bool = False
) -> Generator[float, None, list[bpy.types.Image]]:
    """The images of files, as these are on the disk now; yields the share done. Raises Refusal.

    `sequences`: most of them may be frames, which are looked at later.
    """
    images, refused = [], Refusals()
    for number, path in enumerate(paths, start=1):
        with refused.noting():
            reading.check_file(path)
            with undoing.noting():
                images.append(_load(undoing, path))
            if not sequences:
                reading.size_of(images[-1])  # Blender reads the file now
        yield number / len(paths)
    refused.tell()
    return images


def import_planes(
    undoing: Undoing, images: Sequence[bpy.types.Image], paths: Sequence[Path], options: Mapping[str, Any]
) -> list[ImagePlane]:
    """Planes that show files of one folder, whose images are loaded; a sequence shows several.

    `options` are those of Blender's image.import_as_mesh_planes. Raises Refusal.
    """
    with undoing.noting():
        modes = {image: image.alpha_mode for image in images}
        sizes = {} if options["image_sequence"] else {image: tuple(image.size) for image in images}
        before = _identities("objects")
        files = [{"name": path.name} for path in paths]
        try:
            bpy.ops.image.import_as_mesh_planes(directory=str(paths[0].parent), files=files, **options)
        except RuntimeError as error:
            raise Refusal(str(error).removeprefix("Error: ").strip()) from error
        for image, mode in modes.items():
            _restore(image, "alpha_mode", mode)  # 4.2 gives all images the same one, which fits PNG alone
        bpy.context.view_layer.update()
        added = [obj for obj in bpy.data.objects if obj.session_uid not in before]
        planes = [image_plane.read(obj, sizes) for obj in added]
        for image in images:
            if not image.users:  # a later frame of a sequence
                bpy.data.images.remove(image)
    order = {path.name: number for number, path in enumerate(paths)}
    return sorted(planes, key=lambda plane: order[reading.path_of(plane.texture.image).name])


def _restore(image: bpy.types.Image, name: str, value: str) -> None:
    """Give a setting its value back; written, it would load the image again."""
    if getattr(image, name) != value:
        setattr(image, name, value)


def _load(undoing: Undoing, path: Path) -> bpy.types.Image:
    """The image of a file. Raises Refusal."""
    known = _identities("images")
    try:
        image = bpy.data.images.load(str(path), check_existing=True)
    except RuntimeError as error:
        raise Refusal(f"{path} cannot be read as an image: export it again, as PNG say") from error
    if image.session_uid in known:
        if image.is_dirty:  # Blender's import would read it anew
            raise Refusal(f"'{image.name}' has been painted on: save the image first, with Image > Save")
        undoing.note_image(image)
        if image.packed_file is None:
            image.reload()
    return image


def _identities(kind: str) -> set[int]:
    return {block.session_uid for block in getattr(bpy.data, kind)}
