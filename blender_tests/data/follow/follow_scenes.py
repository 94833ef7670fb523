# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings as imported, whose pins follow Empties, and short ways to move these."""

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector
from support import activate, add_pins, bar, evaluated, world

LEFT = list(range(0, 65, 13))
HAND = [11, 12, 24, 25, 37, 38, 50, 51, 63, 64]
TIP = [38]  # the middle of the right end


def imported(*, parented=False, nx=12, ny=4):
    """A bar of 1.2 x 0.6 that stands upright, as an image plane does; parented to something turned."""
    obj = bar(nx=nx, ny=ny)
    obj.rotation_euler = (np.pi / 2, 0.0, 0.0)
    obj.scale = (0.6, 0.6, 0.6)
    obj.location = (0.3, -1.0, 2.0)
    if parented:
        holder = empty((1.0, 2.0, -0.5), "Holder")
        holder.rotation_euler, holder.scale = (0.3, 0.2, 0.5), (1.5, 1.5, 1.5)
        obj.parent = holder
    activate(obj)
    return obj


def empty(place, name="Control"):
    control = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(control)
    control.location = place
    bpy.context.view_layer.update()
    return control


def held(obj, vertices):
    """Where Blender shows the middle of these vertices, in the world."""
    return world(obj, evaluated(obj)[vertices]).mean(axis=0)


def axes(obj):
    """The drawing's u, v and normal in the world."""
    matrix = np.array(obj.matrix_world, float)[:3, :3]
    return (matrix / np.linalg.norm(matrix, axis=0)).T


def angle(obj, first=37, second=38):
    """Degrees by which an edge of the hand is turned in the drawing's plane."""
    u, v, _ = axes(obj)
    arm = np.diff(world(obj, evaluated(obj)[[first, second]]), axis=0)[0]
    return float(np.degrees(np.arctan2(arm @ v, arm @ u)))


def moved(control, offset):
    """A control moved in the world."""
    control.matrix_world = Matrix.Translation(Vector(offset)) @ control.matrix_world
    bpy.context.view_layer.update()


def turned(control, axis, degrees):
    """A control turned about itself."""
    place = Matrix.Translation(control.matrix_world.translation)
    turn = Quaternion(Vector(axis), np.radians(degrees)).to_matrix().to_4x4()
    control.matrix_world = place @ turn @ place.inverted() @ control.matrix_world
    bpy.context.view_layer.update()


def with_control(*, kind="POINT", vertices=HAND, live=False, offset=(0.4, -0.3, 0.2), **options):
    """A drawing held at the left, whose right pin follows an Empty that stands, turned, beside it."""
    obj = imported(**options)
    add_pins(obj, LEFT, vertices, kind=kind)
    control = empty(held(obj, vertices) + np.array(offset))
    control.rotation_euler = (0.4, 0.1, -0.7)
    bpy.context.view_layer.update()
    obj.planar.pins[1].follow = control
    activate(obj)
    obj.planar.live = live
    return obj, control


def swinging(control, frames=(1, 9, 17), offsets=((0, 0, 0), (0.1, 0.0, 0.35), (-0.15, 0.0, -0.2))):
    """A control keyed to and fro about where it stands."""
    start = control.location.copy()
    for frame, offset in zip(frames, offsets, strict=True):
        control.location = start + Vector(offset)
        control.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(frames[0])


def film(obj, frames):
    """What Blender shows at frames, in this order."""
    shapes = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        shapes[frame] = evaluated(obj)
    return shapes


def keyed(obj, *poses):
    """Poses at frames, by a drag of the pin at the right from where it is at rest."""
    for frame, offset in poses:
        bpy.context.scene.frame_set(frame)
        bpy.ops.planar.reset_to_rest()
        bpy.ops.planar.drag_pins(pin=1, offset=offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}


def in_poses(*, live=False):
    """A drawing with poses at 1, 9 and 17, whose hand they lead, and whose tip follows an Empty."""
    obj = imported()
    add_pins(obj, [26], [64], [12])
    keyed(obj, (1, (0.0, 0.0)), (9, (-0.2, 0.4)), (17, (-0.2, -0.1)))
    control = empty(held(obj, [12]) + np.array((0.0, -0.5, 0.0)))
    obj.planar.pins[2].follow = control
    swinging(control, offsets=((0, 0, 0), (-0.1, 0, 0.3), (0.1, 0, 0.1)))
    activate(obj)
    obj.planar.live = live
    return obj, control
