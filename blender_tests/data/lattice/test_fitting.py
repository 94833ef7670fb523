# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices that are fitted round objects, given to others, and made shape keys of what they deform."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Quaternion
from support import PLANES, TRANSFORMS, activate, bar, coordinates, evaluated, grid, make_object, world

TURNED = Matrix.LocRotScale((0.3, 1.0, 2.0), Euler((np.pi / 2, 0.0, 0.2)), (0.7, 0.7, 0.7))  # as imported


def choose(*objects):
    """Select these; the last one is active."""
    activate(objects[-1])
    for obj in objects:
        obj.select_set(True)


def layers(matrix=TURNED):
    """Three flat layers, one behind the other."""
    objects = []
    for index, (width, origin) in enumerate(((2.0, (0.0, 0.0)), (1.0, (0.6, 0.4)), (0.5, (1.7, 0.2)))):
        vertices = grid(8, 6, width, width / 2, origin=origin, depth=0.1 * index)
        objects.append(make_object(*vertices, name=f"Layer {index}"))
        objects[-1].matrix_world = matrix
    choose(*objects)
    return objects


def turn_all(lattice, angle):
    """Turn all points of a lattice in its plane, in the world."""
    matrix = np.array(lattice.matrix_world)
    places = coordinates(lattice.data.points) @ matrix[:3, :3].T.astype(float)
    axis = np.cross(matrix[:3, 0], matrix[:3, 1])
    turned = places @ np.array(Quaternion(axis, angle).to_matrix()).T
    local = turned @ np.linalg.inv(matrix[:3, :3]).T
    lattice.data.points.foreach_set("co_deform", local.astype(np.float32).ravel())
    lattice.data.update_tag()


@pytest.mark.parametrize("transform", TRANSFORMS)
def test_layers_get_one_lattice_in_their_plane_with_a_free_cell_about_them(transform):
    objects = layers(TRANSFORMS[transform])
    before = [world(obj, evaluated(obj)) for obj in objects]
    assert bpy.ops.planar.fit_lattice() == {"FINISHED"}
    lattice = bpy.context.object
    assert lattice.type == "LATTICE"
    assert bpy.context.selected_objects == [lattice]
    assert (lattice.data.points_u, lattice.data.points_v, lattice.data.points_w) == (14, 14, 1)
    every = np.concatenate(before)
    steps = np.array(lattice.matrix_world.inverted()) @ np.c_[every, np.ones(len(every))].T
    steps = (steps[:2].T + 0.5) * 13  # in cells
    np.testing.assert_allclose(steps.min(axis=0), 1.0, atol=2e-3)
    np.testing.assert_allclose(steps.max(axis=0), 12.0, atol=2e-3)
    for obj, places in zip(objects, before, strict=True):
        assert [modifier.object for modifier in obj.modifiers] == [lattice]
        size = np.abs(places).max()
        np.testing.assert_allclose(world(obj, evaluated(obj)), places, atol=1e-6 * size)


@pytest.mark.parametrize("basis", ["KEY_BSPLINE", "KEY_CATMULL_ROM", "KEY_LINEAR"])
def test_turning_all_points_turns_the_layers_rigidly(basis):
    objects = layers()
    bpy.ops.planar.fit_lattice(basis=basis)
    before = [world(obj, evaluated(obj)) for obj in objects]
    turn_all(bpy.context.object, np.pi / 2)
    distance = np.linalg.norm(before[0][0] - before[0][-1])
    for obj, places in zip(objects, before, strict=True):
        after = world(obj, evaluated(obj))
        arms, turned = places - places[0], after - after[0]
        np.testing.assert_allclose(arms @ arms.T, turned @ turned.T, atol=2e-6 * distance)
        assert np.linalg.norm(after - places, axis=1).max() > 0.3 * distance


@pytest.mark.parametrize("plane", PLANES)
def test_pins_can_be_dragged_at_once(plane):
    obj = bar(plane=plane)
    bpy.ops.planar.fit_lattice()
    lattice = bpy.context.object
    for vertex in (0, 64):
        assert bpy.ops.planar.add_pin(location=world(obj)[vertex]) == {"FINISHED"}
    before = world(obj, evaluated(obj))
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    moved = world(obj, evaluated(obj)) - before
    assert np.linalg.norm(moved[64]) == pytest.approx(np.hypot(0.2, 0.1), abs=5e-3)
    assert np.linalg.norm(moved[0]) < 5e-3
    assert lattice.planar.pins[1].object == obj


