# SPDX-License-Identifier: GPL-3.0-or-later
"""What may happen to a drawing between and during drags: other tools, edits, files, shape keys, deletion."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import active, moved, pin_data, place, ready, shape
from harness import Window, fresh_file

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def begin_drag(window: Window) -> Iterator[None]:
    """Press the right pin and move it up; the button stays down."""
    yield from window.hover(window.pixel(place(1)))
    yield from window.press()
    x, _, z = place(1)
    yield from window.move(window.pixel((x, 0.0, z + 0.6)), steps=3)
    assert window.busy == ["PLANAR_OT_drag_pins"]


def key_points(name: str) -> np.ndarray:
    data = active().data.shape_keys.key_blocks[name].data
    coordinates = np.empty(len(data) * 3, np.float32)
    data.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)


def rest_shape() -> np.ndarray:
    data = active().data.attributes["planar_rest"].data
    coordinates = np.empty(len(data) * 3, np.float32)
    data.foreach_get("vector", coordinates)
    return coordinates


def test_other_tools_leave_pins_alone(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.use_tool("builtin.select_box")
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    assert np.array_equal(shape(), before)
    yield from window.key("G")  # now Blender's own: it moves the object
    yield from window.move(window.pixel((1.9, 0.0, 0.9)), steps=2)
    yield from window.key("ESC")
    assert window.busy == []
    yield from window.use_tool()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    assert moved(before, shape()) > 0.3


def test_save_and_reload(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    before, pins = shape(), pin_data()
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "posed.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
    yield from window.wait(0.3)
    assert np.array_equal(shape(), before)
    assert pin_data() == pins
    yield from window.use_tool()
    yield from window.drag(window.pixel(place(1)), window.pixel((1.2, 0.0, 1.0)))
    assert np.allclose(place(1), (1.2, 0.0, 1.0), atol=0.06), place(1)


def test_an_edit_of_the_mesh_between_two_drags(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    count = len(active().data.vertices)
    with window.context():
        bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="EDIT")
        bpy.ops.mesh.select_all("EXEC_DEFAULT", True, action="SELECT")
        bpy.ops.mesh.subdivide("EXEC_DEFAULT", True)
        bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="OBJECT")
    yield from window.wait(0.1)
    assert len(active().data.vertices) > count
    edited, rest = shape(), rest_shape()
    yield from begin_drag(window)
    yield from window.key("ESC")
    yield from window.release()
    assert np.array_equal(shape(), edited)
    assert np.array_equal(rest_shape(), rest), "the rest of the new vertices is not touched either"
    yield from window.drag(window.pixel(place(1)), window.pixel((1.0, 0.0, 0.9)))
    assert np.allclose(place(1), (1.0, 0.0, 0.9), atol=0.1), place(1)
    yield from window.undo()
    assert np.array_equal(shape(), edited)
    for _ in range(4):
        yield from window.undo()
    assert len(active().data.vertices) == count
    yield from window.drag(window.pixel(place(1)), window.pixel((1.0, 0.0, 0.5)))
    assert np.allclose(place(1), (1.0, 0.0, 0.5), atol=0.1), place(1)


def test_a_deleted_object_ends_the_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from begin_drag(window)
    bpy.data.objects.remove(active())
    yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
    assert window.busy == []
    yield from window.release()


def test_a_deleted_object_whose_name_is_taken_ends_the_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from begin_drag(window)
    name = active().name
    bpy.data.objects.remove(active())
    other = bpy.data.objects.new(name, bpy.data.meshes.new("Other"))
    bpy.context.collection.objects.link(other)
    yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
    assert window.busy == []
    yield from window.release()


def test_a_hidden_object_ends_the_drag_as_escape_does(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    obj = active()
    yield from begin_drag(window)
    obj.hide_set(True)
    yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
    assert window.busy == []
    yield from window.release()
    assert np.array_equal(shape(obj), before)


def test_a_file_loaded_during_a_drag_ends_it(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from begin_drag(window)
    fresh_file()
    yield from window.wait(0.3)
    assert window.busy == []
    yield from window.move((400, 400), steps=2)
    yield from window.release()
    yield from ready(window, LEFT, RIGHT)  # and the tool works in the new file
    before = shape()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    assert moved(before, shape()) > 0.3


def test_another_editor_in_place_of_the_view_during_a_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from begin_drag(window)
    area = window.area
    area.type = "IMAGE_EDITOR"
    yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
    yield from window.key("ESC")
    yield from window.release()
    assert window.busy == []
    assert np.array_equal(shape(), before)
    area.type = "VIEW_3D"
    yield from window.wait(0.2)


def test_the_add_on_turned_off_and_on_while_its_tool_is_active(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    (name,) = [name for name in bpy.context.preferences.addons.keys() if "planar" in name]  # noqa: SIM118
    before = shape()
    bpy.ops.preferences.addon_disable(module=name)
    yield from window.wait(0.2)
    assert not hasattr(bpy.types.Object, "planar")
    yield from window.click(window.pixel(RIGHT))
    yield from window.wait(0.2)
    bpy.ops.preferences.addon_enable(module=name)
    yield from window.use_tool()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    assert moved(before, shape()) > 0.3


def test_the_add_on_turned_off_during_a_drag_and_while_it_settles(window: Window) -> Iterator[None]:
    for released in (False, True):
        yield from ready(window, LEFT, RIGHT)
        (name,) = [name for name in bpy.context.preferences.addons.keys() if "planar" in name]  # noqa: SIM118
        before = shape()
        yield from begin_drag(window)
        yield from window.settled()
        assert moved(before, shape()) > 0.3
        if released:
            yield from window.move((window.mouse[0], window.mouse[1] + 60))
            yield from window.release()
        bpy.ops.preferences.addon_disable(module=name)
        assert released or np.array_equal(shape(), before), "the drag is taken back"
        posed = shape()
        yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
        yield from window.release()
        yield from window.wait(0.2)
        assert window.busy == []
        assert np.array_equal(shape(), posed)
        bpy.ops.preferences.addon_enable(module=name)
        yield from window.use_tool()
        yield from window.drag(window.pixel(place(1)), window.pixel((1.2, 0.0, 0.2)))
        assert moved(posed, shape()) > 0.1
        fresh_file()
        yield from window.wait(0.2)


def test_a_file_loaded_and_an_object_deleted_while_a_drag_settles(window: Window) -> Iterator[None]:
    for what in (fresh_file, lambda: bpy.data.objects.remove(active())):
        yield from ready(window, LEFT, RIGHT)
        yield from window.hover(window.pixel(place(1)))
        yield from window.press()
        yield from window.move(window.pixel((-1.0, 0.0, 1.2)))
        yield from window.release()
        what()
        yield from window.wait(0.3)
        assert window.busy == []
        fresh_file()
        yield from window.wait(0.2)


def test_undo_from_elsewhere_ends_the_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    before = shape()
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.5, 0.0, 0.6)))
    yield from begin_drag(window)
    with window.context():
        bpy.ops.ed.undo("EXEC_DEFAULT", True)
    yield from window.move((window.mouse[0] + 5, window.mouse[1] + 5), steps=2)
    yield from window.wait(0.2)
    assert window.busy == []
    yield from window.release()
    assert np.array_equal(shape(), before), "what undo left is not written over"


def test_a_drag_makes_a_pose_key_and_escape_takes_it_away(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    active().shape_key_add(name="Basis")
    bpy.ops.ed.undo_push(message="Basis")
    basis, mesh = key_points("Basis"), shape()
    yield from begin_drag(window)
    assert [key.name for key in active().data.shape_keys.key_blocks] == ["Basis", "Pose"]
    yield from window.key("ESC")
    yield from window.release()
    assert [key.name for key in active().data.shape_keys.key_blocks] == ["Basis"]
    assert active().active_shape_key_index == 0
    assert np.array_equal(key_points("Basis"), basis)
    assert np.array_equal(shape(), mesh)
    yield from begin_drag(window)
    yield from window.release()
    yield from window.settled()
    posed = key_points("Pose")
    assert moved(basis, posed) > 0.3
    assert np.array_equal(key_points("Basis"), basis)
    assert active().active_shape_key.name == "Pose"
    assert active().active_shape_key.value == 1.0
    yield from window.undo()
    assert [key.name for key in active().data.shape_keys.key_blocks] == ["Basis"]
    yield from window.redo()
    assert np.array_equal(key_points("Pose"), posed)
