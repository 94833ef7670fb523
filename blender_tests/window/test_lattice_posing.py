# SPDX-License-Identifier: GPL-3.0-or-later
"""Posing a lattice by hand: pins on several objects and on points of the lattice, drags, Escape, undo."""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import bpy
import numpy as np
from cutouts import activate, active, imported, pin_data, selected, shape, sheet
from harness import Window, addon
from mathutils import Euler
from poses import shown

LEFT, RIGHT, OF_FRONT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0), (0.25, -0.3, 0.5)


def layered(counts: Sequence[int] = (10, 8, 1)) -> bpy.types.Object:
    """A sheet and an imported one before it in a flat lattice that stands upright; the lattice is active."""
    back, front = sheet("Back"), imported("Front", scale=0.5)
    front.scale = (0.2, 0.2, 0.2)
    front.location = (0.25, -0.3, 0.5)
    data = bpy.data.lattices.new("Cage")
    cage = bpy.data.objects.new("Cage", data)
    data.points_u, data.points_v, data.points_w = counts  # spaced by 1 where it has no object yet
    cage.rotation_euler = Euler((np.pi / 2, 0.0, 0.0))
    cage.scale = (6.0, 4.0, 3.0)
    bpy.context.collection.objects.link(cage)
    for obj in (back, front):
        obj.modifiers.new("Lattice", "LATTICE").object = cage
    activate(cage)
    return cage


def ready(window: Window, counts: Sequence[int] = (10, 8, 1)) -> Iterator[None]:
    layered(counts)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look("FRONT")
    yield from window.use_tool()


def points() -> np.ndarray:
    """The lattice's own points, to the bit."""
    found = np.empty(len(active().data.points) * 3, np.float32)
    active().data.points.foreach_get("co_deform", found)
    return found.reshape(-1, 3)


def place(index: int) -> np.ndarray:
    """Where the Pose tool shows a pin."""
    mark = addon("scene.view.snapshot").of_active(bpy.context).pin(index)
    assert mark is not None, f"pin {index} is nowhere"
    return mark.place


def grid_point(index: int) -> np.ndarray:
    return np.array(active().matrix_world @ active().data.points[index].co_deform)


def beside(place: np.ndarray, dx: float, dz: float) -> np.ndarray:
    return place + np.array([dx, 0.0, dz])


