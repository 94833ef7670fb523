# SPDX-License-Identifier: GPL-3.0-or-later
"""A bar with keyed poses."""

from sequences import key
from support import add_end_pins, bar


def keyed_bar(frames=(1, 25, 49), **options):
    """A pinned bar with poses keyed in this order, and what each keyed frame showed when it was keyed."""
    obj = bar(**options)
    add_end_pins(obj)
    return obj, {frame: key(obj, frame, seed) for seed, frame in enumerate(frames)}


def names(obj):
    return [pose.name for pose in obj.planar.poses]


def frames(obj):
    from planar_deform.scene.sequence import pose_state

    return [pose_state.frames_of(obj, index) for index in range(len(obj.planar.poses))]
