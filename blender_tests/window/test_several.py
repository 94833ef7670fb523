# SPDX-License-Identifier: GPL-3.0-or-later
"""Several drawings posed as one: pins of all under the mouse, one drag, one undo step, keyed and filled."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, pin, selected, shape, sheet
from harness import Window

NAMES = ("Left", "Middle", "Right")
PLACES = {"Left": -1.4, "Middle": 0.0, "Right": 1.4}
TIP, ROOT = 0.8, -0.8  # heights of the pins of each


def ready(window: Window) -> Iterator[None]:
    """Three strips side by side, each pinned at its lower and at its upper end, all selected, Left active."""
    for name, x in PLACES.items():
        sheet(name, columns=3, rows=8, at=(x, 0.0, 0.0))
        pin((x, 0.0, ROOT), (x, 0.0, TIP))
    for obj in objects():
        obj.select_set(True)
    bpy.context.view_layer.objects.active = bpy.data.objects["Left"]
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look("FRONT")
    yield from window.use_tool()


def objects() -> list[bpy.types.Object]:
    return [bpy.data.objects[name] for name in NAMES]


def shapes() -> list[bytes]:
    return [shape(obj).tobytes() for obj in objects()]


def pixel(window: Window, name: str, height: float = TIP) -> tuple[int, int]:
    return window.pixel((PLACES[name], 0.0, height))


def drag(window: Window, start: tuple[int, int], by: tuple[int, int] = (40, 30)) -> Iterator[None]:
    yield from window.drag(start, (start[0] + by[0], start[1] + by[1]))
    yield from window.settled()


def test_pins_of_all_light_up_and_the_pressed_one_is_dragged(window: Window) -> Iterator[None]:
    yield from ready(window)
    before = shapes()
    yield from window.hover(pixel(window, "Right"))
    colours = window.colours(pixel(window, "Right"))
    assert sum(min(colour) > 245 for colour in colours) > 20, "it lights up"
    yield from drag(window, pixel(window, "Right"))
    assert active().name == "Right"
    assert all(obj.select_get() for obj in objects())
    assert [a == b for a, b in zip(shapes(), before, strict=True)] == [True, True, False]
    yield from window.undo()
    assert shapes() == before
    assert active().name == "Left", "the press is in the same step"


def test_one_drag_moves_all_selected_pins_and_esc_and_undo_take_all_back(window: Window) -> Iterator[None]:
    yield from ready(window)
    before = shapes()
    yield from window.click(pixel(window, "Left"))
    yield from window.click(pixel(window, "Middle"), shift=True)
    yield from window.click(pixel(window, "Right"), shift=True)
    assert [[p.select for p in obj.planar.pins] for obj in objects()] == [[False, True]] * 3
    start = pixel(window, "Middle")
    yield from window.hover(start)
    yield from window.press()
    yield from window.move((start[0] + 30, start[1] + 25), steps=4)
    yield from window.wait(0.4)
    assert all(a != b for a, b in zip(shapes(), before, strict=True))
    yield from window.key("ESC")
    yield from window.release()
    assert shapes() == before
    yield from drag(window, start)
    moved = [
        shape(obj)[-3] - np.frombuffer(old, np.float32).reshape(-1, 3)[-3]
        for obj, old in zip(objects(), before, strict=True)
    ]
    assert all(np.abs(one - moved[1]).max() < 0.02 for one in moved), "all go the same way"
    assert np.abs(moved[1]).max() > 0.1
    after = shapes()
    yield from window.undo()
    assert shapes() == before
    yield from window.redo()
    assert shapes() == after


def test_keyed_and_filled_as_one(window: Window) -> Iterator[None]:
    yield from ready(window)
    for frame in (1, 9):
        bpy.context.scene.frame_set(frame)
        bpy.ops.ed.undo_push(message="Frame Change")
        yield from window.hover(pixel(window, "Middle", 0.0))
        yield from window.key("A")
        yield from window.key("G")
        yield from window.type("0.2" if frame == 1 else "-0.3")
        yield from window.confirm()
        yield from window.settled()
        yield from window.key("I")
        yield from window.wait(0.3)
    assert [len(obj.planar.poses) for obj in objects()] == [2, 2, 2]
    with window.context():
        bpy.ops.planar.generate_inbetweens("INVOKE_DEFAULT", True)
    while window.busy:
        yield
    yield
    assert [obj.planar.poses[0].generated for obj in objects()] == [7, 7, 7]
    yield from window.undo()
    assert [obj.planar.poses[0].generated for obj in objects()] == [0, 0, 0]


def test_a_pin_is_added_to_the_drawing_under_the_mouse(window: Window) -> Iterator[None]:
    yield from ready(window)
    yield from window.click(pixel(window, "Right", 0.1), ctrl=True)
    assert [len(obj.planar.pins) for obj in objects()] == [2, 2, 3]
    assert active().name == "Right"
    assert selected() == [2]
    yield from window.undo()
    assert [len(obj.planar.pins) for obj in objects()] == [2, 2, 2]
