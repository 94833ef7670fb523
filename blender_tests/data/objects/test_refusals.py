# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot be posed is refused with a word on what to do, and nothing changes."""

import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, bar, coordinates, grid, make_object


def refusal(obj):
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    points = coordinates(obj.data.vertices) if obj.type == "MESH" else None
    attributes = list(obj.data.attributes.keys()) if obj.type == "MESH" else None
    with pytest.raises(Refusal) as caught:
        begin(bpy.context)
    if points is not None:
        assert np.array_equal(coordinates(obj.data.vertices), points, equal_nan=True)
        assert list(obj.data.attributes.keys()) == attributes
    return str(caught.value)


def test_a_mesh_that_is_not_flat():
    bpy.ops.mesh.primitive_cube_add()
    assert "flatten" in refusal(bpy.context.object)


def test_parts_in_planes_that_are_not_parallel():
    vertices, faces = grid(2, 2)
    turned = vertices[:, [0, 2, 1]] + [0, 0, 3]
    obj = make_object(np.concatenate([vertices, turned]), faces.tolist() + (faces + 9).tolist())
    assert "parallel" in refusal(obj)


@pytest.mark.parametrize(("bump", "refused"), [(0.9e-3, False), (1.2e-3, True)])
def test_flat_means_a_thousandth_of_the_diagonal(bump, refused):
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    vertices, faces = grid(10, 10, 3, 4)
    vertices[60, 2] = bump * 5  # the diagonal is 5
    make_object(vertices, faces.tolist())
    if refused:
        with pytest.raises(Refusal):
            begin(bpy.context)
    else:
        begin(bpy.context)


def test_no_faces_and_no_vertices():
    assert "faces" in refusal(make_object([(0, 0, 0), (1, 0, 0)], [], edges=[(0, 1)]))
    assert "faces" in refusal(make_object([], [], name="Empty"))


def test_faces_without_area():
    assert "area" in refusal(make_object([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))


def test_coordinates_that_are_not_numbers():
    vertices, faces = grid(3, 3)
    vertices[5, 0] = np.inf
    assert "not numbers" in refusal(make_object(vertices, faces.tolist()))


def test_a_scale_of_zero():
    obj = bar()
    obj.scale.x = 0.0
    assert "scale" in refusal(obj)


def test_a_transform_that_is_not_made_of_numbers():
    obj = bar()
    obj.location.x = float("nan")
    assert "Clear" in refusal(obj)


def test_another_type_of_object():
    curve = bpy.data.objects.new("Line", bpy.data.curves.new("Line", "CURVE"))
    bpy.context.scene.collection.objects.link(curve)
    assert "Convert" in refusal(curve)


def test_no_active_object():
    from planar_deform.scene.objects.cutout_object import pose_refusal

    assert "select" in pose_refusal(None)


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "WEIGHT_PAINT"])
def test_other_modes(mode):
    from planar_deform.scene.objects.cutout_object import pose_refusal

    obj = bar()
    bpy.ops.object.mode_set(mode=mode)
    assert "Object Mode" in pose_refusal(obj)
    assert not bpy.ops.planar.add_pin.poll()


def test_a_shared_mesh_but_not_one_with_a_fake_user():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar()
    obj.data.use_fake_user = True
    begin(bpy.context)
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(twin)
    assert "Single User" in refusal(obj)


def test_linked_objects_and_overrides(tmp_path):
    from planar_deform.scene.objects.cutout_object import pose_refusal

    linked = _linked(tmp_path)
    assert "is linked from a library" in pose_refusal(linked)
    assert "Make Local > Selected Objects and Data" in pose_refusal(linked)
    override = linked.override_create()
    bpy.context.scene.collection.objects.link(override)
    for obj in (override, _with_an_override_of_its_mesh(linked)):
        assert "is a library override" in pose_refusal(obj)
        assert "ends the override" in pose_refusal(obj)
    activate(override)
    assert not bpy.ops.planar.reset_to_rest.poll()


@pytest.mark.parametrize("override", [False, True])
def test_what_the_refusal_of_linked_objects_advises_helps(tmp_path, override):
    from planar_deform.scene.objects.cutout_object import pose_refusal

    obj = _linked(tmp_path)
    if override:
        obj = obj.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    activate(obj)
    assert pose_refusal(obj) is not None
    bpy.ops.object.make_local(type="SELECT_OBDATA")
    obj = bpy.context.object
    assert pose_refusal(obj) is None
    add_end_pins(obj)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.2)) == {"FINISHED"}


def _linked(tmp_path):
    """An object linked from a library, in the scene."""
    bar(name="Linked")
    library = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.objects = ["Linked"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    return wanted.objects[0]


def _with_an_override_of_its_mesh(linked):
    obj = bpy.data.objects.new("Local", linked.data.override_create())
    bpy.context.scene.collection.objects.link(obj)
    return obj


def test_operators_say_why_they_do_not_run():
    bar()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Object Mode"):
        bpy.ops.planar.add_pin(location=(0, 0, 0))
    bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RuntimeError, match="No mesh there"):
        bpy.ops.planar.add_pin(location=(9, 9, 0))
    assert len(bpy.context.object.vertex_groups) == 0
    assert len(bpy.context.object.planar.pins) == 0


def test_an_object_that_is_gone_or_replaced_during_an_action_is_noticed():
    from planar_deform.errors import ObjectGone
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar(name="Gone")
    add_end_pins(obj)
    drawing = begin(bpy.context)
    bpy.data.objects.remove(obj)
    with pytest.raises(ObjectGone):
        drawing.write(drawing.positions + 1.0)
    other = bar(name="Gone")  # the same name, another object
    before = coordinates(other.data.vertices)
    with pytest.raises(ObjectGone):
        drawing.write(drawing.positions + 1.0)
    with pytest.raises(ObjectGone):
        drawing.restore()
    assert np.array_equal(coordinates(other.data.vertices), before)
    drawing = begin(bpy.context)
    other.data.vertices.add(1)
    with pytest.raises(ObjectGone):
        drawing.write(drawing.positions)


def test_positions_that_blender_cannot_store_are_refused_and_change_nothing():
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar()
    obj.scale = (1e-6, 1e-6, 1e-6)
    before = coordinates(obj.data.vertices)
    drawing = begin(bpy.context)
    with pytest.raises(Refusal, match="less"):
        drawing.write(drawing.positions + 1e33)
    assert np.array_equal(coordinates(obj.data.vertices), before)
