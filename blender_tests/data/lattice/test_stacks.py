# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifiers above the lattice's: what they make of a mesh is what the lattice deforms."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from support import activate, coordinates, grid, make_object, world
from test_lattice_posing import layered, pin_at, shown
from test_rig import assert_as_evaluated, random_scene

from planar_deform.errors import Refusal
from planar_deform.scene.lattice.rig import read_rig


def armature():
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    for index in range(2):
        bone = data.edit_bones.new(f"Bone {index}")
        bone.head, bone.tail = (index, 0, 0), (index, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones[1].rotation_quaternion = (0.9, 0.1, 0.3, 0.2)
    return rig


def deform(obj, random, rig):
    """One or two deforming modifiers, first in the stack."""
    kinds = random.permutation(["SIMPLE_DEFORM", "WAVE", "ARMATURE", "CAST", "LATTICE"])
    for kind in kinds[: random.integers(1, 3)]:
        modifier = obj.modifiers.new(str(kind), str(kind))
        if kind == "SIMPLE_DEFORM":
            modifier.deform_method, modifier.factor = "BEND", random.uniform(-1, 1)
        elif kind == "ARMATURE":
            modifier.object = rig
            obj.vertex_groups.new(name="Bone 1").add(random.permutation(30)[:15].tolist(), 0.7, "REPLACE")
        elif kind == "CAST":
            modifier.factor = random.uniform(-0.5, 0.5)
        elif kind == "LATTICE":
            other = bpy.data.objects.new("Other", bpy.data.lattices.new("Other"))
            bpy.context.scene.collection.objects.link(other)
            other.scale = (6, 6, 6)
            other.data.points[3].co_deform.x += 0.2
            modifier.object = other
        obj.modifiers.move(len(obj.modifiers) - 1, 0)


@pytest.mark.parametrize("seed", range(40))
def test_what_blender_evaluates_is_what_reaches_the_modifier_and_the_weighted_displacements(seed):
    cage = random_scene(seed)
    rig, random = armature(), np.random.default_rng(1000 + seed)
    for index in range(3):
        deform(bpy.data.objects[f"Part {index}"], random, rig)
    activate(cage)
    before = [
        [(modifier.name, modifier.show_viewport) for modifier in bpy.data.objects[f"Part {index}"].modifiers]
        for index in range(3)
    ]
    found = assert_as_evaluated(cage, seed)
    after = [
        [(modifier.name, modifier.show_viewport) for modifier in bpy.data.objects[f"Part {index}"].modifiers]
        for index in range(3)
    ]
    assert after == before
    assert read_rig(cage) is found


def waving():
    """Layers in a flat lattice, the back one bent in its plane by a modifier above the lattice's."""
    cage, back, front = layered(Matrix())
    other = bpy.data.objects.new("Other", bpy.data.lattices.new("Other"))
    bpy.context.scene.collection.objects.link(other)
    other.data.points_u = other.data.points_v = 3
    other.location, other.scale = (1.0, 0.5, 0.0), (3.0, 2.0, 1.0)
    for point in other.data.points:
        point.co_deform.y += 0.2 * point.co_deform.x**2
    modifier = back.modifiers.new("Other", "LATTICE")
    modifier.object = other
    back.modifiers.move(1, 0)
    activate(cage)
    return cage, back, front, other


def test_pins_are_dragged_from_where_modifiers_above_have_taken_them():
    cage, back, front, other = waving()
    pin_at(front, 0)
    assert bpy.ops.planar.add_pin(location=shown(back, 12).tolist()) == {"FINISHED"}
    assert cage.planar.pins[1].object == back
    start = shown(back, 12)
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.1)) == {"FINISHED"}
    np.testing.assert_allclose(shown(back, 12), start + np.array((0.2, 0.1, 0.0)), atol=6e-3)
    # The stack above is animated on: the next drag starts from there.
    for point in other.data.points:
        point.co_deform.x += 0.1
    other.data.update_tag()
    activate(cage)
    moved = shown(back, 12)
    assert np.linalg.norm(moved - start - np.array((0.2, 0.1, 0.0))) > 0.05
    assert bpy.ops.planar.rotate_pins(angle=0.0) == {"FINISHED"}
    read = read_rig(cage)
    row = int(read.rows_of(back, np.array([12], np.int32))[0])
    places = read.shown(world(cage, coordinates(cage.data.points, "co_deform")))
    np.testing.assert_allclose(places[row], shown(back, 12), atol=1e-5)


def test_what_makes_new_vertices_above_is_refused_and_everything_stays():
    cage, back, _front, _other = waving()
    for kind in ("SUBSURF", "SOLIDIFY", "DECIMATE"):
        modifier = back.modifiers.new(kind, kind)
        back.modifiers.move(len(back.modifiers) - 1, 0)
        bpy.context.view_layer.update()
        with pytest.raises(Refusal, match=f"'{kind}' of 'Back' makes new vertices above 'Lattice'"):
            read_rig(cage)
        back.modifiers.remove(modifier)
    nodes = bpy.data.node_groups.new("Nothing", "GeometryNodeTree")
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes.nodes.new("NodeGroupOutput")
    back.modifiers.new("Nodes", "NODES").node_group = nodes
    back.modifiers.move(len(back.modifiers) - 1, 0)
    bpy.context.view_layer.update()
    with pytest.raises(Refusal, match="above 'Lattice' make new vertices"):
        read_rig(cage)
    assert all(modifier.show_viewport for modifier in back.modifiers)


def test_applied_first_what_stands_above():
    _cage, back, _front, _other = waving()
    with pytest.raises(RuntimeError, match="'Other' of 'Back' stands above"):
        bpy.ops.planar.apply_lattice()
    assert back.data.shape_keys is None


def test_a_mesh_that_reaches_it_as_it_is_is_not_evaluated_for_it():
    cage, back, _ = layered()
    counted = []
    bpy.app.handlers.depsgraph_update_post.append(lambda *_: counted.append(1))
    read_rig(cage)
    bpy.app.handlers.depsgraph_update_post.pop()
    assert not counted
    assert make_object(*grid(2, 2)) != back
