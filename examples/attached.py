# SPDX-License-Identifier: GPL-3.0-or-later
"""The fox's layers hung together by Attach, and posed by few pins: what hangs on a layer comes along."""

from __future__ import annotations

import bpy
import numpy as np
from PIL import Image, ImageDraw

import contact_sheet
import cutout
import fox
import puppet
from contact_sheet import FINE, PIN, View

PINS = ("Hips", "Head", "Near Foot", "Far Foot", "Lantern", "Near Hand")
VIEW = View.around(-0.1, -0.4, 5.6, 350, 430)
GROUND = (205, 228, 224)

Cell = tuple[str, str, Image.Image]  # label, note, picture


def cells() -> list[Cell]:
    """The fox attached, leaning, and with its hand turned; of an object that is gone again afterwards."""
    layers = fox.layers()
    obj = cutout.build("Attached Fox", layers, 0.06, 150.0)
    bpy.ops.planar.attach()
    joints = [pin.group for pin in obj.planar.pins]
    puppet.add_pins(obj, layers, [plan for plan in fox.PINS if plan.name in PINS])
    found = [("Attached", f"{len(joints)} joints, {len(PINS)} pins", picture(obj, joints, VIEW, GROUND))]
    _drag(obj, "Head", (0.75, -0.25), -0.35)
    found.append(("The head is dragged", "", picture(obj, joints, VIEW, GROUND)))
    _drag(obj, "Near Hand", (-0.35, 1.9), -1.2)
    _drag(obj, "Lantern", (0.35, 1.0), 0.0)
    found.append(("Then a hand and the lantern", "", picture(obj, joints, VIEW, GROUND)))
    bpy.data.meshes.remove(obj.data)  # and with it the object
    return found


def _drag(obj: bpy.types.Object, pin: str, offset: tuple[float, float], angle: float) -> None:
    bpy.ops.planar.select_pins(action="SELECT", pin=obj.planar.pins.find(pin))
    if angle:
        bpy.ops.planar.rotate_pins(angle=angle)
    bpy.ops.planar.drag_pins(offset=offset)
    bpy.ops.planar.settle_pose()


def picture(
    obj: bpy.types.Object, joints: list[str], view: View, ground: tuple[int, int, int]
) -> Image.Image:
    """The object as it stands, with its pins, and joints as rings."""
    places = puppet.pin_points(obj)
    pins = {name: place for name, place in places.items() if name not in joints}
    patches = {pin.group for pin in obj.planar.pins if pin.kind == "PATCH"}
    rendered = contact_sheet.render(bpy.context.scene, view)
    shown = contact_sheet.cell(rendered, view, puppet.shown_points(obj), pins, patches, ground)
    large = Image.new("RGBA", (view.width * FINE, view.height * FINE))
    draw = ImageDraw.Draw(large)
    for x, y in (view.pixels(np.array([places[name] for name in joints])) * FINE).tolist():
        for colour, width in (((20, 20, 25), 8), (PIN, 4)):
            draw.ellipse((x - 14, y - 14, x + 14, y + 14), outline=colour, width=width)
    small = large.resize(shown.size, Image.Resampling.LANCZOS)
    shown.paste(small, mask=small.getchannel("A"))
    return shown
