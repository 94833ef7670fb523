# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences, in Blender's: how pins look, and the ease of new keys of poses."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty

from .model.timing.ease import EASES, PREFERENCES


@dataclass(frozen=True)
class Looks:
    """How pins are drawn. Light marks read on any drawing; selected ones are as Blender's selections."""

    size: float = 6.0  # radius in pixels at a UI scale of 1
    pin: tuple[float, ...] = (0.90, 0.91, 0.93, 1.0)
    selected: tuple[float, ...] = (1.0, 0.55, 0.08, 1.0)


DEFAULT = Looks()
LARGEST = 12.0  # pixels: within as many the mouse is on a pin, see scene/view/mouse.py


def _redraw(_preferences: PlanarPreferences, context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()


class PlanarPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    pin_size: FloatProperty(
        name="Pin Size",
        description="Radius of the marks of pins in pixels, before the interface's resolution scale",
        subtype="PIXEL",
        default=DEFAULT.size,
        min=3.0,
        max=LARGEST,
        precision=1,
        update=_redraw,
    )
    pin_colour: FloatVectorProperty(
        name="Pins",
        description="Colour of pins that are not selected",
        subtype="COLOR_GAMMA",
        size=4,
        default=DEFAULT.pin,
        min=0.0,
        max=1.0,
        update=_redraw,
    )
    selected_colour: FloatVectorProperty(
        name="Selected Pins",
        description="Colour of selected pins, and of the ring that turns them",
        subtype="COLOR_GAMMA",
        size=4,
        default=DEFAULT.selected,
        min=0.0,
        max=1.0,
        update=_redraw,
    )
    ease: EnumProperty(
        name="New Poses",
        description="Ease of new keys of poses, on objects that have none of their own",
        items=EASES,
        default=PREFERENCES,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        for name in ("pin_size", "pin_colour", "selected_colour", "ease"):
            column.prop(self, name)


def looks() -> Looks:
    """How pins are drawn; the defaults where the add-on is not enabled by Blender's preferences."""
    add_on = bpy.context.preferences.addons.get(__package__)
    found = None if add_on is None else add_on.preferences
    if found is None:
        return DEFAULT
    return Looks(found.pin_size, tuple(found.pin_colour), tuple(found.selected_colour))


CLASSES = (PlanarPreferences,)
