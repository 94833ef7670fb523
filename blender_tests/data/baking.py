# SPDX-License-Identifier: GPL-3.0-or-later
"""Bars with poses to bake, and short ways to bake them and to read what comes of it."""

import struct
from pathlib import Path

import bpy
import numpy as np
import pytest
from sequences import curve_of, key, shown_at, stored
from support import activate, add_end_pins, bar

CLOSE = 2e-6  # of a bar 2 long: two or three roundings of float32


def keyed_bar(**options):
    obj = bar(**options)
    add_end_pins(obj)
    for frame, seed in ((1, 0), (9, 1), (25, 2)):
        key(obj, frame, seed)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 25
    return obj


def eased_bar():
    """Eased, on twos, and retimed, so that no frame but the keyed ones shows a stored shape."""
    obj = keyed_bar()
    curve = curve_of(obj)
    curve.keyframe_points[0].interpolation = "SINE"
    curve.keyframe_points[1].interpolation = "BACK"
    stepped = curve.modifiers.new("STEPPED")
    stepped.frame_step, stepped.frame_offset = 2, 1
    curve.update()
    return obj


def saved(tmp_path, name="shot.blend"):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / name))
    return tmp_path


def film(obj, frames):
    return {frame: shown_at(obj, frame) for frame in frames}


def worst(obj, shown):
    return max(np.abs(shown_at(obj, frame) - shape).max() for frame, shape in shown.items())


def read_pc2(path):
    """The header's numbers, and the samples: frames x count x 3."""
    content = Path(path).read_bytes()
    name, version, count, start, rate, frames = struct.unpack("<12siiffi", content[:32])
    assert (name, version) == (b"POINTCACHE2\0", 1)
    assert len(content) == 32 + 12 * count * frames
    return (start, rate), np.frombuffer(content, "<f4", offset=32).reshape(frames, count, 3)


def bake(obj, to, **options):
    activate(obj)
    return bpy.ops.planar.bake(to=to, **options)


def refused(obj, to, **options):
    """The message; nothing has changed, and no file has been made."""
    before, modifiers = stored(obj), [m.name for m in obj.modifiers]
    folder = Path(bpy.data.filepath or "/nowhere/x").parent
    files = {path: path.read_bytes() for path in folder.glob("*") if path.is_file()}
    with pytest.raises(RuntimeError) as error:
        bake(obj, to, **options)
    assert stored(obj) == before
    assert [m.name for m in obj.modifiers] == modifiers
    assert {path: path.read_bytes() for path in folder.glob("*") if path.is_file()} == files
    return str(error.value)
