# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Pose tool's keys and buttons do to pins, and that they never reach the object."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, pin, place, ready, selected, shape, sheet
from harness import Window, addon

LEFT, RIGHT, TOP = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.7)
EMPTY = (3.0, 0.0, -2.0)
KEYS: tuple[tuple[str, dict[str, bool]], ...] = (
    *(("G", {}), ("R", {}), ("S", {}), ("I", {}), ("B", {}), ("H", {}), ("H", {"alt": True})),
    *(("A", {}), ("A", {"alt": True}), ("I", {"ctrl": True}), ("X", {}), ("DEL", {})),
)


def enabled() -> list[bool]:
    return [item.enabled for item in active().planar.pins]


def state() -> tuple:
    """What Blender's own operators of these keys would change."""
    return tuple(
        (obj.name, str(obj.matrix_basis), obj.hide_get(), obj.select_get(), obj.animation_data is None)
        for obj in bpy.context.view_layer.objects
    )


def test_no_key_reaches_the_object(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    yield from window.hover(window.pixel(EMPTY))
    bpy.ops.mesh.primitive_cube_add(location=(0.0, 3.0, 0.0))
    cube = active().name
    bpy.ops.object.camera_add(location=(0.0, -20.0, 0.0))
    camera = active().name
    sheet("Bare", at=(0.0, 1.0, 0.0))
    bpy.ops.ed.undo_push(message="More Objects")
    for name in ("Bare", cube, camera, None):
        obj = bpy.data.objects[name] if name else None
        for other in bpy.context.view_layer.objects:
            other.select_set(other == obj)
        bpy.context.view_layer.objects.active = obj
        yield from window.wait(0.1)
        before = state()
        for key, modifiers in KEYS:
            if (name, key) == ("Bare", "I") and not modifiers:
                continue  # an unpinned drawing can be keyed
            yield from window.key(key, **modifiers)
            assert window.busy == [], (name, key, modifiers, window.busy)
            assert state() == before, (name, key, modifiers)
    assert "No pins: add some first" in window.reports()


def test_i_keys_the_pose_and_nothing_else(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    bpy.context.scene.frame_set(7)
    yield from window.key("I")
    assert [pose.frame for pose in active().planar.poses] == [7]
    assert active().animation_data is None
    yield from window.undo()
    assert len(active().planar.poses) == 0, "it is an undo step"


def test_h_disables_the_selected_pins_and_alt_h_enables_all(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    yield from window.key("H")
    assert enabled() == [True, True, True], "none is selected"
    yield from window.click(window.pixel(RIGHT))
    yield from window.click(window.pixel(TOP), shift=True)
    yield from window.key("H")
    assert enabled() == [True, False, False]
    assert not active().hide_get()
    yield from window.key("H", alt=True)
    assert enabled() == [True, True, True]
    yield from window.undo()
    assert enabled() == [True, False, False]


def test_b_selects_the_pins_in_a_box(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    before = shape()
    yield from window.click(window.pixel(LEFT))
    yield from window.hover(window.pixel((-0.5, 0.0, 1.5)))
    yield from window.key("B")
    assert window.busy == ["PLANAR_OT_box_select_pins"]
    yield from window.press()
    yield from window.move(window.pixel((2.0, 0.0, -0.5)), steps=4)
    yield from window.wait(0.2)
    window.picture("box-select")
    yield from window.release()
    assert window.busy == []
    assert selected() == [0, 1, 2], "those in the box as well"
    yield from window.hover(window.pixel((-2.0, 0.0, 0.5)))
    yield from window.key("B")
    yield from window.press(shift=True)
    yield from window.move(window.pixel((-1.0, 0.0, -0.5)), steps=4, shift=True)
    yield from window.release(shift=True)
    assert selected() == [1, 2], "with Shift they are deselected"
    yield from window.undo()
    assert selected() == [0, 1, 2]
    yield from window.key("B")
    yield from window.press()
    yield from window.move(window.pixel((2.0, 0.0, 1.5)), steps=2)
    yield from window.key("ESC")
    yield from window.release()
    assert window.busy == []
    assert selected() == [0, 1, 2]
    assert np.array_equal(shape(), before)


def test_the_right_button_opens_the_menu_of_a_pin(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT, TOP)
    yield from window.click(window.pixel(LEFT))
    x, y = window.pixel(RIGHT)
    before = window.colours((x - 60, y - 60), 20)
    yield from window.click((x, y), "RIGHTMOUSE")
    yield from window.wait(0.3)
    window.picture("pin-menu")
    assert selected() == [1], "another pin than those selected is selected alone"
    assert window.colours((x - 60, y - 60), 20) != before, "a menu is open"
    yield from window.key("ESC")
    yield from window.wait(0.2)
    yield from window.click(window.pixel(LEFT), shift=True)
    yield from window.click((x, y), "RIGHTMOUSE")
    yield from window.wait(0.3)
    assert selected() == [0, 1], "one of those selected leaves the selection"
    assert active().planar.active_pin == 1
    yield from window.key("ESC")
    yield from window.wait(0.2)
    assert window.busy == []


def test_the_right_button_beside_a_pin_opens_the_menu_of_the_drawing(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    before = state()
    for key in ("K", "I", "X"):
        yield from window.click(window.pixel((0.0, 0.0, 0.2)), "RIGHTMOUSE")
        yield from window.wait(0.3)
        window.picture(f"drawing-menu-{key}")
        yield from window.key(key)
        yield from window.wait(0.3)
        yield from window.key("ESC")
        assert len(active().planar.poses) == 1, "its first entry keys the pose"
        assert state() == before, "the object stays, and its transform has no keys"
    yield from window.click(window.pixel(EMPTY), "RIGHTMOUSE")
    yield from window.wait(0.3)
    window.picture("object-menu")
    yield from window.key("ESC")
    assert state() == before


def test_i_keys_no_hidden_drawing(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    active().hide_set(True)
    yield from window.wait(0.2)
    yield from window.key("I")
    assert len(active().planar.poses) == 0
    assert active().animation_data is None
    assert "is hidden" in window.reports()
    active().hide_set(False)
    yield from window.key("I")
    assert len(active().planar.poses) == 1


def test_dragging_nothing_says_so(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.drag(window.pixel(EMPTY), window.pixel((2.0, 0.0, -1.0)))
    said = addon("scene.telling").said
    assert "There is no pin under the mouse: drag one" in said()
    yield from window.hover(window.pixel(LEFT))
    assert said(), "the mouse alone does nothing"
    yield from window.key("A", alt=True)
    assert said() == "", "it is gone with the next thing that is done"
    assert window.busy == []
    bpy.ops.planar.select_pins(action="ALL")
    bpy.ops.planar.remove_pins("EXEC_DEFAULT", True)
    yield from window.drag(window.pixel((0.0, 0.0, 0.0)), window.pixel((1.0, 0.0, 0.0)))
    assert "Ctrl-click the drawing to add one" in said()
    yield from window.click(window.pixel((0.0, 0.0, 0.0)), ctrl=True)
    assert said() == ""
    assert len(active().planar.pins) == 1
    assert window.busy == []
    assert np.array_equal(shape(), before)
    assert tuple(active().location) == (0, 0, 0)


def test_dragging_what_cannot_be_posed_says_why(window: Window) -> Iterator[None]:
    """A copy that shares its mesh shows no pins: that is the reason, not the place of the mouse."""
    yield from ready(window, LEFT, RIGHT)
    bpy.ops.planar.select_pins(action="ALL")
    twin = active().copy()
    bpy.context.collection.objects.link(twin)
    bpy.ops.ed.undo_push(message="Twin")
    yield from window.wait(0.3)
    yield from window.drag(window.pixel(RIGHT), window.pixel((2.0, 0.0, 0.5)))
    assert "is shared: make it single-user" in addon("scene.telling").said()
    assert selected() == [0, 1], "nor are pins deselected that nobody sees"


def test_the_status_bar_tells_what_to_do_first(window: Window) -> Iterator[None]:
    sheet()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    bar = (130, 9)  # where the words are
    yield from window.wait(0.3)
    without = window.colours(bar, 8)
    yield from window.use_tool()
    yield from window.hover(window.pixel(EMPTY))
    yield from window.wait(0.5)
    window.picture("first-hint")
    hint = window.colours(bar, 8)
    assert hint != without
    yield from window.click(window.pixel(LEFT), ctrl=True)
    assert len(active().planar.pins) == 1
    yield from window.wait(0.5)
    window.picture("first-hint-gone")
    assert window.colours(bar, 8) != hint, "it goes with the first pin"


def test_a_hidden_drawing_shows_and_takes_no_pins(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.click(window.pixel(LEFT))
    before, spot = shape(), window.pixel(RIGHT)
    active().hide_set(True)
    bpy.ops.ed.undo_push(message="Hide")
    yield from window.hover(spot)
    yield from window.wait(0.2)
    assert not any(min(colour) > 150 for colour in window.colours(spot, 8)), "no pin is drawn"
    yield from window.drag(spot, window.pixel((1.5, 0.0, 1.0)))
    yield from window.click(window.pixel(TOP), ctrl=True)
    for key, modifiers in KEYS:
        if (key, modifiers) == ("I", {}):
            continue  # what is hidden can be keyed
        yield from window.key(key, **modifiers)
        assert window.busy == [], key
        assert active().hide_get(), key
    assert len(active().planar.pins) == 2
    assert np.array_equal(shape(), before)
    assert "'Sheet' is hidden: show it" in window.reports()
    active().hide_set(False)
    yield from window.drag(spot, window.pixel((1.5, 0.0, 0.6)))
    assert moved(before, shape()) > 0.3


def test_a_drawing_outside_of_the_local_view_shows_and_takes_no_pins(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    drawing, before = active(), shape()
    other = sheet("Other", columns=2, rows=2, at=(0.0, -1.0, -2.0))
    with window.context():
        bpy.ops.view3d.localview(frame_selected=False)
    bpy.context.view_layer.objects.active = drawing
    yield from window.wait(0.3)
    assert other.visible_get()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 1.0)))
    yield from window.click(window.pixel(TOP), ctrl=True)
    assert len(active().planar.pins) == 2
    assert "'Sheet' is not in this view" in window.reports()
    assert np.array_equal(shape(drawing), before)


def on_ring(window: Window, index: int) -> tuple[int, int]:
    x, y = window.pixel(place(index))
    return x + 36, y


def test_a_point_becomes_a_patch_by_dragging_its_ring(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, (1.0, 0.0, 0.0))
    yield from window.click(window.pixel((1.0, 0.0, 0.0)))
    before = shape()
    yield from window.hover(on_ring(window, 1))
    yield from window.press(ctrl=True)
    yield from window.move(window.pixel((1.62, 0.0, 0.0)), steps=4, ctrl=True)
    assert window.busy == ["PLANAR_OT_set_pin_radius"]
    yield from window.wait(0.2)
    window.picture("patch-radius")
    yield from window.release(ctrl=True)
    yield from window.wait(0.2)
    item = active().planar.pins[1]
    assert item.kind == "PATCH"
    group = active().vertex_groups[item.group].index
    held = [v.index for v in active().data.vertices if any(e.group == group for e in v.groups)]
    near = np.linalg.norm(before - (1.0, 0.0, 0.0), axis=1)
    assert held == np.flatnonzero(near < 0.62).tolist()
    assert np.array_equal(shape(), before)
    yield from window.hover(on_ring(window, 1))
    yield from window.press(ctrl=True)  # a patch's ring is a gizmo, which takes the button whatever is held
    yield from window.move(window.pixel((1.4, 0.0, 0.0)), steps=4, ctrl=True)
    yield from window.key("ESC")
    yield from window.release(ctrl=True)
    assert window.busy == []
    yield from window.undo()
    assert active().planar.pins[1].kind == "POINT", "it is one undo step"


def test_a_ctrl_click_on_the_ring_adds_a_pin(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, (1.0, 0.0, 0.0))
    yield from window.click(window.pixel((1.0, 0.0, 0.0)))
    spot = on_ring(window, 1)
    yield from window.click(spot, ctrl=True)
    yield from window.wait(0.2)
    assert len(active().planar.pins) == 3
    assert np.hypot(*np.subtract(window.pixel(place(2)), spot)) < 2.0
    assert active().planar.pins[1].kind == "POINT"


def test_a_typed_radius_and_one_that_is_too_small(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, (1.02, 0.0, 0.03))
    yield from window.click(window.pixel((1.02, 0.0, 0.03)))
    for typed, kind in (("0.01", "POINT"), ("0.5", "PATCH")):
        with window.context():
            bpy.ops.planar.set_pin_radius("INVOKE_DEFAULT", True)
        yield from window.type(typed)
        yield from window.key("RET")
        yield from window.wait(0.1)
        assert window.busy == []
        assert active().planar.pins[1].kind == kind
    assert "make its radius" in window.reports()
    assert abs(bpy.context.window_manager.operators[-1].properties.radius - 0.5) < 1e-6


def test_pins_behind_others_are_selected_by_a_box_in_perspective(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    back = sheet("Back", at=(0.0, 2.0, 0.0))
    bpy.context.view_layer.objects.active = back
    pin((0.5, 2.0, 0.5))
    bpy.ops.ed.undo_push(message="Back")
    window.view.view_perspective = "PERSP"
    yield from window.wait(0.2)
    yield from window.hover(window.pixel((-1.0, 2.0, -1.0)))
    yield from window.key("B")
    yield from window.press()
    yield from window.move(window.pixel((1.0, 2.0, 1.0)), steps=4)
    yield from window.release()
    assert selected() == [0], "of the active drawing alone"


def test_the_right_button_opens_the_menu_of_a_drawing_without_pins(window: Window) -> Iterator[None]:
    sheet()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.use_tool()
    for key in ("K", "X"):
        yield from window.click(window.pixel((0.0, 0.0, 0.2)), "RIGHTMOUSE")
        yield from window.wait(0.3)
        window.picture(f"drawing-menu-no-pins-{key}")
        yield from window.key(key)
        yield from window.wait(0.3)
        yield from window.key("ESC")
        assert len(active().planar.poses) == 1, "its first entry keys, and nothing is deleted"
