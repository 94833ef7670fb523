# SPDX-License-Identifier: GPL-3.0-or-later
"""A character of several objects, and what tests compare of it."""

import bpy
import numpy as np
from support import activate, add_pins, bar, coordinates, evaluated


def limb(name, x=0.0, *, plane="XZ", nx=8):
    """A bar of 2 x 1 with the pins Root, at its left end, and Tip, at its right end."""
    obj = bar(plane=plane, nx=nx, name=name)
    obj.location.x = x
    add_pins(obj, range(0, len(obj.data.vertices), nx + 1), range(nx, len(obj.data.vertices), nx + 1))
    obj.planar.pins[0].name, obj.planar.pins[1].name = "Root", "Tip"
    return obj


def figure():
    """Three limbs side by side, all selected, Body the active one; each has its Tip selected."""
    objects = [limb("Body"), limb("Arm.L", 3.0), limb("Arm.R", -3.0)]
    return choose(*objects)


def choose(*objects):
    """Select these, the first of them active."""
    activate(objects[0])
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.update()
    return list(objects)


def select(*names, objects=None):
    """Select the pins of these names, of all objects unless told."""
    for obj in objects or bpy.context.selected_objects:
        for pin in obj.planar.pins:
            pin.select = pin.name in names


def named(*names):
    return [bpy.data.objects[name] for name in names]


def state(obj):
    """All of an object that posing and keying may change, to the bit."""
    settings, keys = obj.planar, obj.data.shape_keys
    pins = [
        (
            *(pin.name, pin.group, pin.select, pin.enabled, pin.kind, pin.has_target),
            *(tuple(pin.target), tuple(pin.reached), pin.angle, pin.scale),
        )
        for pin in settings.pins
    ]
    poses = [(pose.name, pose.at, pose.generated, pose.stamp, pose.edited) for pose in settings.poses]
    blocks, curves = [], []
    if keys is not None:
        shapes = [(block.name, block.frame, coordinates(block.data).tobytes()) for block in keys.key_blocks]
        blocks = [keys.use_relative, keys.eval_time, obj.active_shape_key_index, *shapes]
        curves = keyed(obj)
    shape = coordinates(obj.data.vertices).tobytes()
    counts = settings.active_pin, settings.active_pose, settings.curve_before, settings.solved_stiffness
    return shape, evaluated(obj).tobytes(), pins, poses, blocks, curves, counts


def keyed(obj):
    """The keys of the object's curve: frame, value and handles."""
    from planar_deform import compat

    animation = None if obj.data.shape_keys is None else obj.data.shape_keys.animation_data
    curves = [] if animation is None else compat.curves_of(animation) or []
    return [
        (tuple(key.co), tuple(key.handle_left), tuple(key.handle_right), key.interpolation, key.type)
        for curve in curves
        for key in curve.keyframe_points
    ]


def frames(obj):
    """The frames at which its poses are first shown."""
    return [pose.frame for pose in obj.planar.poses]


def tip(obj):
    """Where the Tip is in the world: the vertex in the middle of the right end."""
    return _world(obj, evaluated(obj)[len(obj.data.vertices) * 3 // 5 - 1])


def target_of(obj):
    """Where the Tip was asked to be in the world."""
    return _world(obj, obj.planar.pins["Tip"].target)


def _world(obj, place):
    return np.array(obj.matrix_world)[:3, :3] @ np.array(place) + np.array(obj.matrix_world)[:3, 3]


def drag(offset, **options):
    assert bpy.ops.planar.drag_pins(offset=offset, **options) == {"FINISHED"}


def go_to(frame):
    bpy.context.scene.frame_set(frame)


def key(frame, offset):
    go_to(frame)
    drag(offset)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}


def two_poses():
    objects = figure()
    key(1, (0.1, 0.2))
    key(9, (-0.3, 0.6))
    return objects
