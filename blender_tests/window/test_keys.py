# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving and turning by keys: G, R, precise, axis locks, typed numbers, and the redo panel."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, imported, moved, pin, pin_data, place, ready, selected, shape
from harness import Window, addon
from mathutils import Vector

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def last() -> bpy.types.Operator:
    return bpy.context.window_manager.operators[-1]


def redo_with(window: Window, **values: object) -> None:
    """What the redo panel does when a value in it is changed."""
    for name, value in values.items():
        setattr(last().properties, name, value)
    with window.context():
        bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)  # True: as if it were not called from a script


def test_g_moves_until_a_click_confirms(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(RIGHT))
    before = shape()
    yield from window.key("G")
    assert window.busy == ["PLANAR_OT_drag_pins"]
    yield from window.move(window.pixel((1.5, 0.0, 0.8)), steps=4)
    assert moved(before, shape()) > 0.4
    yield from window.press()
    yield from window.release()
    yield from window.settled()
    assert window.busy == []
    assert np.allclose(place(1), (1.5, 0.0, 0.8), atol=0.06), place(1)
    for key in ("RET", "NUMPAD_ENTER", "SPACE"):
        yield from window.key("G")
        yield from window.move(window.pixel((1.5, 0.0, 0.5)), steps=2)
        yield from window.confirm(key)
        assert window.busy == [], key
    after = shape()
    yield from window.key("G")
    yield from window.confirm()
    assert np.array_equal(shape(), after), "confirmed without a movement"


def test_typed_numbers(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(RIGHT))
    yield from window.key("G")
    yield from window.type("0.25")
    yield from window.key("TAB")
    yield from window.type("-0.5")
    yield from window.confirm()
    assert tuple(last().properties.offset) == (0.25, -0.5)
    assert np.allclose(place(1), (1.75, 0.0, -0.5), atol=0.05), place(1)
    typed = shape()
    yield from window.undo()
    bpy.ops.planar.drag_pins("EXEC_DEFAULT", True, offset=(0.25, -0.5))
    assert np.array_equal(shape(), typed), "the digits on the way leave no trace"
    yield from window.undo()
    yield from window.key("G")
    yield from window.key("Z")
    yield from window.type("0.5")
    yield from window.confirm()
    assert tuple(last().properties.offset) == (0.0, 0.5)


def test_an_axis_lock_keeps_the_other_axis(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(RIGHT))
    yield from window.key("G")
    yield from window.key("X")
    yield from window.move(window.pixel((2.0, 0.0, 0.7)), steps=3)
    yield from window.confirm()
    dx, dz = last().properties.offset
    assert dz == 0.0
    assert abs(dx - 0.5) < 0.03
    yield from window.hover(window.pixel((2.0, 0.0, 0.0)))
    yield from window.press()  # the same during a drag with the button down, and freed again
    yield from window.move(window.pixel((2.2, 0.0, 0.6)), steps=3)
    for _ in range(4):  # global, local, free, global
        yield from window.key("Z")
    yield from window.release()
    yield from window.settled()
    dx, dz = last().properties.offset
    assert dx == 0.0
    assert abs(dz - 0.6) < 0.03


def test_axis_keys_are_the_worlds_axes_and_pressed_twice_the_drawings(window: Window) -> Iterator[None]:
    for turn in (0.0, 0.5):
        obj = imported()
        obj.rotation_euler.y = turn
        bpy.context.view_layer.update()
        right = obj.matrix_world @ Vector((0.75, 0.0, 0.0))
        pin(obj.matrix_world @ Vector((-0.75, 0.0, 0.0)), right)
        bpy.ops.ed.undo_push(message="Test Scene")
        yield from window.look()
        yield from window.use_tool()
        yield from window.click(window.pixel(right))
        own = active().matrix_world.to_3x3().normalized()
        for keys, way in (("Z", (0, 0, 1)), ("X", (1, 0, 0)), ("XX", own.col[0]), ("YY", own.col[1])):
            yield from window.hover(window.pixel(place(1)))
            start = place(1)
            yield from window.key("G")
            for key in keys:
                yield from window.key(key)
            yield from window.move((window.mouse[0] + 60, window.mouse[1] + 40), steps=3)
            yield from window.confirm()
            gone = place(1) - start
            assert np.linalg.norm(gone) > 0.2, keys
            assert np.linalg.norm(np.cross(gone, way)) < 0.04, f"{keys} at {turn}: {gone}"
            yield from window.undo()
        yield from window.key("G")
        yield from window.key("Y")  # across the drawing
        yield from window.move((window.mouse[0] + 60, window.mouse[1] + 40), steps=3)
        yield from window.settled()
        assert np.allclose(place(1), right, atol=1e-4), "along the normal nothing moves"
        yield from window.key("ESC")
        yield from window.key("G")
        yield from window.key("Z")
        yield from window.type("0.25")
        yield from window.confirm()
        assert np.allclose(place(1) - np.array(right), (0.0, 0.0, 0.25), atol=0.02)
        assert np.allclose(last().properties.offset, (0.0, 0.25), atol=1e-6)
        redo_with(window, offset=(0.1, 0.3))
        yield
        assert np.allclose(place(1) - np.array(right), (0.1, 0.0, 0.3), atol=0.02), "the redo panel follows"
        yield from window.undo()
        yield from window.key("G")
        yield from window.key("Z")
        yield from window.key("Z")  # local Z leaves the plane
        yield from window.key("Z")  # free again, along the world's axes
        yield from window.type("0.2")
        yield from window.key("TAB")
        yield from window.type("0.1")
        yield from window.confirm()
        assert np.allclose(place(1) - np.array(right), (0.2, 0.0, 0.1), atol=0.02)
        bpy.data.objects.remove(active())


