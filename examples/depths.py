# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawing of one layer that lies on itself: without depths, in front and behind."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import bpy
from PIL import Image

import contact_sheet
import puppet
from contact_sheet import View
from planar_deform.model.posing.posing import Sample

Cell = tuple[str, str, Image.Image]  # label, note, picture


def crossing(
    obj: bpy.types.Object,
    pin: str,
    way: Sequence[Sample],
    off: Collection[str],
    view: View,
    ground: tuple[int, int, int],
) -> list[Cell]:
    """Cells of the drawing with a pin led so that it lies across, at several depths; then it is at rest."""
    for item in obj.planar.pins:
        item.enabled = item.group not in off
    cells: list[Cell] = []
    for depth, label in ((0.0, "Without depths"), (3.0, "Tail at depth 3"), (-3.0, "Tail at depth -3")):
        bpy.ops.planar.reset_to_rest()
        puppet.lead(pin, way)
        if depth:
            bpy.ops.planar.set_depth(depth=depth)
        picture = Image.new("RGBA", (view.width, view.height), (*ground, 255))
        picture.alpha_composite(contact_sheet.render(bpy.context.scene, view))
        cells.append((label, "", picture))
    bpy.ops.planar.reset_to_rest()
    for item in obj.planar.pins:
        item.enabled = True
    return cells
