# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts for the window tests, and what is asked about them."""

from collections.abc import Iterator, Sequence

import bpy
import numpy as np
from harness import Window
from mathutils import Matrix


def sheet(
    name: str = "Sheet",
    *,
    columns: int = 16,
    rows: int = 8,
    cell: float = 0.25,
    at: Sequence[float] = (0, 0, 0),
) -> bpy.types.Object:
    """A rectangle of quads in the XZ plane, centred on `at`, made active."""
    x = (np.arange(columns + 1) - columns / 2) * cell
    z = (np.arange(rows + 1) - rows / 2) * cell
    vertices = [(a, 0.0, b) for b in z for a in x]
    corner = [row * (columns + 1) + column for row in range(rows) for column in range(columns)]
    faces = [(i, i + 1, i + columns + 2, i + columns + 1) for i in corner]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    obj.location = at
    bpy.context.collection.objects.link(obj)
    activate(obj)
    return obj


def imported(name: str = "Imported", *, scale: float = 2.0) -> bpy.types.Object:
    """A sheet as importers leave it: drawn in its own XY plane, scaled, turned to stand upright."""
    obj = sheet(name, cell=0.25 / scale)
    obj.data.transform(Matrix.Rotation(-np.pi / 2, 4, "X"))
    obj.rotation_euler, obj.scale = (np.pi / 2, 0.0, 0.0), (scale, scale, scale)
    bpy.context.view_layer.update()
    return obj


def activate(obj: bpy.types.Object) -> None:
    bpy.context.view_layer.update()  # it knows a new object from then on
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def pin(*places: Sequence[float]) -> None:
    """Point pins on the active object at world places; none is selected."""
    for place in places:
        bpy.ops.planar.add_pin(location=place)
    bpy.ops.planar.select_pins(action="NONE")


def carrying(window: Window, carried: bpy.types.Object) -> Iterator[None]:
    """A sheet with a pin at each end that carries an object, seen by the Pose tool, in its own undo step."""
    obj = sheet(columns=16, rows=2)
    pin((-1.5, 0.0, 0.0), (1.5, 0.0, 0.0))
    carried.select_set(True)
    yield from window.look("FRONT")
    with window.context():
        assert bpy.ops.planar.attach_to() == {"FINISHED"}
    activate(obj)
    yield from window.use_tool()
    bpy.ops.ed.undo_push(message="Test Scene")


def ready(window: Window, *places: Sequence[float], direction: str = "FRONT") -> Iterator[None]:
    """A sheet with pins there, seen by the Pose tool, in an undo step of its own."""
    sheet()
    pin(*places)
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.look(direction)
    yield from window.use_tool()


def active() -> bpy.types.Object:
    obj = bpy.context.view_layer.objects.active
    assert obj is not None, "there is no active object"
    return obj


def shape(obj: bpy.types.Object | None = None) -> np.ndarray:
    """The mesh's coordinates to the bit, n x 3 float32."""
    mesh = (obj or active()).data
    coordinates = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)


def selected() -> list[int]:
    return [index for index, item in enumerate(active().planar.pins) if item.select]


def pin_data(obj: bpy.types.Object | None = None) -> list[tuple]:
    """Everything the .blend says about the pins of an object, the active one unless told."""
    names = ("name", "group", "kind", "enabled", "weight", "select", "angle", "has_target")
    return [
        tuple(getattr(item, name) for name in names) + tuple(item.target) + tuple(item.reached)
        for item in (obj or active()).planar.pins
    ]


def place(index: int) -> np.ndarray:
    """Where a point pin is in the world: the weighted mean of its vertices."""
    obj = active()
    group = obj.vertex_groups[obj.planar.pins[index].group].index
    total, weights = np.zeros(3), 0.0
    for vertex in obj.data.vertices:
        for element in vertex.groups:
            if element.group == group:
                total += element.weight * np.array(obj.matrix_world @ vertex.co)
                weights += element.weight
    return total / weights


def moved(before: np.ndarray, after: np.ndarray) -> float:
    """The furthest that any vertex went."""
    return float(np.abs(after - before).max())
