# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding, dragging and turning pins through cameras of all kinds, and in views without one."""

import math
from collections.abc import Iterator

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from cutouts import activate, active, imported, pin, place, selected
from harness import Window
from mathutils import Vector

LEFT, RIGHT, SPOT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.35, 0.0, 0.2)
RADIUS = 36  # pixels of the ring at a UI scale of 1

CAMERAS: dict[str, dict[str, object]] = {
    "orthographic": {"type": "ORTHO"},
    "orthographic, near": {"type": "ORTHO", "clip_start": 1e-3, "clip_end": 12.0},
    "orthographic, far": {"type": "ORTHO", "clip_start": 5.0, "clip_end": 1e6},
    "orthographic, just so": {"type": "ORTHO", "clip_start": 7.0, "clip_end": 10.0},
    "orthographic, shifted": {"type": "ORTHO", "shift_x": 0.15, "shift_y": -0.1, "sensor_fit": "VERTICAL"},
    "perspective": {"type": "PERSP"},
    "perspective, shifted": {"type": "PERSP", "shift_x": -0.2, "shift_y": 0.1, "sensor_fit": "VERTICAL"},
    "perspective, far": {"type": "PERSP", "clip_start": 0.01, "clip_end": 1e5},
}


def scene() -> None:
    imported()
    pin(LEFT, RIGHT)
    bpy.ops.ed.undo_push(message="Test Scene")


def camera(settings: dict[str, object]) -> None:
    """A camera of these settings before the drawing, a little askew; the drawing stays the active object."""
    drawing, data = active(), bpy.data.cameras.new("Camera")
    data.ortho_scale, data.lens = 7.0, 40.0
    for name, value in settings.items():
        setattr(data, name, value)
    seen_from = bpy.data.objects.new("Camera", data)
    seen_from.location, seen_from.rotation_euler = (1.0, -8.0, 1.2), (1.44, 0.05, 0.1)
    bpy.context.collection.objects.link(seen_from)
    bpy.context.scene.camera = seen_from
    activate(drawing)
    bpy.ops.ed.undo_push(message="Camera")


def off(window: Window, index: int, pixel: tuple[int, int]) -> float:
    """How many pixels a pin is from where the mouse took it."""
    return float(np.hypot(*np.subtract(window.pixel(place(index)), pixel)))


def works(window: Window, name: str) -> Iterator[None]:
    """A pin is added, dragged, and turned with another one; then all that is undone."""
    spot = window.pixel(SPOT)
    yield from window.click(spot, ctrl=True)
    assert len(active().planar.pins) == 3, f"{name}: Ctrl-click adds a pin"
    assert off(window, 2, spot) < 2.0, name
    end = (spot[0] + 20, spot[1] + 25)
    yield from window.drag(spot, end)
    assert selected() == [2], name
    assert off(window, 2, end) < 3.0, f"{name}: the pin is under the mouse"
    yield from window.click(window.pixel(place(1)), shift=True)
    assert selected() == [1, 2], name
    before = place(1) - place(2)
    x, y = window.pixel((place(1) + place(2)) / 2)
    yield from window.hover((x, y + RADIUS))
    yield from window.press()
    for step in range(1, 9):
        angle = math.radians(90.0 + 5.0 * step)
        yield from window.move((round(x + 90 * math.cos(angle)), round(y + 90 * math.sin(angle))))
    yield from window.release()
    yield from window.settled()
    after = place(1) - place(2)
    turned = np.degrees(np.arctan2(after[2], after[0]) - np.arctan2(before[2], before[0]))
    assert 30.0 < turned < 50.0, f"{name}: turned by {turned}"
    for _ in range(4):
        yield from window.undo()
    assert len(active().planar.pins) == 2, name


def test_pins_through_cameras_of_all_kinds(window: Window) -> Iterator[None]:
    scene()
    yield from window.use_tool()
    for name, settings in CAMERAS.items():
        camera(settings)
        window.view.view_perspective = "CAMERA"
        yield from window.wait(0.2)
        yield from works(window, name)


def test_a_camera_view_that_is_zoomed_and_moved(window: Window) -> Iterator[None]:
    scene()
    camera({"type": "ORTHO", "sensor_fit": "VERTICAL"})
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 720, 1280
    yield from window.use_tool()
    window.view.view_perspective = "CAMERA"
    window.view.view_camera_zoom, window.view.view_camera_offset = 35.0, (0.06, -0.04)
    yield from window.wait(0.2)
    yield from works(window, "zoomed and moved")


def test_a_click_through_an_orthographic_camera_finds_the_layer(window: Window) -> Iterator[None]:
    scene()
    front, back = active(), imported("Back")
    back.location = (0.0, 1.0, 1.6)
    activate(front)
    camera({"type": "ORTHO", "clip_end": 1e4})
    yield from window.use_tool()
    window.view.view_perspective = "CAMERA"
    yield from window.wait(0.2)
    yield from window.click(window.pixel((0.5, 1.0, 2.2)))
    assert active().name == "Back"
    yield from window.click(window.pixel((0.5, 0.0, -0.4)))
    assert active().name == "Imported"


def test_orthographic_views_of_drawings_that_stand_and_lie(window: Window) -> Iterator[None]:
    scene()
    yield from window.use_tool()
    for clip_end in (1000.0, 1e6):
        window.area.spaces.active.clip_end = clip_end
        yield from window.look("FRONT", distance=7.0)
        yield from works(window, f"Front, clipped at {clip_end}")
    lying = active()
    lying.rotation_euler, lying.location = (0.0, 0.0, 0.4), (0.3, 0.1, -2.0)
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="Laid Down")
    yield from window.look("TOP", distance=7.0)
    spot = tuple(lying.matrix_world @ Vector((0.2, 0.1, 0.0)))
    yield from window.click(window.pixel(spot), ctrl=True)
    assert len(active().planar.pins) == 3
    end = window.pixel((spot[0] + 0.2, spot[1] + 0.3, -2.0))
    yield from window.drag(window.pixel(spot), end)
    assert off(window, 2, end) < 3.0


def test_the_views_of_a_quad_view(window: Window) -> Iterator[None]:
    scene()
    yield from window.look("FRONT", distance=9.0)
    yield from window.use_tool()
    with window.context():
        bpy.ops.screen.region_quadview()
    yield from window.wait(0.4)
    dragged = 0
    for number in range(4):
        region = [region for region in window.area.regions if region.type == "WINDOW"][number]
        view = window.area.spaces.active.region_quadviews[number]
        if abs((view.view_rotation @ Vector((0.0, 0.0, 1.0))).y) < 0.2:
            continue  # edge-on
        start = in_region(region, view, place(1))
        end = start[0] - 15, start[1] + 20
        yield from window.drag(start, end)
        assert selected() == [1]
        gap = np.hypot(*np.subtract(in_region(region, view, place(1)), end))
        assert gap < 3.0, f"view {number}: {gap} pixels off"
        dragged += 1
    assert dragged >= 1


def in_region(region: bpy.types.Region, view: bpy.types.RegionView3D, spot: np.ndarray) -> tuple[int, int]:
    """Window coordinates of a world position in one of several views."""
    seen = location_3d_to_region_2d(region, view, Vector(spot))
    return region.x + round(seen.x), region.y + round(seen.y)
