# SPDX-License-Identifier: GPL-3.0-or-later
"""A lantern, an object of its own, that the hand of the fox carries wherever the fox is posed."""

from __future__ import annotations

import bpy
from PIL import Image

import contact_sheet
import cutout
import fox
import puppet
from contact_sheet import View
from puppet import PinPlan

HELD = (-1.2, 1.24)  # by the near hand
FOX_PINS = ("Hips", "Chest", "Head", "Near Foot", "Far Foot", "Near Elbow", "Near Hand")
LANTERN_PINS = (
    PinPlan("Ring", "Lantern", (HELD[0], HELD[1] - 0.04), radius=0.09),
    PinPlan("Foot", "Lantern", (HELD[0], HELD[1] - 0.98), "Ring", radius=0.12),
)
VIEW = View.around(-0.4, -0.4, 5.6, 380, 430)
GROUND = (205, 228, 224)

Cell = tuple[str, str, Image.Image]  # label, note, picture


def cells() -> list[Cell]:
    """The lantern attached, and its fox posed; both are gone again afterwards."""
    layers = fox.layers()
    carrier = cutout.build("Carrying Fox", layers, 0.06, 150.0)
    bpy.ops.planar.attach()
    puppet.add_pins(carrier, layers, [plan for plan in fox.PINS if plan.name in FOX_PINS])
    drawn = fox.lantern(*HELD, depth=-0.05)
    carried = cutout.build("Lantern", [drawn], 0.06, 150.0)
    puppet.add_pins(carried, [drawn], LANTERN_PINS)
    _attach(carried, carrier)
    found = [("Attached to the hand", "", _picture(carrier, carried))]
    _lead(carrier, "Near Hand", (-0.45, 1.2), -0.2)
    _lead(carrier, "Head", (0.3, -0.1), -0.2)
    found.append(("The hand is raised", "", _picture(carrier, carried)))
    _lead(carrier, "Near Hand", (-0.05, 0.35), -0.9)
    found.append(("And turned", "", _picture(carrier, carried)))
    for obj in (carried, carrier):
        bpy.data.meshes.remove(obj.data)  # and with it the object
    return found


def _attach(carried: bpy.types.Object, carrier: bpy.types.Object) -> None:
    """By both pins: the foot, which does not lie on the hand, goes with the ring."""
    for pin in carried.planar.pins:
        pin.select = True
    carrier.select_set(True)
    bpy.context.view_layer.objects.active = carrier
    bpy.ops.planar.attach_to()


def _lead(obj: bpy.types.Object, pin: str, offset: tuple[float, float], angle: float) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.planar.select_pins(action="SELECT", pin=obj.planar.pins.find(pin))
    if angle:
        bpy.ops.planar.rotate_pins(angle=angle)
    bpy.ops.planar.drag_pins(offset=offset)


def _picture(carrier: bpy.types.Object, carried: bpy.types.Object) -> Image.Image:
    """Both as they stand, with the pins of the lantern and the hand."""
    patches = {pin.group for pin in carried.planar.pins if pin.kind == "PATCH"}
    rendered = contact_sheet.render(bpy.context.scene, VIEW)
    pins = puppet.pin_points(carried) | {"Hand": puppet.pin_points(carrier)["Near Hand"]}
    return contact_sheet.cell(rendered, VIEW, puppet.shown_points(carrier), pins, patches, GROUND)
