# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters of several parts, as they come into Blender, to be hung together."""

import bpy
import numpy as np
from support import activate, grid, make_object

# left, bottom, width, height, and how far before the drawing
BODY = (0.0, 0.0, 2.0, 4.0, 0.0)
ARM = (1.4, 3.0, 3.0, 0.4, 0.1)
HAND = (4.1, 2.9, 0.8, 0.6, 0.2)
HEAD = (0.6, 3.6, 0.8, 1.4, -0.1)
EYE = (0.9, 4.4, 0.2, 0.2, 0.3)
FIGURE = (BODY, ARM, HAND, HEAD)
SHOULDER, WRIST, NECK = (1.6, 3.2), (4.25, 3.2), (1.0, 3.8)
SIZE = 0.1  # of the object's scale


def figure(*boxes, cell=0.1, name="Figure", parented=True):
    """A part for each box, turned upright, scaled and parented, as what is imported is."""
    vertices, faces = [], []
    for left, bottom, width, height, depth in boxes or FIGURE:
        count = [max(2, round(side / cell)) for side in (width, height)]
        places, quads = grid(*count, width, height, origin=(left, bottom), depth=depth)
        faces += (quads + sum(map(len, vertices))).tolist()
        vertices.append(places)
    obj = make_object(np.concatenate(vertices), faces, name=name)
    obj.rotation_euler, obj.scale, obj.location = (np.pi / 2, 0.0, 0.0), (SIZE,) * 3, (0.3, -1.0, 2.0)
    if parented:
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        parent.rotation_euler, parent.location = (0.2, 0.1, 0.6), (1.0, 2.0, 3.0)
        obj.parent = parent
    activate(obj)
    return obj


def pin_at(obj, place, name, kind="POINT", radius=0.35):
    """A pin on the vertices nearest to a place of the drawing (of a patch, within a radius)."""
    from planar_deform.scene.pins import pin_list

    points = np.array([vertex.co[:2] for vertex in obj.data.vertices])
    gaps = np.linalg.norm(points - place, axis=1)
    rows = np.flatnonzero(gaps <= radius) if kind == "PATCH" else [int(gaps.argmin())]
    pin = pin_list.add_on_vertices(obj, [int(row) for row in rows], kind)
    pin.name = name
    return pin


def drag(obj, name, offset, angle=0.0):
    """Drag (or turn) one pin by the operators."""
    index = obj.planar.pins.find(name)
    bpy.ops.planar.select_pins(action="SELECT", pin=index)
    if angle:
        assert bpy.ops.planar.rotate_pins(angle=angle) == {"FINISHED"}
    if any(offset):
        assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}


def shown(obj):
    """Positions n x 2 of the shape that is shown, and the drawing."""
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    drawing = begin(bpy.context)
    return drawing.positions, drawing


def gaps(obj):
    """How far the two sides of each joint are apart, of the diagonal, by its name."""
    from planar_deform.scene.pins import joint_list

    positions, drawing = shown(obj)
    found = {}
    for joint in joint_list.bound_joints(obj, drawing):
        one, other = joint.places(positions, drawing.cutout.triangles)
        found[obj.planar.pins[joint.key].name] = np.linalg.norm(one - other) / drawing.cutout.diagonal
    return found


def joint_places(obj):
    """Where the joints are at rest, in the drawing's own lengths, sorted."""
    from planar_deform.scene.pins import joint_list

    _, drawing = shown(obj)
    vertices = np.array([vertex.co[:2] for vertex in obj.data.vertices])[drawing.vertex_indices]
    found = joint_list.bound_joints(obj, drawing)
    places = [joint.place(vertices, drawing.cutout.triangles) for joint in found]
    return np.array(sorted(place.tolist() for place in places))


def pinned(*boxes, **options):
    """A figure, attached, with its chest as a patch."""
    obj = figure(*boxes, **options)
    assert bpy.ops.planar.attach() == {"FINISHED"}
    pin_at(obj, (1.0, 2.0), "Chest", kind="PATCH")
    return obj
