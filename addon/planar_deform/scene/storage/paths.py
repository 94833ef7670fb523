# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of files as a .blend keeps them, which opens on every system.

They begin with // where they are told from the .blend's own folder. Blender on Windows writes \\ where others
have /, and reads either everywhere; Python reads its own system's alone.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import bpy


def absolute(filepath: str, library: bpy.types.Library | None = None) -> Path:
    """Where a path leads that the .blend keeps, or the `library` that its owner comes from.

    Without .. in it, but links are not followed: the user may have set them up to be changed later.
    """
    start = None if library is None else str(absolute(library.filepath).parent)
    plain = bpy.path.abspath(filepath.replace("\\", "/"), start=start)
    return Path(os.path.abspath(plain))  # noqa: PTH100  takes .. away


def stored(path: Path) -> str:
    """The path for the .blend to keep: relative to itself where it is saved and there is a way from it."""
    if bpy.data.filepath:
        with contextlib.suppress(ValueError):  # another drive
            return str(bpy.path.relpath(str(path))).replace(os.sep, "/")
    return str(path)