def test_pins_on_two_objects_are_clicked_and_dragged(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, OF_FRONT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    assert active().name == "Cage", window.reports()
    assert [pin.object.name for pin in active().planar.pins] == ["Back", "Front", "Back"], window.reports()
    before, start = points(), place(2)
    yield from window.drag(window.pixel(start), window.pixel(beside(start, 0.3, 0.8)))
    assert selected() == [2]
    assert np.allclose(place(2), beside(start, 0.3, 0.8), atol=0.05), place(2)
    assert np.allclose(place(0), LEFT, atol=0.05)
    assert not np.array_equal(points(), before)
    assert np.array_equal(points()[:, 2], before[:, 2]), "the depth is kept to the bit"
    window.picture("lattice_posing")
    yield from window.undo()
    assert np.array_equal(points(), before), "one drag is one step"
    yield from window.redo()
    assert not np.array_equal(points(), before)
    yield from window.drag(window.pixel(place(1)), window.pixel(beside(place(1), 0.0, 0.3)))
    assert np.allclose(place(0), LEFT, atol=0.05)


def test_the_view_follows_while_the_button_is_held(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    above = window.pixel((1.7, 0.0, 1.15))  # of the sheet's corner
    empty = np.mean(window.colours(above, 3))
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    yield from window.move(window.pixel(beside(np.array(RIGHT), 0.0, 0.6)), steps=6)
    yield from window.settled()
    yield from window.wait(0.5)
    assert np.mean(window.colours(above, 3)) > empty + 50, "the sheet is drawn there"
    yield from window.key("ESC")
    yield from window.release()
    yield from window.wait(0.5)
    assert abs(np.mean(window.colours(above, 3)) - empty) < 5


def test_escape_restores_every_bit(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    yield from window.drag(window.pixel(RIGHT), window.pixel((1.6, 0.0, 0.5)))
    before, pins = points(), pin_data()
    for way_out in ("ESC", "RIGHTMOUSE"):
        yield from window.hover(window.pixel(place(0)))
        yield from window.press()
        yield from window.move(window.pixel((-1.0, 0.0, 0.9)), steps=6)
        yield from window.wait(0.2)
        assert not np.array_equal(points(), before)
        yield from window.key(way_out)
        yield from window.release()
        assert np.array_equal(points(), before)
        assert pin_data() == pins


def test_a_point_of_the_lattice_in_turn_with_a_pin(window: Window) -> Iterator[None]:
    yield from ready(window)
    yield from window.click(window.pixel(LEFT), ctrl=True)
    corner = grid_point(67)
    yield from window.click(window.pixel(corner), ctrl=True)
    assert [pin.lattice_point for pin in active().planar.pins] == [-1, 67], window.reports()
    yield from window.drag(window.pixel(corner), window.pixel(beside(corner, 0.4, 0.3)))
    assert np.allclose(grid_point(67), beside(corner, 0.4, 0.3), atol=0.05), grid_point(67)
    held = grid_point(67)
    yield from window.drag(window.pixel(place(0)), window.pixel(beside(place(0), -0.3, 0.4)))
    assert np.allclose(grid_point(67), held, atol=0.05)
    yield from window.key("X")
    assert [pin.lattice_point for pin in active().planar.pins] == [67]


def test_a_point_of_the_lattice_looks_different_from_a_pin_on_a_mesh(window: Window) -> Iterator[None]:
    yield from ready(window)
    yield from window.click(window.pixel(LEFT), ctrl=True)
    yield from window.click(window.pixel(grid_point(67)), ctrl=True)
    yield from window.hover(window.pixel((0.0, 0.0, 1.5)))
    selected_colour = np.rint(255 * np.array(addon("preferences").DEFAULT.selected[:3]))

    def width(pin: int, rows: int) -> int:
        """How wide a pin is in its colour so many rows above its middle, in pixels."""
        x, y = window.pixel(place(pin))
        row = window.colours((x, y + rows))[12 * 25 : 13 * 25]  # of 25 x 25 about that place
        has = np.flatnonzero(np.abs(np.array(row) - selected_colour).max(axis=1) < 40)
        return int(np.ptp(has)) + 1 if len(has) else 0

    bpy.ops.planar.select_pins(action="ALL")
    active().select_set(False)  # its lines have the same colour
    yield from window.wait(0.5)
    window.picture("lattice_pins")
    disc, diamond = (width(pin, 0) - width(pin, 4) for pin in (0, 1))
    assert diamond >= disc + 2, "it narrows evenly to its corners"


def test_keys_typed_numbers_and_the_redo_panel(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    start = place(1)
    yield from window.hover(window.pixel((0.5, 0.0, 0.0)))
    yield from window.key("G")
    yield from window.key("Z")
    yield from window.type("0.5")
    yield from window.confirm()
    assert np.allclose(place(1), beside(start, 0.0, 0.5), atol=0.03), place(1)
    with window.context():
        assert bpy.ops.ed.undo_redo.poll()
        typed = bpy.context.window_manager.operators[-1]
        typed.offset = (0.0, -0.5)
        bpy.ops.ed.undo_redo()
    yield from window.wait(0.2)
    assert np.allclose(place(1), beside(start, 0.0, -0.5), atol=0.03), place(1)
    yield from window.key("A")
    assert selected() == [0, 1]
    yield from window.key("R")
    yield from window.type("30")
    yield from window.confirm()
    turned = place(1) - place(0)
    assert np.degrees(np.arctan2(turned[2], turned[0])) > 10.0
    yield from window.key("B")
    yield from window.hover(window.pixel(beside(place(1), -0.3, 0.3)))
    yield from window.press(shift=True)
    yield from window.move(window.pixel(beside(place(1), 0.3, -0.3)), steps=4, shift=True)
    yield from window.release(shift=True)
    assert selected() == [0]


def test_in_space_a_pin_moves_across_the_view_at_its_own_depth(window: Window) -> Iterator[None]:
    yield from ready(window, (7, 6, 4))
    window.view.view_perspective = "PERSP"
    window.view.view_rotation = Euler((1.2, 0.0, 0.4)).to_quaternion()
    yield from window.wait(0.2)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    assert len(active().planar.pins) == 2, window.reports()
    start, facing = place(1), np.array(window.view.view_matrix.row[2][:3])
    end = (window.pixel(start)[0] + 40, window.pixel(start)[1] + 60)
    yield from window.drag(window.pixel(start), end)
    assert np.abs(np.subtract(window.pixel(place(1)), end)).max() <= 4
    assert abs((place(1) - start) @ facing) < 0.03, "its depth is its own"
    before, pins = points(), pin_data()
    yield from window.hover(window.pixel(place(0)))
    yield from window.press()
    yield from window.move((window.mouse[0] - 60, window.mouse[1] + 50), steps=6)
    yield from window.wait(0.2)
    assert not np.array_equal(points(), before)
    yield from window.key("ESC")
    yield from window.release()
    assert np.array_equal(points(), before)
    assert pin_data() == pins
    yield from window.undo()
    assert np.allclose(place(1), start, atol=1e-4)
    yield from window.redo()
    assert np.array_equal(points(), before)


def test_a_solid_thing_is_bent_in_the_plane_of_a_perspective_camera(window: Window) -> Iterator[None]:
    thing = sheet("Thing", columns=24, rows=12, cell=0.15)
    coordinates = shape(thing).copy()
    coordinates[:, 1] = 0.8 * np.sin(1.7 * coordinates[:, 0])
    thing.data.vertices.foreach_set("co", coordinates.ravel())
    thing.data.update()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (2.0, -8.0, 3.0), (1.25, 0.0, 0.25)
    bpy.context.scene.camera = camera
    data = bpy.data.lattices.new("Cage")
    cage = bpy.data.objects.new("Cage", data)
    data.points_u, data.points_v, data.points_w = 12, 10, 1
    cage.rotation_euler, cage.scale = camera.rotation_euler, (5.5, 4.0, 1.0)
    bpy.context.collection.objects.link(cage)
    thing.modifiers.new("Lattice", "LATTICE").object = cage
    activate(cage)
    bpy.ops.ed.undo_push(message="Test Scene")
    window.view.view_perspective = "CAMERA"
    yield from window.use_tool()
    near = thing.matrix_world @ thing.data.vertices[6 * 25 + 6].co
    far = thing.matrix_world @ thing.data.vertices[6 * 25 + 18].co
    for spot in (near, far):
        yield from window.click(window.pixel(spot), ctrl=True)
    assert len(active().planar.pins) == 2, window.reports()
    depth = cage.matrix_world.inverted()
    deep = [(depth @ thing.matrix_world @ vertex.co).z for vertex in thing.data.vertices]
    for index, (dx, dy) in enumerate(((-20, 70), (30, -60))):
        x, y = window.pixel(place(index))
        yield from window.drag((x, y), (x + dx, y + dy))
        assert np.abs(np.subtract(window.pixel(place(index)), (x + dx, y + dy))).max() <= 5, index
    window.picture("lattice_camera")
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    moved = [(depth @ thing.matrix_world @ vertex.co).z for vertex in shown.vertices]
    assert np.abs(np.subtract(moved, deep)).max() <= 1e-6, "nothing is moved in depth"


def test_saved_and_loaded(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, OF_FRONT):
        yield from window.click(window.pixel(spot), ctrl=True)
    start = place(1)
    yield from window.drag(window.pixel(start), window.pixel(beside(start, 0.0, 0.3)))
    held, file = place(1), str(Path(tempfile.mkdtemp()) / "cage.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file)
    yield from window.wait(0.3)
    yield from window.look("FRONT")
    yield from window.use_tool()
    assert np.allclose(place(1), held, atol=1e-4)
    yield from window.drag(window.pixel(place(0)), window.pixel(beside(place(0), -0.2, 0.2)))
    assert np.allclose(place(1), held, atol=0.05)


def test_the_sidebar_of_a_lattice_and_its_pins(window: Window) -> Iterator[None]:
    yield from ready(window)
    yield from window.sidebar()
    window.picture("lattice_hint")
    yield from window.click(window.pixel(LEFT), ctrl=True)
    yield from window.click(window.pixel(grid_point(67)), ctrl=True)
    active().planar.pins[0].enabled = False
    active().planar.show_quality = "AREA"
    yield from window.wait(0.3)
    window.picture("lattice_panel")
    yield from window.push("planar.reset_to_rest")
    yield from window.click(window.pixel(LEFT))
    yield from window.key("H", alt=True)
    assert active().planar.pins[0].enabled, window.reports()
    yield from window.click(window.pixel(OF_FRONT))
    assert active().name == "Cage", "a click on what the lattice deforms does not leave the lattice"
    assert selected() == []
    yield from window.click(window.pixel(LEFT), "RIGHTMOUSE")
    yield from window.wait(0.3)
    window.picture("lattice_menu")
    yield from window.key("ESC")
    assert "Traceback" not in window.reports()


def test_a_patch_of_one_object_by_its_ring(window: Window) -> Iterator[None]:
    yield from ready(window)
    yield from window.click(window.pixel(OF_FRONT), ctrl=True)
    with window.context():
        bpy.ops.planar.set_pin_radius(radius=0.3)
    yield from window.wait(0.2)
    assert active().planar.pins[0].kind == "PATCH"
    assert not bpy.data.objects["Back"].vertex_groups
    yield from window.click(window.pixel(LEFT), ctrl=True)
    yield from window.click(window.pixel(place(0)))
    x, y = window.pixel(place(0))
    yield from window.drag((x + 36, y), (x, y + 36))  # the ring, a quarter of a turn
    assert 50 < np.degrees(active().planar.pins[0].angle) < 120
    window.picture("lattice_ring")


def test_a_model_is_fitted_from_the_view_bent_and_all_of_it_undone(window: Window) -> Iterator[None]:
    bpy.ops.mesh.primitive_monkey_add()
    monkey = active()
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look("FRONT", 6.0)
    yield from window.use_tool()
    before = shown(monkey)
    with window.context():
        assert bpy.ops.planar.fit_lattice("INVOKE_DEFAULT", True, space="VIEW") == {"FINISHED"}
    yield from window.wait(0.2)
    assert active().type == "LATTICE"
    assert np.allclose(shown(monkey), before, atol=1e-6)
    facing = [face.center.copy() for face in monkey.data.polygons if face.normal.y < -0.3]
    near = {
        name: min(facing, key=lambda place, x=x, z=z: np.hypot(place.x - x, place.z - z))
        for name, (x, z) in {"ear": (1.1, 0.25), "chin": (0.0, -0.8)}.items()
    }
    for spot in (near["chin"], near["ear"]):
        yield from window.click(window.pixel(spot), ctrl=True)
    pinned = [pin.object for pin in active().planar.pins if pin.lattice_point < 0]
    assert pinned == [monkey, monkey], window.reports()
    start = place(1)
    yield from window.drag(window.pixel(start), window.pixel(beside(start, -0.2, 0.7)))
    assert np.allclose(place(1), beside(start, -0.2, 0.7), atol=0.06), place(1)
    bent = shown(monkey)
    assert np.abs(bent - before).max() > 0.4
    assert np.abs((bent - before)[:, 1]).max() < 1e-6, "across the view nothing moves in depth"
    window.picture("lattice_model")
    for _ in range(4):  # the drag, two pins, the lattice
        yield from window.undo()
    assert not any(obj.type == "LATTICE" for obj in bpy.data.objects)
    assert not bpy.data.objects["Suzanne"].modifiers
    assert np.allclose(shown(bpy.data.objects["Suzanne"]), before, atol=1e-6)