def test_a_model_gets_a_box_along_its_axes():
    vertices, faces = grid(10, 5)
    vertices = np.array(vertices)
    vertices[:, 2] = 0.3 * np.sin(2.0 * vertices[:, 0])
    obj = make_object(vertices, faces, name="Sheet")
    obj.matrix_world = TURNED
    activate(obj)
    assert bpy.ops.planar.fit_lattice() == {"FINISHED"}
    lattice = bpy.context.object
    data = lattice.data
    assert (data.points_u, data.points_v, data.points_w) == (8, 8, 8)
    axes = np.array(lattice.matrix_world)[:3, :3]
    axes /= np.linalg.norm(axes, axis=0)
    np.testing.assert_allclose(axes, np.array(TURNED.to_quaternion().to_matrix()), atol=1e-6)


def test_across_a_camera_a_model_moves_in_no_depth():
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    camera.matrix_world = Matrix.LocRotScale(
        (4.0, -3.0, 2.0), Quaternion((0.7, 0.5, 0.3, 0.4)).normalized(), None
    )
    bpy.context.scene.camera = camera
    activate(monkey)
    before = world(monkey, evaluated(monkey))
    assert bpy.ops.planar.fit_lattice(space="CAMERA", resolution=(10, 12)) == {"FINISHED"}
    assert (bpy.context.object.data.points_u, bpy.context.object.data.points_v) == (10, 12)
    for vertex in (0, 100, 400):
        bpy.ops.planar.add_pin(location=before[vertex])
    assert bpy.ops.planar.drag_pins(offset=(0.3, 0.2)) == {"FINISHED"}
    moved = world(monkey, evaluated(monkey)) - before
    assert np.abs(moved).max() > 0.1
    depth = moved @ np.array(camera.matrix_world)[:3, 2]
    assert np.abs(depth).max() < 1e-6


def test_a_view_is_told_by_scripts():
    obj = bar()
    with pytest.raises(RuntimeError, match="no view here"):
        bpy.ops.planar.fit_lattice(space="VIEW")
    assert not obj.modifiers
    assert bpy.ops.planar.fit_lattice(space="VIEW", view=(0.9, 0.1, 0.3, 0.2)) == {"FINISHED"}
    turn = Quaternion((0.9, 0.1, 0.3, 0.2)).normalized()
    assert bpy.context.object.matrix_world.to_quaternion().rotation_difference(turn).angle < 1e-5


def test_refusals_change_nothing():
    lattices = len(bpy.data.lattices)
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    with pytest.raises(RuntimeError, match="not drawn in one plane"):
        bpy.ops.planar.fit_lattice(space="PLANE")
    with pytest.raises(RuntimeError, match="leave no cell"):
        bpy.ops.planar.fit_lattice(resolution_in_space=(8, 3, 8))
    with pytest.raises(RuntimeError, match="32000 in all"):
        bpy.ops.planar.fit_lattice(resolution_in_space=(64, 64, 64))
    bpy.context.scene.camera = None
    with pytest.raises(RuntimeError, match="no camera"):
        bpy.ops.planar.fit_lattice(space="CAMERA")
    assert not monkey.modifiers
    assert len(bpy.data.lattices) == lattices
    monkey.data.vertices[0].co.x = np.nan
    with pytest.raises(RuntimeError, match="not numbers"):
        bpy.ops.planar.fit_lattice()
    assert len(bpy.data.lattices) == lattices
    monkey.select_set(False)
    with pytest.raises(RuntimeError, match="No meshes are selected"):
        bpy.ops.planar.fit_lattice()


def test_what_hangs_in_a_lattice_gets_another_one_only_when_asked():
    objects = layers()
    bpy.ops.planar.fit_lattice()
    first = bpy.context.object
    choose(*objects)
    with pytest.raises(RuntimeError, match="hangs in 'Lattice' already: pose it by that"):
        bpy.ops.planar.fit_lattice()
    assert [modifier.object for obj in objects for modifier in obj.modifiers] == 3 * [first]
    assert list(bpy.data.lattices) == [first.data]
    # Added, it deforms what the first one deforms.
    choose(objects[2])
    assert bpy.ops.planar.fit_lattice(others="ADD") == {"FINISHED"}
    second = bpy.context.object
    assert [modifier.object for modifier in objects[2].modifiers] == [second, first]
    # In their place, it is the only one, and the others are left as they are.
    choose(*objects)
    assert bpy.ops.planar.fit_lattice(others="REPLACE", resolution=(9, 9)) == {"FINISHED"}
    third = bpy.context.object
    assert third not in {first, second}
    assert [modifier.object for obj in objects for modifier in obj.modifiers] == 3 * [third]
    assert first.name in bpy.context.view_layer.objects
    # That is said once, and not kept for the next time.
    choose(*objects)
    with pytest.raises(RuntimeError, match="already"):
        bpy.ops.planar.fit_lattice()


