# SPDX-License-Identifier: GPL-3.0-or-later
"""With Symmetry, pins take their partners along, mirrored."""

import bpy
import numpy as np
import pytest
from drawings import character
from sequences import same
from support import PLANES, TRANSFORMS, activate, add_pins, bar, coordinates, evaluated


def sides(plane="XY", transform="none", kind="POINT"):
    """A bar with a pin on its middle and one at each end, of which the right one is selected."""
    obj = bar(plane=plane)
    obj.matrix_world = TRANSFORMS[transform]
    add_pins(obj, [32])
    add_pins(obj, [0, 13, 26, 39, 52], [12, 25, 38, 51, 64], kind=kind)
    obj.planar.use_mirror_x = True
    activate(obj)
    return obj


def positions_of(obj):
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    return begin(bpy.context).positions


def assert_symmetric(obj, rows, tolerance=2e-3):
    """Rows of vertices at the left end are the mirror image of those at the right one."""
    positions, lefts = positions_of(obj), [13 * (row // 13) + 12 - row % 13 for row in rows]
    gaps = positions[lefts] * [-1.0, 1.0] - positions[rows]
    assert np.ptp(gaps, axis=0).max() < tolerance * np.ptp(positions, axis=0).max()
    assert np.abs(gaps[:, 1]).max() < tolerance * np.ptp(positions, axis=0).max()


@pytest.mark.parametrize("kind", ["POINT", "PATCH"])
@pytest.mark.parametrize("plane", PLANES)
def test_a_drag_moves_both_sides(plane, kind):
    obj = sides(plane, kind=kind)
    before = positions_of(obj)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.3)) == {"FINISHED"}
    moved = positions_of(obj) - before
    assert_symmetric(obj, [12, 25, 38, 51, 64], 0.01)
    assert moved[38, 1] == pytest.approx(0.3, abs=0.01)
    np.testing.assert_allclose(moved[26], moved[38] * [-1.0, 1.0], atol=2e-3)
    assert [pin.select for pin in obj.planar.pins] == [False, False, True]


@pytest.mark.parametrize("transform", ["rotated", "mirrored", "huge and far"])
def test_turns_and_scales_too_whatever_the_object_is_like(transform):
    obj = sides(transform=transform, kind="PATCH")
    assert bpy.ops.planar.rotate_pins(angle=0.5) == {"FINISHED"}
    assert_symmetric(obj, [12, 25, 38, 51, 64], 0.01)
    assert obj.planar.pins[1].angle == pytest.approx(-obj.planar.pins[2].angle)
    assert bpy.ops.planar.spread_pins(factor=1.2) == {"FINISHED"}
    assert_symmetric(obj, [12, 25, 38, 51, 64], 0.01)
    np.testing.assert_allclose([pin.scale for pin in obj.planar.pins], [1.0, 1.2, 1.2], rtol=1e-6)


def test_who_goes_alone():
    obj = sides()
    obj.planar.pins[1].enabled = False
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.2)) == {"FINISHED"}
    obj.planar.pins[1].enabled = True
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    obj.planar.use_mirror_x = False
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.3)) == {"FINISHED"}
    alone = evaluated(obj)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    for pin in obj.planar.pins:
        pin.select = True
    obj.planar.use_mirror_x = True
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.3)) == {"FINISHED"}
    shape = positions_of(obj)
    rest = coordinates(obj.data.vertices)[:, :2]
    np.testing.assert_allclose(np.ptp(shape, axis=0), np.ptp(rest, axis=0), atol=1e-3)
    assert not np.allclose(alone, evaluated(obj), atol=0.01)


def test_names_pair_what_places_do_not_and_undo_takes_both_back():
    obj = character("racoon")
    x = coordinates(obj.data.vertices)
    left, right = (int(x[:, 0].argmin()), int(x[:, 0].argmax()))
    add_pins(obj, [int(np.abs(x - x.mean(axis=0)).sum(axis=1).argmin())], [left], [right])
    obj.planar.pins[1].name, obj.planar.pins[2].name = "Hand.L", "Hand.R"
    obj.planar.use_mirror_x = True
    activate(obj)
    start = positions_of(obj)
    before = evaluated(obj)
    bpy.ops.ed.undo_push(message="Before")
    assert bpy.ops.planar.drag_pins(offset=(0.02, 0.05)) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Drag")
    moved = positions_of(obj) - start
    np.testing.assert_allclose(moved[left], moved[right] * [-1.0, 1.0], atol=5e-3)
    assert np.linalg.norm(moved[right]) > 0.04
    name = obj.name
    assert bpy.ops.ed.undo() == {"FINISHED"}
    assert same(evaluated(bpy.data.objects[name]), before)
