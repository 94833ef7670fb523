# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches made of pins by a radius; pins switched off and on."""

import bpy
import numpy as np
import pytest
from support import TRANSFORMS, add_end_pins, bar, coordinates, grid, make_object, measured, world


def held_by(obj, index=0):
    """The mesh vertices of a pin's group."""
    group = obj.vertex_groups[obj.planar.pins[index].group].index
    return [v.index for v in obj.data.vertices if any(e.group == group for e in v.groups)]


@pytest.mark.parametrize("transform", ["none", "rotated", "tiny", "stretched"])
def test_a_point_becomes_a_patch_of_all_vertices_within_a_radius(transform):
    obj = bar(plane="XZ")
    obj.matrix_world = TRANSFORMS[transform]
    spot = world(obj)[30]
    bpy.ops.planar.add_pin(location=spot)
    distances = np.linalg.norm(world(obj) - spot, axis=1)
    radius = float(np.sort(distances)[7])
    assert bpy.ops.planar.set_pin_radius(radius=radius * 1.0001) == {"FINISHED"}
    assert obj.planar.pins[0].kind == "PATCH"
    assert held_by(obj) == np.flatnonzero(distances <= radius * 1.0001).tolist()
    assert bpy.ops.planar.set_pin_radius(radius=10 * distances.max()) == {"FINISHED"}, (
        "a patch gets another size"
    )
    assert len(held_by(obj)) == len(obj.data.vertices)
    assert len(obj.vertex_groups) == 1


def test_a_patch_by_radius_holds_the_drawing_as_it_is_posed():
    obj = bar()
    add_end_pins(obj)
    bpy.ops.planar.drag_pins(offset=(-0.3, 0.6))
    before = coordinates(obj.data.vertices)
    place = np.array(obj.planar.pins[1].reached)
    bpy.ops.planar.set_pin_radius(radius=0.3)
    near = np.flatnonzero(np.linalg.norm(before - place, axis=1) <= 0.3)
    assert held_by(obj, 1) == near.tolist(), "what is seen within the circle"
    assert np.array_equal(coordinates(obj.data.vertices), before)
    assert bpy.ops.planar.rotate_pins(angle=0.3) == {"FINISHED"}
    assert measured(obj).flipped == 0


def test_too_small_a_radius_is_refused_with_the_one_that_is_needed():
    obj = bar()
    bpy.ops.planar.add_pin(location=(1.02, 0.51, 0.0))
    held, groups = held_by(obj), obj.vertex_groups.keys()
    with pytest.raises(RuntimeError, match="radius 0"):
        bpy.ops.planar.set_pin_radius(radius=0.01)
    assert obj.planar.pins[0].kind == "POINT"
    assert held_by(obj) == held
    assert obj.vertex_groups.keys() == groups
    obj.planar.pins[0].select = False
    with pytest.raises(RuntimeError, match="selected"):
        bpy.ops.planar.set_pin_radius(radius=1.0)


def test_a_patch_by_radius_leaves_other_layers_and_the_users_groups_alone():
    vertices, faces = grid(6, 3)
    obj = make_object(
        np.concatenate([vertices, vertices + np.array([0.1, 0.1, 0.4])]),
        faces.tolist() + (faces + 28).tolist(),
    )
    hand = obj.vertex_groups.new(name="Hand")
    hand.add([30], 1.0, "REPLACE")
    bpy.ops.planar.add_pin_from_group(group="Hand", kind="POINT")
    assert bpy.ops.planar.set_pin_radius(radius=0.5) == {"FINISHED"}
    assert min(held_by(obj)) >= 28, "of the pin's own layer"
    assert len(held_by(obj)) > 2
    assert obj.planar.pins[0].name == "Hand"
    index = obj.vertex_groups["Hand"].index
    kept = [v.index for v in obj.data.vertices if any(e.group == index for e in v.groups)]
    assert kept == [30], "a group that the pin was only put on"
    bpy.ops.planar.remove_pins()
    assert obj.vertex_groups.keys() == ["Hand"]


def test_pins_are_switched_off_and_all_on_again():
    obj = bar()
    add_end_pins(obj)
    assert bpy.ops.planar.disable_pins() == {"FINISHED"}
    assert [pin.enabled for pin in obj.planar.pins] == [True, False]
    assert bpy.ops.planar.disable_pins() == {"CANCELLED"}
    obj.planar.pins[0].enabled = False
    assert bpy.ops.planar.enable_pins() == {"FINISHED"}
    assert [pin.enabled for pin in obj.planar.pins] == [True, True]
    assert bpy.ops.planar.enable_pins() == {"CANCELLED"}
