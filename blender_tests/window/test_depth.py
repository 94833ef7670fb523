# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths by the sidebar's buttons, seen in colours for a moment; the viewport draws an arm in one piece."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, pin, ready, shape, sheet
from harness import Window

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def mean(window: Window, where: tuple[int, int]) -> np.ndarray:
    return np.mean(window.colours(where, 4), axis=0)


def test_a_button_a_tint_and_undo(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    bpy.ops.ed.undo_push(message="Select")
    yield from window.sidebar()
    before, place = shape(), window.pixel((1.1, 0.0, 0.6))
    plain = mean(window, place)
    yield from window.push("planar.set_depth")
    yield from window.wait(0.3)
    depth = active().planar.pins[1].depth
    assert abs(abs(depth) - 1.0) < 1e-3
    tinted = mean(window, place)
    assert (tinted[0] - tinted[2]) * np.sign(depth) > 40.0, "warm in front, cold behind"
    window.picture("depth-tint")
    yield from window.wait(2.5)
    assert np.allclose(mean(window, place), plain, atol=3.0), "for a moment"
    yield from window.move(window.pixel((0.0, 0.0, 1.5)))
    yield from window.undo()
    assert np.array_equal(shape(), before)
    yield from window.redo()
    assert abs(active().planar.pins[1].depth - depth) < 1e-3


def arm_across() -> bpy.types.Object:
    """A strip, red from its middle on, where it turns back and lies across itself."""
    obj = sheet(columns=64, rows=8, cell=0.0625)
    for name, colour in (("Body", (0, 0, 1, 1)), ("Arm", (1, 0, 0, 1))):
        material = bpy.data.materials.new(name)
        material.diffuse_color = colour
        obj.data.materials.append(material)
    for face in obj.data.polygons:
        face.material_index = int(face.center.x > 0.25)
    pin((-1.5, 0.0, 0.0), (1.5, 0.0, 0.0))
    for item in obj.planar.pins:
        item.select = item == obj.planar.pins[1]
    points = shape(obj).astype(float)
    turned = (points[:, 0] - 0.3 + 1j * (points[:, 2] - 0.3)) * np.exp(1j * np.radians(200.0))
    right = points[:, 0] > 0.25
    points[right, 0], points[right, 2] = 0.3 + turned[right].real, 0.3 + turned[right].imag
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    obj.data.update()
    bpy.ops.ed.undo_push(message="Arm")
    return obj


def shreds(window: Window) -> tuple[int, int]:
    """Pixels unlike both neighbours in their row, which are alike; and how many are red."""
    radius = 100  # the sharp bend is outside
    width = 2 * radius + 1
    picture = np.array(window.colours(window.pixel((-0.7, 0.0, 0.0)), radius), int).reshape(width, width, 3)
    red = picture[:, :, 0] - picture[:, :, 2] > 60
    blue = picture[:, :, 2] - picture[:, :, 0] > 60
    alone = red[:, 1:-1] & blue[:, :-2] & blue[:, 2:]
    alone |= blue[:, 1:-1] & red[:, :-2] & red[:, 2:]
    return int(alone.sum()), int(red.sum())


def test_the_solid_view_draws_it_in_one_piece(window: Window) -> Iterator[None]:
    arm_across()
    space = window.area.spaces.active
    space.overlay.show_overlays, space.show_gizmo = False, False
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "MATERIAL"
    found = {}
    for direction, turn in (("FRONT", None), ("BACK", (0.0, 0.0, 0.7071068, 0.7071068))):
        yield from window.look("FRONT", 5.0)
        if turn is not None:
            window.view.view_rotation = turn
        for depth in (0.0, 2.0, -2.0):
            assert bpy.ops.planar.set_depth(depth=depth) == {"FINISHED"}
            window.area.tag_redraw()
            yield from window.wait(0.5)
            found[direction, depth] = shreds(window)
            window.picture(f"depth-{direction.lower()}{depth:+.0f}")
    for direction in ("FRONT", "BACK"):
        for depth in (2.0, -2.0):
            assert found[direction, depth][0] <= 6, (direction, depth)
    in_front = found["FRONT", 2.0][1] > found["FRONT", -2.0][1]
    assert (found["BACK", 2.0][1] > found["BACK", -2.0][1]) != in_front, f"as with paper: {found}"
