# SPDX-License-Identifier: GPL-3.0-or-later
"""A body, an arm and a lantern: drawings of their own that carry each other."""

import bpy
import numpy as np
from support import activate, add_pins, evaluated, grid, make_object, world

FIRST, LAST = 0, 1  # pins of a bar: its left and its right end


def strip(name, x, y, *, width=2.0, height=0.5, nx=16, ny=4, depth=0.0, pins="POINT"):
    """An upright bar with pins at its ends, or none."""
    vertices, faces = grid(nx, ny, width, height, origin=(x, y))
    upright = vertices[:, [0, 2, 1]] + (0.0, depth, 0.0)
    obj = make_object(upright, faces.tolist(), name=name)
    if pins:
        column = np.arange(ny + 1) * (nx + 1)
        add_pins(obj, column, column + nx, kind=pins)
    return obj


def body(**options):
    """From 0 to 2 in X, between 0 and 0.5 in Z; its patches lead it."""
    return strip("Body", 0.0, 0.0, pins="PATCH", **options)


def lantern(**options):
    """Hangs below the right end of the body, on which its upper pin lies."""
    obj = strip("Lantern", 1.7, -0.6, width=0.3, height=0.8, nx=4, ny=8, depth=-0.01, pins=None, **options)
    add_pins(obj, range(38, 43), range(5), kind="PATCH")
    return obj


def attach(*carried, to, whole=False):
    activate(to)
    for obj in carried:
        obj.select_set(True)
    assert bpy.ops.planar.attach_to(whole=whole) == {"FINISHED"}


def choose(obj, *keys):
    for key, pin in enumerate(obj.planar.pins):
        pin.select = key in keys


def drag(obj, key, offset=(0.0, 0.0), angle=0.0):
    activate(obj)
    choose(obj, key)
    if any(offset):
        assert bpy.ops.planar.drag_pins(pin=key, offset=offset) == {"FINISHED"}
    if angle:
        assert bpy.ops.planar.rotate_pins(pin=key, angle=angle) == {"FINISHED"}


def seen(obj):
    """Where Blender shows the vertices, in the plane that all drawings lie in."""
    return world(obj, evaluated(obj))[:, [0, 2]]


def motion(before, after, weights=None):
    """The turn (2 x 2) in the affine map that best fits k x 2 points, the offset with it, what they miss."""
    shares = np.ones(len(before)) if weights is None else weights
    shares = shares / shares.sum()
    centre, centre_after = shares @ before, shares @ after
    root = np.sqrt(shares)[:, None]
    fit = np.linalg.lstsq(root * (before - centre), root * (after - centre_after), rcond=None)[0].T
    angle = np.arctan2(fit[1, 0] - fit[0, 1], fit[0, 0] + fit[1, 1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    offset = centre_after - turn @ centre
    return turn, offset, np.abs(before @ turn.T + offset - after).max()


def place_of(obj, pin):
    """The vertices of the place of a carrier that a pin follows, and their weights."""
    index = obj.vertex_groups[pin.follow_group].index
    held = [(v.index, group.weight) for v in obj.data.vertices for group in v.groups if group.group == index]
    rows, weights = zip(*held, strict=True)
    return list(rows), np.array(weights)
