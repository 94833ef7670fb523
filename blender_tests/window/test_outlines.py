# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in the window: keyed from the panel, posed in Edit Mode with Blender's own keys, and filled in."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active
from harness import Window, addon
from poses import large_view

WAVE = [(0.5 * i - 1.5, 0.0, 0.4 * (-1) ** i) for i in range(7)]


def line(kind: str) -> bpy.types.Object:
    """An open line in the XZ plane: a mesh of edges, or a poly curve."""
    if kind == "MESH":
        data = bpy.data.meshes.new("Line")
        data.from_pydata(WAVE, [(i, i + 1) for i in range(6)], [])
    else:
        data = bpy.data.curves.new("Line", "CURVE")
        data.dimensions = "3D"
        points = data.splines.new("POLY").points
        points.add(6)
        for point, place in zip(points, WAVE, strict=True):
            point.co = (*place, 1.0)
    obj = bpy.data.objects.new("Line", data)
    bpy.context.collection.objects.link(obj)
    activate(obj)
    return obj


def shown() -> np.ndarray:
    """What Blender shows of the active line, n x 3."""
    evaluated = active().evaluated_get(bpy.context.evaluated_depsgraph_get())
    vertices = (evaluated.data if evaluated.type == "MESH" else evaluated.to_mesh()).vertices
    coordinates = np.empty(len(vertices) * 3, np.float32)
    vertices.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)


def at(frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    return shown()


def pose(window: Window, *commands: str) -> Iterator[None]:
    """Into Edit Mode, everything selected, some transforms typed, and back."""
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    yield from window.key("TAB")
    assert active().mode == "EDIT"
    yield from window.key("A")
    for command in commands:
        keys, _, number = command.partition(" ")
        for key in keys:
            yield from window.key(key)
        yield from window.type(number)
        yield from window.key("RET")
    yield from window.wait(0.2)
    yield from window.key("TAB")
    assert active().mode == "OBJECT"
    yield


def story(window: Window, kind: str) -> Iterator[None]:
    line(kind)
    bpy.ops.ed.undo_push(message="Line")
    yield from window.look("FRONT")
    yield from large_view(window)
    bpy.context.scene.frame_set(1)
    yield from window.push("planar.key_pose")
    start = shown()
    bpy.context.scene.frame_set(25)
    yield from window.push("planar.key_pose")
    yield from pose(window, "R 90", "GX 1")
    end = shown()
    turned = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float)  # R turns clockwise as the view is seen
    centre = start.mean(axis=0)
    assert np.abs(end - ((start - centre) @ turned.T + centre + [1, 0, 0])).max() < 1e-4
    assert np.array_equal(at(1), start)
    yield from pose(window, "GZ 1")  # of the frame, not the pose keyed last
    start = start + np.float32([0, 0, 1])
    assert np.abs(shown() - start).max() < 1e-6
    assert np.array_equal(at(25), end)
    blended = at(13)
    yield from window.push("planar.generate_inbetweens")
    while window.busy:
        yield
    yield
    middle = at(13)
    assert np.array_equal(at(25), end)
    lengths = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (start, middle, blended)]
    assert np.abs(lengths[1] - lengths[0]).max() < 1e-4, "turned, and not shrunk as by blending"
    assert lengths[2].max() < 0.8 * lengths[0].min()
    bpy.context.scene.frame_set(13)
    active().planar.show_onion = True
    yield from window.wait(0.5)
    window.picture(f"outlines_{kind.lower()}")
    bpy.context.scene.frame_set(25)
    yield from pose(window, "GX 1")
    assert addon("scene.sequence.stretches").stale(active()) == [(0, 1)]
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    yield from window.key("TAB")
    yield from window.wait(0.5)
    window.picture(f"outlines_{kind.lower()}_edit")
    yield from window.key("TAB")


def test_a_mesh_of_edges(window: Window) -> Iterator[None]:
    yield from story(window, "MESH")


def test_a_poly_curve(window: Window) -> Iterator[None]:
    yield from story(window, "CURVE")
