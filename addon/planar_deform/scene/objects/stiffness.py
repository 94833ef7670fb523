# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted stiffness: the weights of one vertex group."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from ...model.plane.cutout import NEUTRAL
from ...model.plane.frame import Array
from ..storage import vertex_groups
from ..storage.vertex_groups import members

GROUP_NAME = "Stiffness"


def painted(obj: bpy.types.Object) -> Array | None:
    """The stiffness painted on each vertex (count,), neutral outside of the group; None without a group."""
    name = obj.planar.stiffness_group
    group = members(obj, [name]).get(name)
    if group is None:
        return None
    rows, weights = group
    stiffness = np.full(len(obj.data.vertices), NEUTRAL)
    stiffness[rows] = weights
    return stiffness


def stamp(painted: Array | None) -> str:
    """A short text that is another one for another painting; the same for none and for a neutral one."""
    if painted is None or (painted == NEUTRAL).all():
        return "neutral"
    return hashlib.blake2b(painted.tobytes(), digest_size=12).hexdigest()


def missing(obj: bpy.types.Object) -> bool:
    """Whether the settings name a group that the object does not have."""
    return bool(obj.planar.stiffness_group) and obj.planar.stiffness_group not in obj.vertex_groups


def ensure_group(obj: bpy.types.Object) -> bpy.types.VertexGroup:
    """The group that stiffness is painted in; a new one, neutral everywhere, if there is none."""
    group = obj.vertex_groups.get(obj.planar.stiffness_group)
    if group is None:
        group = obj.vertex_groups.new(name=GROUP_NAME)
        vertex_groups.give(group, range(len(obj.data.vertices)), NEUTRAL)
        obj.planar.stiffness_group = group.name
    return group