def test_from_a_layer_it_is_one_step_to_its_lattice():
    objects = layers()
    with pytest.raises(RuntimeError, match="hangs in no lattice"):
        bpy.ops.planar.select_lattice()
    bpy.ops.planar.fit_lattice()
    lattice = bpy.context.object
    choose(objects[0], objects[1])
    assert bpy.ops.planar.select_lattice() == {"FINISHED"}
    assert bpy.context.object == lattice
    assert bpy.context.selected_objects == [lattice]
    choose(objects[2])
    bpy.ops.planar.fit_lattice(others="ADD")
    second = bpy.context.object
    for name in (lattice.name, second.name):
        choose(objects[2])
        assert bpy.ops.planar.select_lattice(lattice=name) == {"FINISHED"}
        assert bpy.context.object.name == name
    lattice.hide_set(True)
    choose(objects[0])
    with pytest.raises(RuntimeError, match="is hidden: show it"):
        bpy.ops.planar.select_lattice()
    assert bpy.context.object == objects[0]


def test_others_are_added_with_the_group_and_the_strength():
    first, second, third = layers()
    third.select_set(False)
    first.vertex_groups.new(name="Bent").add(range(40), 0.5, "REPLACE")
    choose(first)
    bpy.ops.planar.fit_lattice()
    lattice = bpy.context.object
    first.modifiers[0].vertex_group, first.modifiers[0].strength = "Bent", 0.8
    second.modifiers.new("Bevel", "BEVEL")
    choose(second, lattice)
    assert bpy.ops.planar.add_to_lattice() == {"FINISHED"}
    added = second.modifiers[0]
    assert (added.object, added.strength, added.vertex_group) == (lattice, pytest.approx(0.8), "Bent")
    assert not third.modifiers
    weights = [sum(group.weight for group in vertex.groups) for vertex in second.data.vertices]
    assert 0.0 < sum(weight > 0.0 for weight in weights) < len(weights)
    with pytest.raises(RuntimeError, match="all of them already"):
        bpy.ops.planar.add_to_lattice()


@pytest.mark.parametrize("depth", [1, 2])
@pytest.mark.parametrize("keyed", [False, True])
def test_applied_the_meshes_keep_what_the_lattice_showed(keyed, depth):
    objects = layers()
    if keyed:
        objects[1].shape_key_add(name="Basis")
        smile = objects[1].shape_key_add(name="Smile", from_mix=False)
        smile.data[5].co.x += 0.3
        smile.value = 0.7
    bpy.ops.planar.fit_lattice()
    lattice = bpy.context.object
    lattice.data.points_w = depth
    moved = np.tile(np.random.default_rng(1).normal(scale=0.05, size=(196, 3)), (depth, 1))
    moved[:, 2] = 0.0
    places = (coordinates(lattice.data.points) + moved).astype(np.float32)
    lattice.data.points.foreach_set("co_deform", places.ravel())
    lattice.data.update_tag()
    before = [evaluated(obj) for obj in objects]
    assert bpy.ops.planar.apply_lattice() == {"FINISHED"}
    for obj, shape in zip(objects, before, strict=True):
        assert not obj.modifiers
        assert obj.data.shape_keys.key_blocks[-1].name == "Lattice"
        np.testing.assert_allclose(evaluated(obj), shape, atol=2e-6)


def test_applied_meshes_may_keep_their_modifiers_and_shared_ones_are_refused():
    first, second, third = layers()
    bpy.ops.planar.fit_lattice()
    lattice = bpy.context.object
    twin = bpy.data.objects.new("Twin", third.data)
    bpy.context.scene.collection.objects.link(twin)
    with pytest.raises(RuntimeError, match="used 2 times"):
        bpy.ops.planar.apply_lattice()
    assert first.data.shape_keys is None
    bpy.data.objects.remove(twin)
    activate(lattice)
    assert bpy.ops.planar.apply_lattice(keep_modifiers=True) == {"FINISHED"}
    assert not second.modifiers[0].show_viewport
    assert not second.modifiers[0].show_render
