# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts to test on, and short ways to read and pose them."""

from functools import partial

import bmesh
import bpy
import numpy as np
from mathutils import Matrix

TRANSFORMS = {
    "none": Matrix(),
    "rotated": Matrix.LocRotScale((3, -2, 5), Matrix.Rotation(1.1, 3, (1, 2, 3)).to_quaternion(), (1, 1, 1)),
    "stretched": Matrix.LocRotScale((1, 0, 0), Matrix.Rotation(0.5, 3, "Z").to_quaternion(), (2.0, 0.5, 3.0)),
    "mirrored": Matrix.Diagonal((-1.0, 1.0, 2.0, 1.0)),
    "tiny": Matrix.Scale(1e-3, 4),
    "huge and far": Matrix.Translation((5e3, -5e3, 1e3)) @ Matrix.Scale(1e3, 4),
    "sheared": Matrix(((1, 0.6, 0, 2), (0, 1, 0.3, 0), (0, 0, 1, 1), (0, 0, 0, 1))),
}
# Rotations that turn the XY plane into the plane named, as local coordinates of the mesh.
PLANES = {
    "XY": np.eye(3),
    "XZ": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float),
    "YZ": np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float),
    "tilted": np.array(Matrix.Rotation(0.7, 3, "X") @ Matrix.Rotation(-0.4, 3, "Y")),
}


def make_object(vertices, faces, edges=(), name="Cutout"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(vertex) for vertex in vertices], list(edges), [tuple(face) for face in faces])
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    activate(obj)
    return obj


def activate(obj):
    bpy.context.view_layer.update()
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()


def from_library(folder, name="Cutout"):
    """This object of the present file, linked from that into an empty one."""
    path = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.link(directory=f"{path}/Object/", filename=name)
    return bpy.data.objects[name]


def grid(nx, ny, width=2.0, height=1.0, *, origin=(0.0, 0.0), depth=0.0):
    """Vertices (k x 3, in XY) and quads of a grid of nx x ny faces; vertex j * (nx + 1) + i."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1) + origin[0], np.linspace(0, height, ny + 1) + origin[1])
    vertices = np.stack([x.ravel(), y.ravel(), np.full(x.size, depth)], axis=1)
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    return vertices, np.stack([first, first + 1, first + nx + 2, first + nx + 1], axis=1)


def bar(*, plane="XY", nx=12, ny=4, triangles=False, name="Cutout"):
    """A bar of 2 x 1 in one of the planes, of quads or triangles."""
    vertices, faces = grid(nx, ny)
    if triangles:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    return make_object(vertices @ PLANES[plane].T, faces.tolist(), name=name)


def coordinates(points, name="co"):
    """The float32 coordinates (k x 3) of vertices, shape key data or, named "vector", an attribute."""
    found = np.empty(len(points) * 3, np.float32)
    points.foreach_get(name, found)
    return found.reshape(-1, 3)


def evaluated(obj):
    """What Blender shows: evaluated coordinates of a mesh's vertices, or of an unfilled curve's points."""
    bpy.context.view_layer.update()
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return coordinates((shown.data if obj.type == "MESH" else shown.to_mesh()).vertices)


def add_pins(obj, *groups, kind="POINT"):
    """A pin on each of these lists of vertices; the last one is selected."""
    from planar_deform.scene.pins import pin_list

    for rows in groups:
        pin_list.add_on_vertices(obj, [int(row) for row in rows], kind)
    for index, pin in enumerate(obj.planar.pins):
        pin.select = index == len(obj.planar.pins) - 1


def add_end_pins(obj, nx=12, count=65, kind="POINT"):
    """Pins on the left and the right column of a grid (of a bar, unless told); the right one is selected."""
    add_pins(obj, range(0, count, nx + 1), range(nx, count, nx + 1), kind=kind)


def pose(obj, offset=(0.0, 0.0), angle=0.0, moving=None):
    """One posing of the selected pins (or those told) through the model, as the operators do it."""
    from planar_deform.model.posing import solver_cache
    from planar_deform.model.posing.posing import Posing
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    activate(obj)
    drawing = begin(bpy.context)
    moving = {i for i, pin in enumerate(obj.planar.pins) if pin.select} if moving is None else set(moving)
    method = obj.planar.method.lower()
    make_poser = partial(
        solver_cache.poser_for, drawing.session_uid, drawing.cutout, method, drawing.positions
    )
    posing = Posing(drawing.cutout, drawing.positions, pin_list.model_pins(obj, drawing), moving, make_poser)
    for step in range(1, 9):
        posing.move(offset[0] * step / 8, offset[1] * step / 8, angle * step / 8)
    drawing.write(posing.settle())
    pin_list.store_results(obj, drawing, posing.results())
    return drawing, posing


def in_edit_mode(obj, *steps, select=lambda vertex: True):
    """Run operators in Edit Mode on the vertices that `select(vertex)` chooses."""
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    mesh = bmesh.from_edit_mesh(obj.data)
    for vertex in mesh.verts:
        vertex.select = bool(select(vertex))
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(obj.data)
    for step in steps:
        assert step() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")


def measured(obj):
    """The distortion that the panel shows for an object."""
    from planar_deform.scene.view import snapshot

    activate(obj)
    snapshot.forget()  # Blender tells of changes later than a test asks
    return snapshot.of_active(bpy.context).distortion


def world(obj, points=None):
    """World coordinates of the mesh's vertices, float64."""
    bpy.context.view_layer.update()
    points = coordinates(obj.data.vertices) if points is None else points
    matrix = np.array(obj.matrix_world, float)
    return points.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
