# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of objects with pins, and whether it is what a new reading shows."""

import bpy
import numpy as np
from support import add_end_pins, bar, world


def seen_of(obj):
    """What a window shows whose active object this is."""
    from planar_deform.scene.view import snapshot

    with bpy.context.temp_override(object=obj):
        return snapshot.of_active(bpy.context)


def update():
    bpy.context.view_layer.update()


def pinned(name="Cutout", at=(0.0, 0.0, 0.0)):
    obj = bar(name=name)
    obj.location = at
    add_end_pins(obj)
    obj.planar.show_mesh = True
    update()
    return obj


MIDDLE = 26  # of the left column, whose pin is there


def left_pin(obj):
    """Where the pin on the left column should be, seen from the mesh itself."""
    return world(obj)[MIDDLE]


def assert_same(seen, other):
    """Two snapshots show the same, to the bit."""
    assert seen.refusal == other.refusal
    assert [pin.key for pin in seen.pins] == [pin.key for pin in other.pins]
    for mine, theirs in zip(seen.pins, other.pins, strict=True):
        assert np.array_equal(mine.place, theirs.place)
        assert np.array_equal(mine.target, theirs.target)
        assert np.array_equal(mine.turned, theirs.turned)
        assert mine.angle == theirs.angle
    assert np.array_equal(seen.edges, other.edges)
    if seen.refusal is None:
        assert np.array_equal(seen.points, other.points)
        assert np.array_equal(seen.triangles, other.triangles)
        assert np.array_equal(seen.distortion.triangle_area, other.distortion.triangle_area)


def assert_as_read_anew(obj):
    """What is shown is what a new reading shows."""
    from planar_deform.scene.objects import cutout_object, triangulation
    from planar_deform.scene.storage import vertex_groups
    from planar_deform.scene.view import snapshot

    seen = seen_of(obj)
    for module in (snapshot, cutout_object, triangulation, vertex_groups):
        module.forget()
    assert_same(seen, seen_of(obj))
