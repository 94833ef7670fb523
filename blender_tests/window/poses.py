# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed poses for the window tests, made as a user makes them, and what is asked about them."""

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from cutouts import active, ready
from harness import Window, addon

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def shown(obj: bpy.types.Object | None = None) -> np.ndarray:
    """What Blender shows of a mesh, by default of the active object, n x 3 float32."""
    mesh = (obj or active()).evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    coordinates = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)


def at(frame: int) -> np.ndarray:
    """What is shown after going to a frame."""
    bpy.context.scene.frame_set(frame)
    return shown()


def go_to(frame: int) -> Iterator[None]:
    """Go to a frame as a user does, which is an undo step."""
    bpy.context.scene.frame_set(frame)
    bpy.ops.ed.undo_push(message="Frame Change")
    yield


def timing() -> list[tuple]:
    """Frame, value, type and easing of each key of the poses' curve."""
    curve = addon("scene.sequence.pose_blocks").shown_curve(active().data.shape_keys)
    return [(*point.co, point.type, point.interpolation) for point in curve.keyframe_points]


def stored() -> tuple[Any, ...]:
    """All that is stored of the shapes and their timing, to the bit."""
    obj, keys = active(), active().data.shape_keys
    blocks = []
    for block in keys.key_blocks:
        coordinates = np.empty(len(block.data) * 3, np.float32)
        block.data.foreach_get("co", coordinates)
        blocks.append((block.name, block.frame, coordinates.tobytes()))
    listed = [(pose.name, pose.at) for pose in obj.planar.poses]
    return blocks, listed, timing(), keys.eval_time, obj.active_shape_key_index


def pin_place(index: int) -> tuple[float, float, float]:
    """Where a point pin is in the world: the weighted mean of its vertices as they are shown."""
    obj = active()
    group = obj.vertex_groups[obj.planar.pins[index].group].index
    weights = np.array([sum(e.weight for e in v.groups if e.group == group) for v in obj.data.vertices])
    x, y, z = weights @ shown() / weights.sum()
    return (float(x), float(y), float(z))


def pull(window: Window, dx: float, dz: float, index: int = 1) -> Iterator[None]:
    """Drag a pin of the active object."""
    x, y, z = pin_place(index)
    yield from window.drag(window.pixel((x, y, z)), window.pixel((x + dx, y, z + dz)))


def large_view(window: Window) -> Iterator[None]:
    """A view as large as the window, the sidebar open at our tab, with room for the list of poses."""
    with window.context():
        bpy.ops.screen.screen_full_area()
    yield from window.wait(0.3)
    yield from window.sidebar()
    region = window.region("UI")
    yield from window.click((region.x + 60, region.y + region.height - 17))  # closes the panel of pins
    yield from window.wait(0.3)


def key_pose(window: Window) -> Iterator[None]:
    """As the panel's button does."""
    with window.context("UI"):
        assert bpy.ops.planar.key_pose("INVOKE_DEFAULT", True) == {"FINISHED"}
    yield


def keyed(*ups: tuple[int, float]) -> None:
    """Key poses by a script: at each frame pin 1, which is selected, goes up by so much from where it is."""
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    for frame, up in ups:
        bpy.context.scene.frame_set(frame)
        bpy.ops.planar.drag_pins(offset=(0.0, up))
        bpy.ops.planar.key_pose()


def three_poses(window: Window, *, push: bool = False) -> Iterator[None]:
    """A sheet posed by the mouse and keyed at frames 1, 25 and 49; `push`: by clicking the panel's button."""
    yield from ready(window, LEFT, RIGHT)
    yield from large_view(window)
    for frame, (dx, dz) in ((1, (-0.5, 1.4)), (25, (0.3, -2.4)), (49, (-0.6, 1.6))):
        yield from go_to(frame)
        yield from pull(window, dx, dz)
        yield from (window.push("planar.key_pose") if push else key_pose(window))
