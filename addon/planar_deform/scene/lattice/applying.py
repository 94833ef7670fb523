# SPDX-License-Identifier: GPL-3.0-or-later
"""What a lattice does to meshes made part of them, as a shape key of each."""

from __future__ import annotations

import bpy
import numpy as np

from ...errors import Refusal
from ...model.plane.frame import Array32, mapped
from ..objects.flat_object import linear_of, origin_of
from ..objects.pose_store import store_of
from ..storage import points
from . import reaching
from .rig import displacements, factors_of, once_deformed, read_grid, weights_at


def apply(lattice: bpy.types.Object, *, keep_modifiers: bool) -> list[bpy.types.Object]:
    """Give every mesh in a lattice, hidden or not, a key with what the lattice does to it at present.

    Its modifiers are removed, or hidden to be kept. Raises Refusal, with nothing changed.
    """
    pairs = once_deformed(lattice, also_hidden=True)
    for obj, modifier in pairs:
        _check(obj, modifier)
    shapes = [_deformed(lattice, obj, modifier) for obj, modifier in pairs]
    for (obj, modifier), shape in zip(pairs, shapes, strict=True):
        if obj.data.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
        key = obj.shape_key_add(name=lattice.name, from_mix=False)
        points.write_block(key, shape)
        key.value = 1.0
        if keep_modifiers:
            modifier.show_viewport = modifier.show_render = False
        else:
            obj.modifiers.remove(modifier)
        points.update(obj)
    return [obj for obj, _ in pairs]


def _check(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    others = reaching.above(obj, modifier)
    if others:
        raise Refusal(
            f"Modifier '{others[0].name}' of '{obj.name}' stands above '{modifier.name}': apply it first"
        )
    if obj.library is not None or obj.data.library is not None or obj.data.override_library is not None:
        raise Refusal(
            f"The mesh of '{obj.name}' is linked: make it local with Object > Relations > Make Local"
        )
    if obj.data.users > 1:
        raise Refusal(
            f"The mesh of '{obj.name}' is used {obj.data.users} times: make it single-user in the Data tab"
        )
    if obj.data.shape_keys is not None and not obj.data.shape_keys.use_relative:
        raise Refusal(
            f"'{obj.name}' has keyed poses, to which a shape key cannot be added: bake them to relative "
            "shape keys first"
        )


def _deformed(lattice: bpy.types.Object, obj: bpy.types.Object, modifier: bpy.types.Modifier) -> Array32:
    """The Basis, count x 3, moved as the modifier moves what is shown."""
    shown = store_of(obj, unkeyed=True).shown[:, :3].astype(np.float64)
    places = mapped(shown, linear_of(obj)) + origin_of(obj)
    grid = read_grid(lattice)
    weights = weights_at(lattice, grid, places, factors_of(obj, modifier))
    now = store_of(lattice, unkeyed=True).shown[grid.layers[0], :3]
    of_points = mapped(now - grid.co, linear_of(lattice))
    moved = mapped(displacements(weights, of_points), np.linalg.inv(linear_of(obj)))
    keys = obj.data.shape_keys
    basis = points.read(obj) if keys is None else points.read_block(obj, keys.reference_key)
    shape: Array32 = (basis + moved).astype(np.float32)
    return shape
