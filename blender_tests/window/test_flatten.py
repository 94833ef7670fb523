# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatten by hand: from the UV menu, as seen in the UV editor; and its flat mesh posed with Live UV on."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, shape
from harness import Window
from test_menus import search


def tube(around: int = 24, along: int = 8) -> bpy.types.Object:
    """A tube with a seam at its back and a checker on it, as imported: along Y, turned and scaled."""
    angles = 2.0 * np.pi * np.arange(around) / around + np.pi / 2
    rows = np.linspace(-0.5, 0.5, along + 1)
    vertices = [(0.25 * np.cos(a), y, -0.25 * np.sin(a)) for y in rows for a in angles]
    first = [(j * around + i, j * around + (i + 1) % around) for j in range(along) for i in range(around)]
    mesh = bpy.data.meshes.new("Tube")
    mesh.from_pydata(vertices, [], [(a, b, b + around, a + around) for a, b in first])
    for edge in mesh.edges:
        edge.use_seam = all(vertex % around == 0 for vertex in edge.vertices)
    material = bpy.data.materials.new("Checker")
    material.use_nodes = True
    image = bpy.data.images.new("Checker", 512, 512)
    image.generated_type = "COLOR_GRID"
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    mesh.materials.append(material)
    obj = bpy.data.objects.new("Tube", mesh)
    bpy.context.collection.objects.link(obj)
    obj.rotation_euler, obj.scale, obj.location = (np.pi / 2, 0.0, 0.0), (2.0, 2.0, 2.0), (-2.5, 0.0, 0.0)
    activate(obj)
    return obj


def uvs(obj: bpy.types.Object) -> np.ndarray:
    layer = obj.data.uv_layers.active
    found = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", found)
    return found.reshape(-1, 2)


def textured(window: Window) -> Iterator[None]:
    yield from window.look("FRONT", distance=9.0)
    window.area.spaces.active.shading.color_type = "TEXTURE"
    yield from window.wait(0.3)


def uv_editor(window: Window) -> bpy.types.Area:
    """Beside the view."""
    before = set(window.window.screen.areas)
    with window.context():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.6)
    (area,) = set(window.window.screen.areas) - before
    area.ui_type = "UV"
    return area


def test_selected_faces_are_laid_flat_from_the_uv_menu_and_undone(window: Window) -> Iterator[None]:
    obj = tube()
    uv_editor(window)
    yield from textured(window)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.hover(window.pixel((-2.5, 0.0, 0.0)))
    yield from window.key("U")
    yield from window.wait(0.3)
    window.picture("flatten_menu")
    yield from window.key("UP_ARROW")
    yield from window.key("RET")
    yield from window.wait(0.5)
    assert bpy.context.window_manager.operators[-1].bl_idname == "PLANAR_OT_flatten", window.reports()
    assert bpy.context.mode == "EDIT_MESH"
    window.picture("flatten_uv")
    yield from window.key("TAB")
    yield
    assert np.ptp(uvs(obj), axis=0).max() > 0.9
    for _ in range(2):  # the mode, and all of Flatten
        yield from window.undo()
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not bpy.data.objects["Tube"].data.uv_layers


