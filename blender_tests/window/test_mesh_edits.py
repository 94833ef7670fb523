# SPDX-License-Identifier: GPL-3.0-or-later
"""What hands do to the mesh of a posed drawing: apply its scale, scale and subdivide it, join layers."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, imported, pin, shape, sheet
from harness import Window, addon
from poses import keyed

PLACES = (-1.2, 0.0, 0.0), (1.2, 0.0, 0.0), (0.1, 0.0, 0.5)


def posed(window: Window) -> Iterator[None]:
    """A sheet of another size than 1, one of whose pins has been dragged up."""
    sheet()
    active().scale = (0.8, 0.8, 0.8)
    pin(*PLACES)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look()
    yield from window.use_tool()
    yield from window.drag(window.pixel(PLACES[1]), window.pixel((0.9, 0.0, 0.9)))


def in_world(obj: bpy.types.Object) -> np.ndarray:
    matrix = np.array(obj.matrix_world)
    return shape(obj) @ matrix[:3, :3].T + matrix[:3, 3]


def area() -> float:
    bpy.context.view_layer.update()
    return float(addon("scene.view.snapshot").of_active(bpy.context).distortion.area)


def pins_seen() -> np.ndarray:
    return np.array([seen.place for seen in addon("scene.view.snapshot").of_active(bpy.context).pins])


def apply_scale(window: Window) -> Iterator[None]:
    yield from window.hover(window.pixel((0.0, 0.0, -1.5)))
    yield from window.key("A", ctrl=True)
    yield from window.wait(0.3)
    yield from window.key("S")
    yield from window.wait(0.3)


def test_a_scale_that_is_applied_leaves_the_pose_what_it_is(window: Window) -> Iterator[None]:
    yield from posed(window)
    before, distorted, pins = in_world(active()), area(), pins_seen()
    yield from apply_scale(window)
    assert tuple(active().scale) == (1.0, 1.0, 1.0)
    assert np.abs(in_world(active()) - before).max() < 1e-5
    assert abs(area() - distorted) < 1e-4
    assert np.abs(pins_seen() - pins).max() < 1e-4
    yield from window.drag(window.pixel(pins[0]), window.pixel(pins[0] - (0.05, 0.0, 0.0)))
    assert np.abs(in_world(active()) - before).max() < 0.3, "nothing is torn"
    yield from window.undo()
    assert np.abs(in_world(active()) - before).max() < 1e-5
    yield from window.undo()
    assert abs(active().scale.x - 0.8) < 1e-6
    assert np.abs(in_world(active()) - before).max() < 1e-5
    assert abs(area() - distorted) < 1e-4
    yield from window.redo()
    assert tuple(active().scale) == (1.0, 1.0, 1.0)
    assert abs(area() - distorted) < 1e-4
    yield from window.drag(window.pixel(pins[0]), window.pixel(pins[0] - (0.05, 0.0, 0.0)))
    assert np.abs(in_world(active()) - before).max() < 0.3


def test_all_scaled_and_subdivided_in_edit_mode(window: Window) -> Iterator[None]:
    yield from posed(window)
    distorted, pins = area(), pins_seen()
    yield from window.hover(window.pixel((0.0, 0.0, -1.5)))
    yield from window.key("TAB")
    yield from window.wait(0.2)
    yield from window.key("A")
    with window.context():
        assert bpy.ops.mesh.subdivide("INVOKE_DEFAULT") == {"FINISHED"}
    yield
    yield from window.key("S")
    yield from window.type("1.2")
    yield from window.key("RET")
    yield from window.key("TAB")
    yield from window.wait(0.2)
    assert active().mode == "OBJECT"
    assert len(active().data.vertices) == 33 * 17
    assert abs(area() - distorted) < 0.02, f"{distorted} became {area()}"  # a bent quad gets finer
    grown = pins_seen()
    sides = [np.linalg.norm(places[0] - places[2]) for places in (pins, grown)]
    assert abs(sides[1] / sides[0] - 1.2) < 0.01
    before = in_world(active())
    yield from window.drag(window.pixel(grown[0]), window.pixel(grown[0] - (0.05, 0.0, 0.0)))
    assert np.abs(in_world(active()) - before).max() < 0.3


def test_layers_that_are_joined_keep_their_pins(window: Window) -> Iterator[None]:
    yield from posed(window)
    first, name, pins = active(), active().name, pins_seen()
    with window.context():
        bpy.ops.object.duplicate()
    second = active()
    second.location = (0.0, -0.1, -1.6)
    activate(first)
    second.select_set(True)
    bpy.ops.ed.undo_push(message="Moved")
    yield from window.wait(0.2)
    yield from window.hover(window.pixel((2.5, 0.0, 1.5)))
    yield from window.key("J", ctrl=True)
    yield from window.wait(0.3)
    assert len(active().planar.pins) == 6, "they are in the list by themselves"
    seen = pins_seen()
    assert np.abs(seen[:3] - pins).max() < 1e-4
    assert np.abs(seen[3:] - pins - (0.0, -0.1, -1.6)).max() < 1e-4
    window.picture("mesh_edits_joined")
    before = in_world(active())
    yield from window.drag(window.pixel(seen[4]), window.pixel(seen[4] + (0.1, 0.0, 0.1)))
    moved = np.abs(in_world(active()) - before).max(axis=1)
    assert moved[:153].max() < 1e-5, "the other layer stays"
    assert 0.05 < moved[153:].max() < 0.5
    yield from window.undo()
    yield from window.undo()
    assert len(bpy.data.objects[name].planar.pins) == 3
    assert np.abs(pins_seen() - pins).max() < 1e-4
    yield from window.redo()
    assert len(active().planar.pins) == 6
    assert np.abs(pins_seen()[3:] - seen[3:]).max() < 1e-4


FRAMES = range(1, 25)


def film(*names: str) -> np.ndarray:
    """What is shown of objects in the world at each frame, those there are."""
    frame, found = bpy.context.scene.frame_current, []
    for number in FRAMES:
        bpy.context.scene.frame_set(number)
        found.append(np.concatenate([shown_in_world(name) for name in names if name in bpy.data.objects]))
    bpy.context.scene.frame_set(frame)
    return np.array(found)


def shown_in_world(name: str) -> np.ndarray:
    shown = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = np.array(shown.matrix_world)
    places = np.empty(len(shown.data.vertices) * 3, np.float32)
    shown.data.vertices.foreach_get("co", places)
    return places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def listed(name: str) -> list[float]:
    return [pose.frame for pose in bpy.data.objects[name].planar.poses]


def two_keyed_layers(window: Window) -> Iterator[None]:
    """Of one the mesh is drawn in XY and scaled; the in-betweens of the other are generated."""
    yield from window.look(distance=9.0)
    yield from window.use_tool()
    imported("Second").location = (0.0, -0.1, -1.6)
    bpy.context.view_layer.update()
    pin((-1.2, 0.0, -1.6), (1.2, 0.0, -1.6))
    keyed((5, 0.3), (20, -0.6))
    sheet("First").scale = (0.8, 0.8, 0.8)
    pin(*PLACES)
    keyed((1, 0.2), (13, 0.6), (24, -0.5))
    bpy.ops.planar.generate_inbetweens()
    bpy.data.objects["Second"].select_set(True)
    bpy.context.scene.frame_set(9)
    bpy.ops.ed.undo_push(message="Keyed")
    yield from window.wait(0.3)
    yield from window.hover(window.pixel((2.5, 0.0, 1.5)))


def test_layers_with_keyed_poses_play_on_after_a_join(window: Window) -> Iterator[None]:
    yield from two_keyed_layers(window)
    names = "First", "Second"
    before, lists = film(*names), [listed(name) for name in names]
    assert lists == [[1, 13, 24], [5, 20]]
    yield from window.wait(0.2)
    yield from window.key("J", ctrl=True)
    yield from window.wait(0.5)
    assert active().name == "First"
    assert "Second" not in bpy.data.objects
    assert listed("First") == [1, 5, 13, 20, 24]
    assert np.abs(film(*names) - before).max() < 1e-4
    window.picture("joined-poses")
    pins = pins_seen()
    assert len(pins) == 5
    for _ in range(2):
        yield from window.undo()
        yield from window.wait(0.3)
        assert [listed(name) for name in names] == lists
        assert np.abs(film(*names) - before).max() < 1e-4
        yield from window.redo()
        yield from window.wait(0.3)
        assert listed("First") == [1, 5, 13, 20, 24]
        assert np.abs(film(*names) - before).max() < 1e-4
    yield from window.click(window.pixel(pins_seen()[4]))
    yield from window.drag(window.pixel(pins_seen()[4]), window.pixel(pins_seen()[4] + (0.2, 0.0, 0.3)))
    yield from window.key("I")
    assert listed("First") == [1, 5, 9, 13, 20, 24]
    yield from window.undo()
    yield from window.undo()
    yield from window.wait(0.3)
    assert np.abs(film(*names) - before).max() < 1e-4
    yield from window.undo()
    yield from window.undo()
    yield from window.wait(0.3)
    assert [listed(name) for name in names] == lists
    assert np.abs(film(*names) - before).max() < 1e-4


def test_a_keyed_layer_joined_to_an_unkeyed_pose_of_another(window: Window) -> Iterator[None]:
    yield from two_keyed_layers(window)
    names = "First", "Second"
    start = pins_seen()[1]
    activate(bpy.data.objects["First"])
    yield from window.drag(window.pixel(start), window.pixel(start + np.array([0.2, 0.0, 0.4])))
    bpy.data.objects["Second"].select_set(True)
    yield from window.wait(0.2)
    before = np.concatenate([shown_in_world(name) for name in names])
    yield from window.hover(window.pixel((2.5, 0.0, 1.5)))
    yield from window.key("J", ctrl=True)
    yield from window.wait(0.5)
    assert np.abs(shown_in_world("First") - before).max() < 1e-4, "what was not keyed yet stays shown"
    yield from window.key("I")
    assert listed("First") == [1, 5, 9, 13, 20, 24]
    assert np.abs(shown_in_world("First") - before).max() < 1e-4


def test_what_a_join_cannot_keep_is_told_at_the_mouse(window: Window) -> Iterator[None]:
    yield from two_keyed_layers(window)
    sheet("Smiling")
    for name in ("Basis", "Smile"):
        active().shape_key_add(name=name)
    bpy.data.objects["Second"].select_set(True)
    bpy.ops.ed.undo_push(message="Smile")
    place = window.pixel((2.5, 0.0, 1.5))
    yield from window.hover(place)
    before = window.colours(place, 20)
    yield from window.key("J", ctrl=True)
    yield from window.wait(0.5)
    window.picture("join-loses")
    assert window.colours(place, 20) != before, "a message is at the mouse"
    yield from window.key("ESC")
    yield from window.wait(0.3)
    assert window.busy == []
    yield from window.undo()
    yield from window.wait(0.3)
    assert listed("Second") == [5, 20]
