# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of a lattice and of what it deforms, beside what Blender evaluates."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Quaternion
from support import TRANSFORMS, activate, coordinates, evaluated, grid, make_object, world

from planar_deform.errors import Refusal
from planar_deform.scene.lattice.rig import read_rig

KINDS = ("KEY_LINEAR", "KEY_CARDINAL", "KEY_CATMULL_ROM", "KEY_BSPLINE")


def random_matrix(random):
    scale = random.uniform(0.3, 2.0, 3) * random.choice([1.0, -1.0], 3)
    return Matrix.LocRotScale(random.uniform(-3, 3, 3), Quaternion(random.normal(size=4)).normalized(), scale)


def random_scene(seed):
    """Three objects of any transform in one lattice of any kind, some with groups, keys and parents."""
    random = np.random.default_rng(seed)
    data = bpy.data.lattices.new("Lattice")
    counts = random.integers(2, 7, 3)
    if random.random() < 0.5:
        counts[random.integers(3)] = 1
    data.points_u, data.points_v, data.points_w = map(int, counts)
    for axis in "uvw":
        setattr(data, f"interpolation_type_{axis}", random.choice(KINDS))
    cage = bpy.data.objects.new("Lattice", data)
    bpy.context.scene.collection.objects.link(cage)
    cage.matrix_world = random_matrix(random)
    if random.random() < 0.4:
        group = cage.vertex_groups.new(name="Mask")
        for index in range(len(data.points)):
            group.add([index], random.random(), "REPLACE")
        data.vertex_group = "Mask"
    for index in range(3):
        obj = make_object(*grid(5, 4), name=f"Part {index}")
        obj.data.vertices.foreach_set("co", random.normal(size=90).astype(np.float32))
        obj.matrix_world = random_matrix(random)
        if random.random() < 0.4:
            obj.parent = cage
        modifier = obj.modifiers.new("Lattice", "LATTICE")
        modifier.object, modifier.strength = cage, random.uniform(0.2, 1.0)
        if random.random() < 0.5:
            group = obj.vertex_groups.new(name="Part")
            group.add(random.permutation(30)[:20].tolist(), random.random(), "REPLACE")
            modifier.vertex_group, modifier.invert_vertex_group = "Part", bool(random.random() < 0.5)
        if random.random() < 0.4:
            obj.shape_key_add(name="Basis")
            key = obj.shape_key_add(name="Key", from_mix=False)
            key.data.foreach_set("co", random.normal(size=90).astype(np.float32))
            key.value = 0.6
        if random.random() < 0.3:
            obj.modifiers.new("Weights", "UV_PROJECT")
            obj.modifiers.move(1, 0)
    moved = coordinates(data.points) + random.normal(scale=0.2, size=(len(data.points), 3))
    data.points.foreach_set("co_deform", moved.astype(np.float32).ravel())
    data.update_tag()
    activate(cage)
    return cage


def assert_as_evaluated(cage, seed):
    """What is read of a random scene shows it as Blender does."""
    rig = read_rig(cage)
    shown = rig.shown(world(cage, coordinates(cage.data.points, "co_deform")))
    for obj, part, start in zip(rig.meshes, rig.parts, rig.starts, strict=False):
        rows = rig.rows_of(obj, np.arange(30, dtype=np.int32))
        np.testing.assert_array_equal(rows, start + np.arange(30))
        matrix = np.array(obj.matrix_world)
        found = (shown[rows] - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
        expected = evaluated(obj)
        # Blender computes in float32.
        off = np.abs(found - expected).max() / max(1.0, np.abs(expected).max())
        assert off <= 1e-6, (seed, part.name)
    return rig


@pytest.mark.parametrize("seed", range(60))
def test_what_blender_evaluates_is_the_rest_and_the_weighted_displacements_of_the_points(seed):
    cage = random_scene(seed)
    rig = assert_as_evaluated(cage, seed)
    for obj, start in zip(rig.meshes, rig.starts, strict=False):
        assert rig.vertices_of(np.arange(start + 5, start + 7))[0] == obj


def test_what_has_not_changed_is_the_very_same_again():
    cage = random_scene(1)
    before = read_rig(cage)
    cage.data.points[3].co_deform.x += 0.1
    cage.data.update_tag()
    bpy.context.view_layer.update()
    assert read_rig(cage) is before
    one = bpy.data.objects["Part 1"]
    one.location.x += 0.5
    bpy.context.view_layer.update()
    after = read_rig(cage)
    assert after is not before
    assert [a is b for a, b in zip(after.parts, before.parts, strict=True)] == [True, False, True]


@pytest.mark.parametrize("transform", TRANSFORMS)
def test_a_mesh_with_loose_vertices_and_one_without_a_name_alike(transform):
    cage = random_scene(2)
    vertices, faces = grid(3, 3)
    loose = make_object([*vertices, (9, 9, 9)], faces, name="Loose")
    loose.matrix_world = TRANSFORMS[transform]
    loose.modifiers.new("Lattice", "LATTICE").object = cage
    activate(cage)
    rig = read_rig(cage)
    rows = rig.rows_of(loose, np.array([0, 16, 40], np.int32))
    assert rows[0] >= 0
    assert rows[1:].tolist() == [-1, -1]


def refusal(cage):
    bpy.context.view_layer.update()
    with pytest.raises(Refusal) as found:
        read_rig(cage)
    return str(found.value)


def test_refusals_say_what_to_do():
    cage = random_scene(3)
    one = bpy.data.objects["Part 0"]
    above = one.modifiers.new("Bent", "BEVEL")
    one.modifiers.move(len(one.modifiers) - 1, 0)
    assert "'Bent' of 'Part 0' makes new vertices above 'Lattice': move it below" in refusal(cage)
    above.show_viewport = False
    read_rig(cage)
    second = one.modifiers.new("Again", "LATTICE")
    second.object = cage
    above.show_viewport = True
    one.modifiers.remove(above)
    one.modifiers.move(len(one.modifiers) - 1, 0)
    assert "'Part 0'" in refusal(cage)
    one.modifiers.remove(one.modifiers["Again"])
    cage.data.use_outside = True
    assert "turn it off" in refusal(cage)
    cage.data.use_outside = False
    cage.modifiers.new("Cast", "CAST")
    assert "moves points of 'Lattice'" in refusal(cage)
    cage.modifiers.clear()
    for obj in list(bpy.data.objects):
        if obj.type == "MESH":
            obj.hide_viewport = True
    assert "deforms no mesh that is shown" in refusal(cage)
    cage.data.points_u = cage.data.points_v = cage.data.points_w = 1
    assert "one point in" in refusal(cage)