def bumpy(side: int = 160) -> bpy.types.Object:
    """A bumpy sheet, imported as the tube is: laying it flat takes a while."""
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, side), np.linspace(-1.0, 1.0, side))
    places = np.stack([x, y, 0.2 * np.sin(9.0 * x) * np.sin(7.0 * y)], axis=-1).reshape(-1, 3)
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.stack([first, first + 1, first + side + 1, first + side], axis=1)
    mesh = bpy.data.meshes.new("Bumpy")
    mesh.from_pydata(places.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Bumpy", mesh)
    bpy.context.collection.objects.link(obj)
    obj.rotation_euler, obj.scale = (np.pi / 2, 0.0, 0.0), (2.0, 2.0, 2.0)
    activate(obj)
    return obj


def test_escape_and_the_right_button_end_flatten_with_everything_as_it_was(window: Window) -> Iterator[None]:
    obj = bumpy()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look("FRONT")
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    before, meshes, drawn = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), shape()
    for mode, to, way_out in (("OBJECT", "MESH", "ESC"), ("EDIT", "UV", "RIGHTMOUSE")):
        bpy.ops.object.mode_set(mode=mode)
        bpy.ops.ed.undo_push(message="Mode")
        with window.context():
            assert bpy.ops.planar.flatten("INVOKE_DEFAULT", True, to=to) == {"RUNNING_MODAL"}
        yield
        assert window.busy == ["PLANAR_OT_flatten"]
        yield from window.key(way_out)
        yield
        assert window.busy == []
        assert bpy.context.mode == {"OBJECT": "OBJECT", "EDIT": "EDIT_MESH"}[mode]
        assert sorted(bpy.data.objects.keys()) == before
        assert sorted(bpy.data.meshes.keys()) == meshes
        assert active() == bpy.data.objects["Bumpy"]
        assert not obj.data.uv_layers
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.array_equal(shape(), drawn)
    assert not window.reports().count("Error"), window.reports()
    # Nothing of it is in the way of the next one.
    with window.context():
        bpy.ops.planar.flatten("INVOKE_DEFAULT", True, iterations=1)
    for _ in range(600):
        if not window.busy:
            break
        yield
    assert active().name == "Bumpy Flat", window.reports()
    yield from window.undo()
    assert sorted(bpy.data.objects.keys()) == before


def test_in_the_uv_editor_islands_are_laid_flat_where_they_are_seen(window: Window) -> Iterator[None]:
    obj = tube()
    for edge in obj.data.edges:
        edge.use_seam = edge.use_seam or all(vertex % 24 == 12 for vertex in edge.vertices)
    area = uv_editor(window)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    yield from window.wait(0.2)
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window.window, area=area, region=region):
        bpy.ops.planar.flatten("INVOKE_DEFAULT", to="UV")
    yield from window.wait(0.5)
    assert bpy.context.mode == "EDIT_MESH"
    window.picture("flatten_uv_editor")
    bpy.ops.object.mode_set(mode="OBJECT")
    found = uvs(bpy.data.objects["Tube"])
    assert found.min() >= 0.0
    assert found.max() <= 1.0
    assert np.ptp(found, axis=0).max() > 0.9


def test_pins_of_the_flat_mesh_are_dragged_and_the_surface_s_map_follows_live(
    window: Window,
) -> Iterator[None]:
    tube()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from textured(window)
    yield from search(window, "Flatten")
    assert active().name == "Tube Flat", window.reports()
    yield from window.sidebar()
    yield from window.push("planar.push_to_uv_map")
    assert active().planar.uv_scale > 0.0, window.reports()
    window.area.spaces.active.show_region_ui = False
    yield from window.use_tool()
    places = np.array([active().matrix_world @ vertex.co for vertex in active().data.vertices])
    low, high = places.min(axis=0) + 0.2, places.max(axis=0) - 0.2
    left, right = (low[0], 0.0, low[2]), (high[0], 0.0, high[2])
    for place in (left, right):
        yield from window.click(window.pixel(place), ctrl=True)
    assert len(active().planar.pins) == 2
    active().planar.live_uv = True
    bpy.ops.ed.undo_push(message="Live UV")
    yield from window.wait(0.3)
    window.picture("live_before")
    surface = bpy.data.objects["Tube"]
    before, drawn = uvs(surface), shape()
    goal = window.pixel((right[0] - 0.6, 0.0, right[2] + 1.0))
    for way_out in ("ESC", "RIGHTMOUSE"):
        yield from window.hover(window.pixel(right))
        yield from window.press()
        yield from window.move(goal, steps=6)
        yield from window.wait(0.3)
        assert np.abs(uvs(surface) - before).max() > 0.05, "while it is dragged"
        yield from window.key(way_out)
        yield from window.release()
        assert np.array_equal(uvs(surface), before)
        assert np.array_equal(shape(), drawn)
    yield from window.drag(window.pixel(right), goal)
    yield from window.wait(0.5)
    window.picture("live_after")
    surface = bpy.data.objects["Tube"]
    after = uvs(surface)
    assert np.abs(after - before).max() > 0.05
    yield from window.undo()
    assert np.array_equal(uvs(bpy.data.objects["Tube"]), before), "one step takes both back"
    assert np.array_equal(shape(), drawn)
    yield from window.redo()
    assert np.array_equal(uvs(bpy.data.objects["Tube"]), after)
