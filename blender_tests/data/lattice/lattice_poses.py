# SPDX-License-Identifier: GPL-3.0-or-later
"""Short ways to pose, key and read lattices over time."""

import bpy
import numpy as np
from lattice_scenes import TURNED, deform, lattice
from sequences import curve_of, go_to
from support import TRANSFORMS, activate, coordinates, evaluated, grid, make_object, world


def bend(cage, amount, turn=0.0):
    """Show the lattice bent and turned in its plane."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(cage)
    drawing = begin_shape(bpy.context)
    rotation = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    drawing.write(bent(drawing.rest, amount) @ np.array(rotation))


def bent(rest, amount):
    """n x 2 positions of a bar bent about its middle by an angle that grows to `amount` from end to end."""
    middle, width = rest.mean(axis=0), np.ptp(rest[:, 0])
    along, across = (rest - middle).T
    angle = amount * along / width
    radius = width / amount
    return middle + np.stack(
        [(radius - across) * np.sin(angle), radius - (radius - across) * np.cos(angle)], axis=1
    )


def shown(*objects):
    return [evaluated(obj) for obj in objects]


def keyed(cage, objects, amounts):
    """Poses bent, or bent and turned, by each amount (by frame), and what the meshes show there."""
    result = {}
    for frame, amount in amounts.items():
        activate(cage)
        go_to(frame)
        bend(cage, *np.atleast_1d(amount))
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
        result[frame] = shown(*objects)
    return result


def shown_at(objects, frame):
    go_to(frame)
    return shown(*objects)


def two_layers(matrix=TURNED):
    """A flat lattice of two equal layers about one drawing."""
    drawing = make_object(*grid(12, 6), name="Drawing")
    cage = lattice((9, 8, 2), (3.6, 2.2, 1.0), (1.0, 0.55, 0.0), matrix=matrix)
    drawing.matrix_world = matrix.copy()
    deform(drawing, cage)
    activate(cage)
    return cage, drawing


def shear(obj):
    """As a parent with unequal scales does it."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    obj.parent, obj.matrix_parent_inverse = parent, TRANSFORMS["sheared"]


def rest_of(cage):
    from planar_deform.scene.objects.any_object import read_shape

    return read_shape(cage).rest


def length(cage):
    from planar_deform.scene.objects.any_object import read_shape

    return length_of(read_shape(cage).positions)


def length_of(positions):
    """From left to right through the middle of the first layer (9 points along u, 8 along v)."""
    row = (positions[27:36] + positions[36:45]) / 2.0
    return np.linalg.norm(np.diff(row, axis=0), axis=1).sum()


def place_of(obj, vertices):
    return world(obj, evaluated(obj)[vertices]).mean(axis=0)


def stored(cage):
    keys = cage.data.shape_keys
    blocks = [(block.name, block.frame, coordinates(block.data).tobytes()) for block in keys.key_blocks]
    return blocks, [tuple(point.co) for point in curve_of(cage).keyframe_points], keys.eval_time
