# SPDX-License-Identifier: GPL-3.0-or-later
"""Short ways to pose, key and read an object with a pose sequence."""

import bpy
import numpy as np
from support import activate, add_end_pins, bar, coordinates, evaluated, pose


def go_to(frame):
    bpy.context.scene.frame_set(int(frame // 1), subframe=frame % 1)


def write(obj, seed):
    """A pose of the shown shape with its own bits, and small enough to keep the mesh whole; what it shows."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    drawing = begin_shape(bpy.context)
    noise = np.random.default_rng(seed).uniform(-0.02, 0.02, drawing.positions.shape)
    drawing.write(drawing.positions + noise)
    return evaluated(obj)


def key(obj, frame, seed=None):
    """Pose at a frame (unless there is no seed) and key it; what is shown, count x 3 float32."""
    activate(obj)
    go_to(frame)
    if seed is not None:
        write(obj, seed)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    return evaluated(obj)


def pull(obj, frame, offset):
    """Pull the selected pins at a frame and key that; what is shown."""
    activate(obj)
    go_to(frame)
    pose(obj, offset=offset)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    return evaluated(obj)


def filled(**options):
    """A bar that bends up and down, keyed at 1, 13 and 25, with its in-betweens."""
    obj = bar(**options)
    add_end_pins(obj)
    key(obj, 1)
    pull(obj, 13, (-0.3, 0.7))
    pull(obj, 25, (0.1, -1.6))
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    return obj


def shown_at(obj, frame):
    go_to(frame)
    return evaluated(obj)


def same(a, b):
    """Equal to the bit."""
    return a.tobytes() == b.tobytes()


def curve_of(obj):
    from planar_deform import compat

    return compat.curves_of(obj.data.shape_keys.animation_data).find("eval_time")


def timing(obj):
    """Frame, value and interpolation of each key of the curve."""
    curve = curve_of(obj)
    return [] if curve is None else [(*point.co, point.interpolation) for point in curve.keyframe_points]


def stored(obj):
    """All that is stored of an object's shapes and their timing, as plain values."""
    keys = obj.data.shape_keys
    result = [_own(obj), [(p.name, p.at) for p in obj.planar.poses]]
    if keys is not None:
        result += [
            [
                (
                    b.name,
                    b.frame,
                    b.value,
                    b.mute,
                    b.vertex_group,
                    b.relative_key.name,
                    _content(b.data),
                )
                for b in keys.key_blocks
            ],
            (keys.use_relative, keys.eval_time, obj.active_shape_key_index),
            None if keys.animation_data is None or keys.animation_data.action is None else timing(obj),
        ]
    return result


def _own(obj):
    """What a mesh or curve itself holds."""
    if obj.type == "CURVE":
        return [
            ([tuple(point.co) for point in spline.points], _content(spline.points), spline.use_cyclic_u)
            for spline in obj.data.splines
        ]
    rest = obj.data.attributes.get("planar_rest")
    return coordinates(obj.data.vertices).tobytes(), rest and coordinates(rest.data, "vector").tobytes()


def _content(points):
    """All that is stored of points: curves' have a radius and a tilt, too."""
    if not hasattr(points[0], "radius"):
        return coordinates(points).tobytes()
    return [(tuple(point.co), point.radius, point.tilt) for point in points]


class History:
    """Steps done to the object "Cutout", to be undone and redone one by one, each to the bit."""

    def __init__(self, state=stored):
        self._state = state
        bpy.ops.ed.undo_push(message="Start")
        self._states = [self._now()]

    def did(self, result):
        assert result == {"FINISHED"}
        bpy.ops.ed.undo_push(message="Step")
        self._states.append(self._now())

    def undo_all(self):
        for step in reversed(range(len(self._states) - 1)):
            assert bpy.ops.ed.undo() == {"FINISHED"}
            assert self._now() == self._states[step], f"undo to {step}"

    def redo_all(self):
        for step in range(1, len(self._states)):
            assert bpy.ops.ed.redo() == {"FINISHED"}
            assert self._now() == self._states[step], f"redo to {step}"

    def _now(self):
        return self._state(bpy.data.objects["Cutout"])


def pushed_down(obj, *, start=None, scale=1.0):
    """As Push Down in the Nonlinear Animation editor does it; the strip."""
    animation = obj.data.shape_keys.animation_data
    action, slot = animation.action, getattr(animation, "action_slot", None)
    track = animation.nla_tracks.new()
    strip = track.strips.new(action.name, int(action.frame_range[0]), action)
    if slot is not None:
        strip.action_slot = slot
    animation.action = None
    strip.scale = scale
    if start is not None:
        strip.frame_start_ui = start
    bpy.context.view_layer.update()
    return strip
