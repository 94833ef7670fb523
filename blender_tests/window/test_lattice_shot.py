# SPDX-License-Identifier: GPL-3.0-or-later
"""A shot with a lattice by hand: an imported character of three objects, from its pins to its last key."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import activate, active, selected
from harness import Window, addon

PARTS = {"Body": (16, 24, 160, 240, 160, 180, 0), "Arm": (16, 5, 160, 50, 290, 350, 4)} | {
    "Head": (10, 10, 110, 110, 185, 420, -4)
}
HIP, HAND, CROWN = (2.0, 0.0, 2.0), (4.4, -0.04, 3.75), (2.4, 0.04, 5.2)


def import_character() -> None:
    """Three objects of one OBJ file in pixels, which the importer turns by 90° and scales by 0.01."""
    lines, first = [], 1
    for name, (columns, rows, width, height, left, bottom, depth) in PARTS.items():
        lines.append(f"o {name}")
        for row in range(rows + 1):
            for column in range(columns + 1):
                x, y = left + width * column / columns, bottom + height * row / rows
                lines.append(f"v {x} {y} {depth}")
        for row in range(rows):
            for column in range(columns):
                corner = first + row * (columns + 1) + column
                lines.append(f"f {corner} {corner + 1} {corner + columns + 2} {corner + columns + 1}")
        first += (columns + 1) * (rows + 1)
    path = Path(tempfile.mkdtemp()) / "character.obj"
    path.write_text("\n".join(lines) + "\n")
    bpy.ops.wm.obj_import(filepath=str(path), global_scale=0.01)


def ready(window: Window) -> Iterator[None]:
    import_character()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 9.0
    camera.location, camera.rotation_euler = (2.8, -10.0, 3.4), (np.pi / 2, 0.0, 0.0)
    bpy.context.scene.camera = camera
    activate(bpy.data.objects["Body"])
    for name in PARTS:
        bpy.data.objects[name].select_set(True)
    bpy.ops.ed.undo_push(message="Imported")
    yield from window.look("FRONT", 12.0)
    window.view.view_location = (2.8, 0.0, 3.4)
    yield from window.wait(0.2)
    with window.context():
        bpy.ops.planar.fit_lattice()
    yield from window.use_tool()


def points(obj: bpy.types.Object | None = None) -> np.ndarray:
    data = (obj or active()).data
    found = np.empty(len(data.points) * 3, np.float32)
    data.points.foreach_get("co_deform", found)
    return found


def place(pin: int) -> np.ndarray:
    mark = addon("scene.view.snapshot").of_active(bpy.context).pin(pin)
    assert mark is not None, f"pin {pin} is nowhere"
    return mark.place


def shown(name: str) -> np.ndarray:
    obj = bpy.data.objects[name]
    vertices = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    return np.array([obj.matrix_world @ vertex.co for vertex in vertices])


def check_solved() -> None:
    """What the tool has solved is what Blender shows."""
    drawing, positions = addon("scene.view.snapshot").of_active(bpy.context).shape
    solved = drawing.to_world(positions)
    row = 0
    for obj in drawing.meshes:
        places = shown(obj.name)
        assert np.abs(solved[row : row + len(places)] - places).max() < 1e-5, obj.name
        row += len(places)


def drag(window: Window, pin: int, dx: float, dz: float) -> Iterator[None]:
    start = place(pin)
    goal = start + np.array((dx, 0.0, dz))
    yield from window.drag(window.pixel(start), window.pixel(goal))
    assert np.abs(np.subtract(window.pixel(place(pin)), window.pixel(goal))).max() <= 4, (
        pin,
        place(pin),
        goal,
    )
    check_solved()


def to_frame(window: Window, frame: int) -> Iterator[None]:
    """By hand, an undo step of its own."""
    with window.context():
        bpy.ops.screen.frame_offset(delta=frame - bpy.context.scene.frame_current)
    yield from window.wait(0.2)


def pinned(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (HIP, HAND, CROWN):
        yield from window.click(window.pixel(spot), ctrl=True)
    corner = active().matrix_world @ active().data.points[13 * 14].co_deform
    yield from window.click(window.pixel(corner), ctrl=True)
    assert [pin.lattice_point for pin in active().planar.pins] == [-1, -1, -1, 13 * 14], window.reports()
    names = [pin.object and pin.object.name for pin in active().planar.pins]
    assert names == ["Body", "Arm", "Head", None]


def test_keys_in_turn_and_undo_across_frames(window: Window) -> Iterator[None]:
    yield from pinned(window)
    states = [(bpy.context.scene.frame_current, points())]
    yield from drag(window, 1, 0.0, 0.8)
    yield from drag(window, 3, -0.1, 0.15)
    yield from window.hover(window.pixel((2.8, 0.0, 1.0)))
    yield from window.key("I")
    first = points(), shown("Arm")
    yield from to_frame(window, 13)
    yield from drag(window, 1, -0.2, -1.2)
    yield from window.hover(window.pixel((2.8, 0.0, 1.0)))
    yield from window.key("I")
    keyed = shown("Arm")
    assert [pose.frame for pose in active().planar.poses] == [1, 13], window.reports()
    bpy.context.scene.frame_set(1)
    assert np.abs(shown("Arm") - first[1]).max() < 1e-5
    bpy.context.scene.frame_set(13)
    yield from window.wait(0.2)
    yield from window.undo()  # the key
    yield from window.undo()  # the drag
    assert len(active().planar.poses) == 1
    for _ in range(3):  # the key and both drags of frame 1
        yield from window.undo()
    yield from window.wait(0.3)
    assert np.array_equal(points(), states[0][1]), "everything is as it was before the first drag"
    for _ in range(6):
        yield from window.redo()
    yield from window.wait(0.3)
    bpy.context.scene.frame_set(13)
    yield from window.wait(0.2)
    assert np.abs(shown("Arm") - keyed).max() < 1e-5
    check_solved()
    yield from drag(window, 0, 0.1, 0.1)


def test_duplicates_joins_transforms_and_deleted_meshes(window: Window) -> Iterator[None]:
    yield from pinned(window)
    yield from drag(window, 1, 0.0, 0.6)
    cage, before = active(), points()
    for name in PARTS:
        bpy.data.objects[name].select_set(True)
    yield from window.hover(window.pixel((2.8, 0.0, 1.0)))
    yield from window.key("D", shift=True)
    yield from window.key("X")
    yield from window.type("5")
    yield from window.confirm()
    twin = active()
    assert twin != cage, window.reports()
    assert {pin.object.name for pin in twin.planar.pins if pin.object} == {"Body.001", "Arm.001", "Head.001"}
    window.view.view_location = (7.8, 0.0, 3.4)
    yield from window.wait(0.3)
    yield from drag(window, 2, 0.3, 0.2)
    assert np.array_equal(points(cage), before), "the first one stays"
    window.view.view_location = (2.8, 0.0, 3.4)
    activate(bpy.data.objects["Body"])
    bpy.data.objects["Head"].select_set(True)
    bpy.ops.ed.undo_push(message="Selected")
    yield from window.wait(0.3)
    yield from window.hover(window.pixel((2.8, 0.0, 1.0)))
    yield from window.key("J", ctrl=True)
    assert "Head" not in bpy.data.objects or not bpy.data.objects["Head"].users_scene, window.reports()
    activate(cage)
    yield from window.wait(0.3)
    assert [pin.object and pin.object.name for pin in active().planar.pins] == ["Body", "Arm", "Body", None]
    check_solved()
    yield from drag(window, 2, 0.2, 0.1)
    places = [place(pin) for pin in range(4)]
    activate(bpy.data.objects["Body"])
    bpy.data.objects["Arm"].select_set(True)
    with window.context():
        bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    activate(cage)
    yield from window.wait(0.3)
    for pin, where in enumerate(places):
        assert np.abs(place(pin) - where).max() < 1e-5
    yield from drag(window, 1, -0.1, 0.2)
    yield from window.click(window.pixel(place(0)))
    yield from window.key("X")
    assert len(active().planar.pins) == 3
    assert selected() == []
    activate(bpy.data.objects["Arm"])
    with window.context():
        bpy.ops.object.delete()
    activate(cage)
    yield from window.wait(0.3)
    check_solved()
    assert [pin.object and pin.object.name for pin in active().planar.pins] == [None, "Body", None]
    yield from drag(window, 1, 0.1, -0.2)
    file = str(Path(tempfile.mkdtemp()) / "shot.blend")
    kept = place(1)
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file)
    yield from window.wait(0.3)
    yield from window.look("FRONT", 12.0)
    window.view.view_location = (2.8, 0.0, 3.4)
    yield from window.use_tool()
    assert np.abs(place(1) - kept).max() < 1e-5
    yield from drag(window, 1, -0.1, 0.1)


def test_a_subdivided_mesh_keeps_its_pins_through_undo_and_redo(window: Window) -> Iterator[None]:
    yield from pinned(window)
    yield from drag(window, 1, 0.0, 0.4)
    before = [place(pin) for pin in range(4)]
    arm, kept = bpy.data.objects["Arm"], points()
    count = len(arm.data.vertices)
    activate(arm)
    bpy.ops.ed.undo_push(message="Selected")
    yield from window.wait(0.2)
    yield from window.hover(window.pixel((2.8, 0.0, 1.0)))
    yield from window.key("TAB")
    yield from window.key("A")
    with window.context():
        bpy.ops.mesh.subdivide()
    yield from window.key("TAB")
    yield from window.wait(0.3)

    def check(vertices: int) -> Iterator[None]:
        assert len(bpy.data.objects["Arm"].data.vertices) == vertices
        activate(bpy.data.objects["Lattice"])
        yield from window.wait(0.3)
        for pin, where in enumerate(before):
            assert np.abs(place(pin) - where).max() < 2e-3, pin
        assert np.array_equal(points(), kept)
        check_solved()

    finer = len(bpy.data.objects["Arm"].data.vertices)
    assert finer > 3 * count
    yield from check(finer)
    for _ in range(4):  # leaving Edit Mode, the cut, the selection, entering it
        yield from window.undo()
        yield from window.wait(0.2)
    yield from check(count)
    for _ in range(4):
        yield from window.redo()
        yield from window.wait(0.2)
    yield from check(finer)
    yield from drag(window, 1, 0.1, 0.1)
