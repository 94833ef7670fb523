# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness painted with real strokes, and felt at once."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved, place, ready, shape
from harness import Window, fresh_file

LEFT, RIGHT, MIDDLE = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 0.0)


def weights() -> np.ndarray:
    """The painted stiffness of each vertex."""
    obj = active()
    group = obj.vertex_groups[obj.planar.stiffness_group]
    return np.array([group.weight(vertex.index) for vertex in obj.data.vertices])


def posed(window: Window) -> Iterator[None]:
    """A sheet that is bent."""
    yield from ready(window, LEFT, MIDDLE, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((0.8, 0.0, 1.2)))
    yield from settled(window)


def settled(window: Window) -> Iterator[None]:
    """Wait until the drawing stands still."""
    still = 0
    before = shape()
    for _ in range(100):
        yield from window.wait(0.1)
        still = 0 if window.busy or moved(before, shape()) > 0.0 else still + 1
        before = shape()
        if still >= 4:
            return
    raise AssertionError("the drawing does not come to rest")


def paint_mode(window: Window) -> Iterator[None]:
    """As the panel's button does; with a brush of the file's own where Blender came without any."""
    with window.context():
        bpy.ops.planar.paint_stiffness("INVOKE_DEFAULT", True)
    yield from window.wait(0.3)
    if bpy.context.tool_settings.weight_paint.brush is None:
        brush = bpy.data.brushes.new("Test Brush", mode="WEIGHT_PAINT")
        brush.asset_mark()
        with window.context():
            bpy.ops.brush.asset_activate(
                asset_library_type="LOCAL", relative_asset_identifier="Brush/Test Brush"
            )
        yield from window.wait(0.2)


def object_mode(window: Window) -> Iterator[None]:
    """As the panel's Done does."""
    with window.context():
        bpy.ops.object.mode_set("INVOKE_DEFAULT", True, mode="OBJECT")
    yield from window.wait(0.2)


def stroke(window: Window, *way: tuple[float, float, float]) -> Iterator[None]:
    """A stroke of the brush along these places."""
    yield from window.move(window.pixel(way[0]))
    yield from window.press()
    for spot in way[1:]:
        yield from window.move(window.pixel(spot), steps=10)
    yield from window.release()
    yield


def test_a_stroke_is_felt_at_once_and_undone_with_what_it_did(window: Window) -> Iterator[None]:
    yield from posed(window)
    before, pin = shape(), place(2)
    yield from paint_mode(window)
    assert bpy.context.mode == "PAINT_WEIGHT"
    assert set(weights()) == {0.5}
    yield from settled(window)
    assert np.array_equal(shape(), before), "opening it changes nothing"
    yield from stroke(window, (-1.2, 0.0, 0.8), (0.2, 0.0, -0.8))
    painted = weights()
    assert painted.max() > 0.9
    assert painted.min() == 0.5
    yield from settled(window)
    stiff = shape()
    assert moved(before, stiff) > 0.05, "in Weight Paint still"
    assert np.allclose(place(2), pin, atol=0.02), "the pins hold"
    window.picture("stiffness-stroke")
    yield from stroke(window, (-1.4, 0.0, -0.3), (-0.6, 0.0, -0.6))
    yield from settled(window)
    twice = shape()
    assert moved(stiff, twice) > 1e-3
    yield from window.undo()
    yield from settled(window)
    assert np.array_equal(weights(), painted)
    assert moved(stiff, shape()) < 0.01
    yield from window.undo()
    yield from settled(window)
    assert moved(before, shape()) < 0.01
    yield from window.redo()
    yield from window.redo()
    yield from settled(window)
    assert moved(twice, shape()) < 0.01
    yield from object_mode(window)
    yield from settled(window)
    assert moved(twice, shape()) < 0.01
    assert window.tool == "planar.pose_tool", "back in the Pose tool"


def test_leaving_at_once_settles_too(window: Window) -> Iterator[None]:
    yield from posed(window)
    before = shape()
    yield from paint_mode(window)
    yield from stroke(window, (-1.2, 0.0, 0.8), (0.2, 0.0, -0.8))
    bpy.ops.object.mode_set("INVOKE_DEFAULT", True, mode="OBJECT")  # in the same moment
    assert np.array_equal(shape(), before)
    yield from settled(window)
    after = shape()
    assert moved(before, after) > 0.05
    yield from window.undo()
    yield from settled(window)
    assert np.array_equal(shape(), before), "settling was a step of its own"
    yield from window.redo()
    yield from settled(window)
    assert np.array_equal(shape(), after)


def test_a_stiff_limb_bends_elsewhere(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from paint_mode(window)
    for height in (0.6, 0.2, -0.2, -0.6):
        yield from stroke(window, (0.4, 0.0, height), (1.9, 0.0, height))
    painted, rest = weights(), shape()
    stiff = painted > 0.95
    assert 0.2 < stiff.mean() < 0.6
    yield from object_mode(window)
    yield from window.drag(window.pixel(RIGHT), window.pixel((0.6, 0.0, 1.4)), steps=16)
    yield from settled(window)
    after = shape()
    assert np.allclose(place(1), (0.6, 0.0, 1.4), atol=0.05)

    def form(chosen: np.ndarray) -> float:
        """How far these vertices are from being moved rigidly, relative to their size."""
        a, b = rest[chosen][:, [0, 2]].astype(float), after[chosen][:, [0, 2]].astype(float)
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        u, _, v = np.linalg.svd(a.T @ b)
        return float(np.linalg.norm(a @ u @ v - b) / np.linalg.norm(a))

    left = rest[:, 0] < -0.3
    assert form(stiff) < 0.02, form(stiff)
    assert form(left) > 5.0 * form(stiff), (form(left), form(stiff))


def test_akvf_feels_it_at_the_next_move(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, MIDDLE, RIGHT)
    active().planar.method = "AKVF"
    yield from window.drag(window.pixel(RIGHT), window.pixel((0.8, 0.0, 1.2)))
    yield from settled(window)
    before = shape()
    yield from paint_mode(window)
    yield from stroke(window, (-1.2, 0.0, 0.8), (0.2, 0.0, -0.8))
    yield from settled(window)
    assert weights().max() > 0.9
    assert np.array_equal(shape(), before)


def test_it_ends_with_the_object_the_file_and_the_add_on(window: Window) -> Iterator[None]:
    """Errors would be printed, which run.py takes as a failure."""
    way = (-1.2, 0.0, 0.8), (0.2, 0.0, -0.8)
    yield from posed(window)
    yield from paint_mode(window)
    yield from stroke(window, *way)
    bpy.ops.object.mode_set("INVOKE_DEFAULT", True, mode="OBJECT")
    bpy.data.objects.remove(active())
    yield from window.wait(0.5)

    yield from posed(window)
    yield from paint_mode(window)
    yield from stroke(window, *way)
    yield from window.wait(0.06)
    fresh_file()
    yield from window.wait(0.5)

    yield from posed(window)
    yield from paint_mode(window)
    yield from stroke(window, *way)
    name = next(
        each.module for each in bpy.context.preferences.addons if each.module.endswith("planar_deform")
    )
    bpy.ops.preferences.addon_disable(module=name)
    before = shape()
    yield from window.wait(0.5)
    assert np.array_equal(shape(), before)
    bpy.ops.preferences.addon_enable(module=name)
    yield from window.wait(0.2)
    yield from stroke(window, (-1.4, 0.0, -0.3), (-0.6, 0.0, -0.6))
    yield from settled(window)
    assert moved(before, shape()) > 0.05, "on again, it follows the next stroke"
