# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in lattices to pose by pins, and what Blender shows of them."""

import bpy
import numpy as np
from mathutils import Euler, Matrix
from support import activate, coordinates, evaluated, grid, make_object, world

from planar_deform.scene.view import snapshot

TURNED = Matrix.LocRotScale((0.3, 1.0, 2.0), Euler((np.pi / 2, 0.0, 0.2)), (0.7, 0.7, 0.7))  # as imported


def lattice(counts, size, location, name="Lattice", matrix=None):
    """A lattice over a box of this size, `size` and `location` in the space of `matrix`."""
    data = bpy.data.lattices.new(name)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    data.points_u, data.points_v, data.points_w = counts  # spaced by 1 where it has no object yet
    obj.matrix_world = (matrix or Matrix()) @ Matrix.LocRotScale(location, None, size)
    return obj


def deform(obj, by):
    modifier = obj.modifiers.new("Lattice", "LATTICE")
    modifier.object = by
    return modifier


def layered(matrix=TURNED):
    """Two layers, 2 x 1 and smaller, in a flat lattice with a free cell about them, which is active."""
    back = make_object(*grid(12, 6), name="Back")
    front = make_object(*grid(6, 6, 1.0, 1.0, origin=(1.0, 0.1), depth=0.25), name="Front")
    # Rest coordinates of a new lattice are from -0.5 to 0.5 of its object's axes.
    cage = lattice((9, 8, 1), (3.6, 2.2, 1.0), (1.0, 0.55, 0.1), matrix=matrix)
    for obj in (back, front):
        obj.matrix_world = matrix.copy()
        deform(obj, cage)
    activate(cage)
    return cage, back, front


def solid(matrix=TURNED):
    """A bent sheet with thickness in a lattice of three dimensions."""
    vertices, faces = grid(10, 5)
    vertices = np.array(vertices)
    vertices[:, 2] = 0.3 * np.sin(2.0 * vertices[:, 0])
    sheet = make_object(vertices, faces, name="Sheet")
    cage = lattice((6, 5, 4), (3.6, 2.6, 3.0), (1.0, 0.5, 0.0), matrix=matrix)
    sheet.matrix_world = matrix.copy()
    deform(sheet, cage)
    activate(cage)
    return cage, sheet


def shown(obj, vertex):
    """Where Blender shows a vertex, in the world."""
    return world(obj, evaluated(obj)[[vertex]])[0]


def pin_at(obj, vertex, **options):
    place = world(obj, coordinates(obj.data.vertices)[[vertex]])[0]
    assert bpy.ops.planar.add_pin(location=place.tolist(), **options) == {"FINISHED"}


def points(cage):
    return coordinates(cage.data.points, "co_deform")


def seen():
    snapshot.forget()
    return snapshot.of_active(bpy.context)


def moved_by(cage, x, y):
    """World offset of (x, y) along the lattice's own u and v."""
    matrix = np.array(cage.matrix_world)[:3, :3]
    axes = matrix / np.linalg.norm(matrix, axis=0)
    return axes[:, 0] * x + axes[:, 1] * y
