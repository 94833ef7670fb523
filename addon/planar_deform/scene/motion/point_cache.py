# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh's motion as a .pc2 file, and the Mesh Cache modifier that plays it.

The file (Point Cache 2): a header of 32 bytes, then x, y, z of every vertex, sample by sample, object-local;
all little-endian, numbers of 4 bytes. Blender ignores the header's start and rate where time is told in
frames: sample number = frame * frame_scale - frame_start of the modifier, blended between two samples
(MOD_meshcache.cc, MOD_meshcache_util.cc).
"""

from __future__ import annotations

import contextlib
import os
import stat
import struct
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array32
from ..storage import paths

MODIFIER = "Point Cache"
SUFFIX = ".pc2"
HEADER = struct.Struct("<12siiffi")  # signature, version, vertices, first frame, frames to the next, samples
SIGNATURE = b"POINTCACHE2\0"
# Blender takes a number up to 1e-4 above a sample's for the sample itself, but none below it, where rounding
# may bring it when it is divided by a step.
SNAP = 5e-5


def modifier_of(obj: bpy.types.Object) -> bpy.types.Modifier | None:
    """The modifier that an earlier bake has made."""
    ours = (m for m in obj.modifiers if m.type == "MESH_CACHE" and m.name.split(".")[0] == MODIFIER)
    return next(ours, None)


def default_path(obj: bpy.types.Object) -> str:
    """Where the object's cache is, or is put if nothing else is said: beside the .blend, under its name."""
    modifier = modifier_of(obj)
    if modifier is not None:
        path = _file_of(modifier)
        if path is not None and path.parent.is_dir() and not _other_users(obj, path):
            return str(modifier.filepath)
    return f"//{bpy.path.clean_name(obj.name)}_planar{SUFFIX}"


def checked_path(obj: bpy.types.Object, filepath: str, *, replace: bool) -> Path:
    """The file to write, absolute. Raises Refusal where it cannot be, or would replace what it must not.

    The object's own cache is replaced; another file only if `replace` says so; another object's never.
    """
    if not bpy.data.filepath and filepath.startswith("//"):
        raise Refusal("The point cache is kept beside the .blend: save that first, or give an absolute path")
    path = file_at(filepath)
    if not path.suffix:
        raise Refusal(f"'{filepath}' is no name of a file: add one")
    if not path.parent.is_dir():
        raise Refusal(f"There is no folder '{path.parent}': make it, or choose another")
    check_unshared(obj, path)
    if path.is_dir():
        raise Refusal(f"'{path}' is a folder: choose another name")
    if path.exists():
        if not replace and is_foreign(obj, filepath):
            raise Refusal(f"There is a file '{path.name}' already: choose another name, or turn on Replace")
        if not path.stat().st_mode & stat.S_IWRITE:
            raise Refusal(f"'{path}' is write-protected: choose another name, or take its protection away")
    return path


def check_unshared(obj: bpy.types.Object, path: Path) -> None:
    """Raises Refusal where another object plays the file."""
    others = _other_users(obj, path)
    if others:
        raise Refusal(
            f"'{path.name}' is the point cache of '{others[0]}': choose another name, or rename one"
        )


def file_at(filepath: str) -> Path:
    """The file that a path of the .blend means, absolute and with the suffix of caches."""
    return paths.absolute(bpy.path.ensure_ext(filepath, SUFFIX))


def is_foreign(obj: bpy.types.Object, filepath: str) -> bool:
    """Whether there is a file already which is not the object's own cache."""
    path, modifier = file_at(filepath), modifier_of(obj)
    return path.exists() and (modifier is None or _file_of(modifier) != path)


@contextlib.contextmanager
def written(path: Path, count: int, frames: range) -> Iterator[BinaryIO]:
    """A file to which the samples are written, shapes of `count` vertices at these frames.

    It takes its place when all of them are; left by an exception, nothing is left behind, and what was there
    before still is. Raises Refusal where Blender may not write.
    """
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    header = HEADER.pack(SIGNATURE, 1, count, float(frames.start), float(frames.step), len(frames))
    try:
        with partial.open("xb") as file:
            file.write(header)
            yield file
        partial.replace(path)
    except OSError as error:
        raise Refusal(
            f"'{path}' cannot be written ({error.strerror}): choose a folder where you may write"
        ) from error
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)


def baked_frames(path: Path, count: int) -> range:
    """The frames that a file has samples of `count` vertices of.

    Raises Refusal where there is no such file, or it is not one that a bake has written for such a mesh.
    """
    try:
        with path.open("rb") as file:
            header = file.read(HEADER.size)
            size = file.seek(0, os.SEEK_END)
    except OSError as error:
        raise Refusal(f"There is no point cache '{path}': bake it first") from error
    if len(header) < HEADER.size or not header.startswith(SIGNATURE):
        raise Refusal(f"'{path}' is not a point cache: bake it again")
    _, _, vertices, start, step, samples = HEADER.unpack(header)
    if vertices != count:
        raise Refusal(f"'{path}' is of another mesh, of {vertices} vertices and not {count}: bake it again")
    if samples < 1 or step < 1 or size != HEADER.size + samples * count * 12:
        raise Refusal(f"'{path}' is not complete: bake it again")
    return range(round(start), round(start) + samples * round(step), round(step))


def packed(shape: Array32) -> bytes:
    """A shape, count x 3 coordinates, as the file has it."""
    return np.ascontiguousarray(shape[:, :3], "<f4").tobytes()


def play(obj: bpy.types.Object, path: Path, frames: range) -> None:
    """Let the object's Mesh Cache modifier, before all others, show the file."""
    modifier = modifier_of(obj)
    if modifier is None:
        modifier = obj.modifiers.new(MODIFIER, "MESH_CACHE")
        modifier.show_expanded = False
    obj.modifiers.move(obj.modifiers.find(modifier.name), 0)
    settings = {
        "cache_format": "PC2",
        "filepath": paths.stored(path),
        "play_mode": "SCENE",
        "time_mode": "FRAME",
        "interpolation": "LINEAR",
        "deform_mode": "OVERWRITE",
        "frame_scale": 1.0 / frames.step,
        "frame_start": frames.start / frames.step - (SNAP if frames.step > 1 else 0.0),
        "show_viewport": True,
        "show_render": True,
    }
    for name, value in settings.items():
        setattr(modifier, name, value)
    for name in ("factor", "vertex_group", "forward_axis", "up_axis", "flip_axis"):
        modifier.property_unset(name)  # by default all of the mesh is shown as the file has it
    obj.update_tag()  # the file may be another one under the same name


def _file_of(modifier: bpy.types.Modifier) -> Path | None:
    return paths.absolute(modifier.filepath, modifier.id_data.library) if modifier.filepath else None


def _other_users(obj: bpy.types.Object, path: Path) -> list[str]:
    """Names of other objects whose Mesh Cache modifiers show the file."""
    return [
        other.name
        for other in bpy.data.objects
        if other != obj
        for modifier in other.modifiers
        if modifier.type == "MESH_CACHE" and _file_of(modifier) == path
    ]
