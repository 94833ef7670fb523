# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects with poses to fill in between, and all that is stored of them."""

import bpy
import numpy as np
from sequences import curve_of, go_to, stored
from support import activate, bar, evaluated

FRAMES = (1, 25, 49)


def bent(positions, rest, amount):
    """The bar (rest n x 2) bent about its left end by an angle that grows to `amount` (radians)."""
    along, across = rest[:, 0], rest[:, 1] - 0.5
    angle = amount * along / 2.0
    radius = 2.0 / amount if abs(amount) > 1e-6 else np.inf
    if np.isinf(radius):
        return np.stack([along, across], axis=1)
    return np.stack([(radius - across) * np.sin(angle), radius - (radius - across) * np.cos(angle)], axis=1)


def put(obj, shapes):
    """Key n x 2 positions by frame; what each frame shows then."""
    from planar_deform.scene.objects.any_object import begin_shape, key_poses

    activate(obj)
    key_poses(begin_shape(bpy.context), shapes)
    return {frame: shown(obj, frame) for frame in shapes}


def shown(obj, frame):
    go_to(frame)
    return evaluated(obj)


def bent_bar(frames=FRAMES, amounts=(0.6, -1.4, 2.4, 0.3, -0.8), obj=None, **options):
    """A bar with a pose bent by each amount at each frame, and what the frames show."""
    from planar_deform.scene.objects.any_object import begin_shape

    obj = bar(**options) if obj is None else obj
    activate(obj)
    rest = begin_shape(bpy.context).rest
    return obj, put(obj, {f: bent(None, rest, amount) for f, amount in zip(frames, amounts, strict=False)})


def generate(obj, **options):
    activate(obj)
    assert bpy.ops.planar.generate_inbetweens(**options) == {"FINISHED"}


def remove(obj):
    activate(obj)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}


def stale(obj):
    from planar_deform.scene.sequence import stretches

    return stretches.stale(obj)


def curve_fields(obj):
    from planar_deform.scene.sequence import pose_curve

    curve = curve_of(obj)
    modifiers = [(modifier.type, modifier.mute) for modifier in curve.modifiers]
    return {name: values.tobytes() for name, values in pose_curve._fields(curve).items()}, modifiers


def everything(obj):
    """All that is stored of the poses, their list, their settings and their curve, as plain values."""
    from planar_deform.scene.sequence.playback import record_of

    settings = obj.planar
    return [
        *stored(obj),
        [record_of(pose) for pose in settings.poses],
        (settings.active_pose, settings.anchor_path, settings.smooth, settings.curve_before),
        [(b.interpolation, b.lock_shape, b.slider_max) for b in obj.data.shape_keys.key_blocks],
        curve_fields(obj),
        len(bpy.data.actions),
    ]


def frames_shown(obj, frames):
    return {frame: shown(obj, frame) for frame in frames}
