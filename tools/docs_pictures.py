# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the Pose tool in use, for docs/; `make docs` runs it by the window tests' harness."""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

ROOT = Path(__file__).resolve().parents[1]


def save(window: Any, name: str) -> None:
    """The 3D view as a JPEG in docs/images."""
    area = window.area
    crop = f"{area.width}x{area.height}+{area.x}+{window.window.height - area.y - area.height}"
    raw = window.picture(name)
    target = ROOT / "docs" / "images" / f"{name}.jpg"
    subprocess.run(["convert", raw, "-crop", crop, "+repage", "-quality", "88", target], check=True)


def pin_place(window: Any, name: str) -> tuple[int, int]:
    """Where a pin of the active object is on the screen."""
    obj = bpy.context.object
    (index,) = [group.index for group in obj.vertex_groups if group.name == name]
    vertices = [v.index for v in obj.data.vertices if any(g.group == index for g in v.groups)]
    points = [obj.active_shape_key.data[i].co for i in vertices]
    place: tuple[int, int] = window.pixel(obj.matrix_world @ (sum(points[1:], points[0]) / len(points)))
    return place


def test_pictures_of_the_pose_tool(window: Any) -> Iterator[None]:
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "out" / "demo.blend"), load_ui=False)
    yield from window.wait(0.5)
    bpy.context.preferences.view.show_tooltips = False
    obj = bpy.data.objects["Lantern Fox"]
    keys = obj.data.shape_keys.key_blocks
    for key in keys[1:]:
        key.value = float(key.name == "Wave")
    obj.active_shape_key_index = keys.find("Wave")
    bpy.context.view_layer.objects.active = obj

    with window.context():
        bpy.ops.screen.screen_full_area()
    yield from window.wait(0.5)
    yield from window.look("FRONT", 6.6)
    space = window.area.spaces.active
    space.region_3d.view_location = (0.35, 0, 2.0)
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "TEXTURE"
    space.overlay.show_outline_selected = False
    space.overlay.show_object_origins = False
    space.overlay.show_cursor = False
    space.overlay.show_extras = False
    space.show_region_ui = True
    yield from window.use_tool()
    yield from window.wait(0.5)  # the sidebar knows its tabs once it has been drawn
    window.region("UI").active_panel_category = "Planar"
    window.region("UI").tag_redraw()
    yield from window.wait(0.5)

    yield from window.click(pin_place(window, "Near Hand"))
    yield from window.hover(pin_place(window, "Near Elbow"))
    save(window, "pose_tool")

    obj.planar.show_mesh = True
    start = pin_place(window, "Near Hand")
    yield from window.hover(start)
    yield from window.press()
    yield from window.move((start[0] - 130, start[1] - 60), steps=12)
    yield from window.wait(0.5)
    save(window, "pose_tool_drag")
    yield from window.key("ESC")
