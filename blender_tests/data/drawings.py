# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings as they come from elsewhere: characters, text, outlines; turned, scaled, not symmetric."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import activate, make_object

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"


def character(name="horse", *, scale=0.1):
    """One of the real shapes that lie beside the project, standing as Blender imports them."""
    path = SHARED / f"{name}.obj"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices = [tuple(map(float, line[1:4])) for line in lines if line[:1] == ["v"]]
    faces = [[int(corner.split("/")[0]) - 1 for corner in line[1:]] for line in lines if line[:1] == ["f"]]
    obj = make_object(vertices, faces, name=name.title())
    return _as_imported(obj, scale)


def text(words="Pins"):
    """Text converted to a mesh: long thin triangles, a part for each letter."""
    bpy.ops.object.text_add()
    obj = bpy.context.object
    obj.data.body = words
    bpy.ops.object.convert(target="MESH")
    return _as_imported(bpy.context.object, 0.7)


def outline():
    """A filled outline as from an SVG: one concave n-gon, in thousandths, and a second part."""
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    radii = 80.0 + 25.0 * np.sin(5 * angles) + 8.0 * np.cos(2 * angles)
    points = np.stack([radii * np.cos(angles) + 300.0, radii * np.sin(angles) - 120.0, 0 * angles], axis=1)
    eye = points[::6] * [0.1, 0.1, 1.0] + [280.0, -100.0, 2.0]
    faces = [list(range(60)), list(range(60, 70))]
    return _as_imported(make_object(np.concatenate([points, eye]), faces, name="Outline"), 0.01)


DRAWINGS = {"character": character, "text": text, "outline": outline}


def _as_imported(obj, scale):
    obj.rotation_euler = (np.pi / 2, 0.0, 0.0)
    obj.scale = (scale, scale, scale)
    obj.location = (0.3, -1.0, 2.0)
    activate(obj)
    return obj


def extremes(obj):
    """The vertices of faces that are leftmost and rightmost in the drawing's own plane, and one between."""
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    drawing = begin(bpy.context)
    part = np.flatnonzero(drawing.parts == drawing.parts[0])
    order = part[np.argsort(drawing.positions[part, 0])]
    return [int(drawing.vertex_indices[order[i]]) for i in (0, len(order) // 2, -1)]
