# SPDX-License-Identifier: GPL-3.0-or-later
"""Which drawings are solved on a coarse mesh round them, which carries them along."""

from __future__ import annotations

import bpy

# Of the coarse mesh. How far it is off: `tools/figures.sh --table cage`.
VERTICES = 4000
# A move of as many vertices takes about as long as the mouse takes to move on.
ABOVE = 8000  # unless an object says otherwise


def cage_of(obj: bpy.types.Object) -> int | None:
    """How many vertices an object's coarse mesh is to have; None where the drawing is solved itself."""
    if obj.type != "MESH" or not obj.data.polygons:
        return None
    return VERTICES if len(obj.data.vertices) > obj.planar.coarse_above else None


def may_serve(obj: bpy.types.Object) -> bool:
    """Whether a mesh has so many vertices that some limit would have it solved on a coarse one."""
    return bool(obj.type == "MESH" and len(obj.data.vertices) > VERTICES)