def test_s_spreads_and_gathers(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.key("A")
    before, pins = shape(), pin_data()
    yield from window.hover(window.pixel((1.0, 0.0, 0.0)))
    yield from window.key("S")
    assert window.busy == ["PLANAR_OT_spread_pins"]
    yield from window.move(window.pixel((0.5, 0.0, 0.0)), steps=4)
    yield from window.settled()
    assert np.allclose(place(1), (0.75, 0.0, 0.0), atol=0.08), place(1)
    assert np.allclose(place(0), (-0.75, 0.0, 0.0), atol=0.08), place(0)
    yield from window.key("ESC")
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
    yield from window.key("S")
    yield from window.type("1.2")
    yield from window.confirm()
    assert np.allclose(place(1), (1.8, 0.0, 0.0), atol=0.05), place(1)
    assert abs(last().properties.factor - 1.2) < 1e-6
    typed = shape()
    redo_with(window)
    yield
    assert np.array_equal(shape(), typed), "unchanged it gives the same bits"
    redo_with(window, factor=0.8)
    yield
    assert np.allclose(place(1), (1.2, 0.0, 0.0), atol=0.05), place(1)
    yield from window.undo()
    assert np.array_equal(shape(), before), "it is one undo step"


def test_s_scales_a_patch_that_is_selected_alone(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    obj = active()
    near = [v.index for v in obj.data.vertices if (obj.matrix_world @ v.co - Vector(RIGHT)).length < 0.45]
    assert len(near) >= 4
    addon("scene.pins.pin_list").add_on_vertices(obj, near, "PATCH")
    bpy.ops.ed.undo_push(message="Patch")
    yield from window.wait(0.2)
    yield from window.click(window.pixel(place(1)))
    before = shape()
    yield from window.hover(window.pixel((1.5, 0.0, 0.5)))
    yield from window.key("S")
    yield from window.move(window.pixel((1.5, 0.0, 0.9)), steps=4)
    yield from window.settled()
    assert obj.planar.pins[1].scale == 1.0, "it is kept in the end"
    assert moved(before, shape()) > 0.02
    yield from window.key("ESC")
    assert np.array_equal(shape(), before)
    yield from window.key("S")
    yield from window.type("1.4")
    yield from window.confirm()
    assert abs(obj.planar.pins[1].scale - 1.4) < 1e-6
    assert np.allclose(place(1), RIGHT, atol=0.1), place(1)
    window.picture("scaled")
    yield from window.undo()
    assert np.array_equal(shape(), before)


def test_s_with_an_axis_spreads_along_it(window: Window) -> Iterator[None]:
    corners = ((-1.5, 0.0, -0.7), (1.5, 0.0, -0.7), (1.5, 0.0, 0.7), (-1.5, 0.0, 0.7))
    yield from ready(window, *corners)
    yield from window.key("A")
    before = shape()
    yield from window.hover(window.pixel((1.0, 0.0, 0.0)))
    for keys, grown in (
        ("X", (1.2, 1.0, 1.0)),
        ("XX", (1.2, 1.0, 1.0)),
        ("Z", (1.0, 1.0, 1.2)),
        ("Y", (1, 1, 1)),
    ):
        yield from window.key("S")
        for key in keys:
            yield from window.key(key)
        yield from window.type("1.2")
        yield from window.confirm()
        for index, corner in enumerate(corners):
            assert np.allclose(place(index), np.multiply(corner, grown), atol=0.06), (keys, place(index))
        if keys == "Z":
            assert last().properties.axis == "Z"
            typed = shape()
            redo_with(window)
            yield
            assert np.array_equal(shape(), typed), "unchanged it gives the same bits"
        yield from window.undo()
        assert np.array_equal(shape(), before)


def test_shift_is_precise_and_does_not_jump(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel((1.5, 0.0, 0.5)), steps=3)
    yield from window.settled()
    before = shape()
    yield from window.press("LEFT_SHIFT", shift=True)
    yield from window.settled()
    assert np.array_equal(shape(), before), "pressing Shift moves nothing"
    yield from window.move(window.pixel((1.5, 0.0, 1.5)), steps=3, shift=True)
    yield from window.settled()
    precise = shape()
    yield from window.release("LEFT_SHIFT")
    yield from window.settled()
    assert np.array_equal(shape(), precise), "nor does releasing it"
    yield from window.release()
    yield from window.settled()
    _dx, dz = last().properties.offset
    assert abs(dz - 0.6) < 0.03, dz


def test_r_turns_pins_about_their_centre(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.key("A")
    yield from window.hover(window.pixel((2.5, 0.0, 0.0)))
    yield from window.key("R")
    for angle in np.radians(np.arange(0, 91, 6)):
        yield from window.move(window.pixel((2.5 * np.cos(angle), 0.0, 2.5 * np.sin(angle))))
    yield from window.confirm()
    assert abs(np.degrees(last().properties.angle) - 90.0) < 1.0
    assert np.allclose(place(1), (0.0, 0.0, 1.5), atol=0.1), place(1)
    assert np.allclose(place(0), (0.0, 0.0, -1.5), atol=0.1), place(0)
    yield from window.key("R")
    yield from window.type("90")
    yield from window.confirm()
    assert np.allclose(place(1), (-1.5, 0.0, 0.0), atol=0.15), place(1)


def test_r_turns_pins_about_blenders_pivot_point(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    tools, cursor = bpy.context.scene.tool_settings, bpy.context.scene.cursor
    cursor.location = (0.0, 7.0, 0.0)  # seen along the drawing's normal it is in the middle
    try:
        for kind, middle in (("CURSOR", (0.0, 0.0, 0.0)), ("ACTIVE_ELEMENT", LEFT)):
            tools.transform_pivot_point = kind
            bpy.ops.planar.reset_to_rest()
            active().planar.active_pin = 0
            bpy.ops.planar.select_pins(action="SELECT", pin=1)
            active().planar.active_pin = 0
            yield from window.hover(window.pixel((2.5, 0.0, 0.0)))
            yield from window.key("R")
            yield from window.type("30")
            yield from window.confirm()
            arm = np.subtract(RIGHT, middle)
            turned = np.add(
                middle, np.linalg.norm(arm) * np.array([np.cos(np.pi / 6), 0.0, np.sin(np.pi / 6)])
            )
            assert np.allclose(place(1), turned, atol=0.05), (kind, place(1), turned)
    finally:
        tools.transform_pivot_point = "MEDIAN_POINT"


def test_a_patch_keeps_the_angle_it_was_turned_to(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    obj = active()
    rows = [v.index for v in obj.data.vertices if v.co.x > 1.4 and abs(v.co.z) < 0.3]
    obj.vertex_groups.new(name="Hand").add(rows, 1.0, "REPLACE")
    bpy.ops.planar.add_pin_from_group(group="Hand", kind="PATCH")
    yield from window.key("R")
    yield from window.type("30")
    yield from window.confirm()
    assert abs(np.degrees(active().planar.pins[1].angle) - 30.0) < 1e-3
    yield from window.key("G")
    yield from window.type("0.1")
    yield from window.confirm()
    assert abs(np.degrees(active().planar.pins[1].angle) - 30.0) < 1e-3


def test_the_redo_panel_repeats_and_changes_a_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel((1.9, 0.0, 0.4)), steps=4)
    yield from window.move(window.pixel((1.5, 0.0, 0.9)), steps=4)
    yield from window.release()
    yield from window.settled()
    after, pins, offset = shape(), pin_data(), tuple(last().properties.offset)
    redo_with(window)
    yield
    assert np.array_equal(shape(), after), "unchanged it gives the same bits"
    assert pin_data() == pins
    redo_with(window, offset=(offset[0], offset[1] + 0.3))
    yield
    assert selected() == [1]
    assert abs(place(1)[2] - (offset[1] + 0.3)) < 0.06, place(1)
    redo_with(window, offset=offset)
    yield
    assert np.array_equal(shape(), after), "back at the old value it is the old shape"
    yield from window.undo()
    assert np.array_equal(shape(), before)


def test_a_value_typed_into_the_redo_panel(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    panel = window.region("HUD")
    yield from window.click((panel.x + 15, panel.y + panel.height // 2))  # opens it
    yield from window.wait(0.3)
    panel = window.region("HUD")
    yield from window.hover(
        (panel.x + 2 * panel.width // 3, panel.y + 20)
    )  # the last field is the offset's Z
    yield from window.key("RET")
    yield from window.type("0.25")
    yield from window.key("RET")
    yield from window.wait(0.1)
    assert abs(last().properties.offset[1] - 0.25) < 1e-6
    assert np.allclose(place(1), (1.5, 0.0, 0.25), atol=0.05), place(1)
    window.picture("redo_panel")


def test_escape_after_typing_and_turning_restores_every_bit(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.key("A")
    before, pins = shape(), pin_data()
    yield from window.key("R")
    yield from window.type("45")
    assert moved(before, shape()) > 0.3
    yield from window.key("ESC")
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
    yield from window.key("G")
    yield from window.type("1")
    yield from window.press("RIGHTMOUSE")
    yield from window.release("RIGHTMOUSE")
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
