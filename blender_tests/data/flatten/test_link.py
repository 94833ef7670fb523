# SPDX-License-Identifier: GPL-3.0-or-later
"""What a flat mesh does for its surface: pushed back; kept through files and copies."""

import bpy
import numpy as np
import pytest
from support import activate, coordinates, from_library, in_edit_mode
from surfaces import (
    all_of,
    cap,
    cube,
    flatten,
    linked,
    pin_at,
    pushed,
    refreshed,
    surface_vertices,
    tube,
    uv_ratios,
    uvs,
)

# ---- push


@pytest.mark.parametrize("make", [tube, cap, cube])
def test_pushed_a_flat_mesh_is_the_uv_map_of_its_surface_in_one_scale(make):
    obj = make()
    flat = flatten(obj)
    pushed(flat)
    assert linked(obj, flat)
    assert uvs(obj).min() > -1e-6
    assert uvs(obj).max() < 1.0 + 1e-6
    assert np.ptp(uvs(obj), axis=0).max() > 0.999
    if make is not cap:
        assert np.abs(uv_ratios(obj) / flat.planar.uv_scale - 1.0).max() < 1e-5


def test_a_pose_is_pushed_in_the_scale_of_the_first_push():
    obj = tube()
    flat = flatten(obj)
    pushed(flat)
    before, scale = uvs(obj), flat.planar.uv_scale
    pin_at(flat, 0, len(flat.data.vertices) - 1)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.7, 0.4)) == {"FINISHED"}
    assert np.array_equal(uvs(obj), before), "it is not live"
    pushed(flat)
    assert flat.planar.uv_scale == scale
    assert linked(obj, flat)
    # A turn about the view in Object Mode changes nothing of the drawing.
    flat.rotation_euler = (0.0, 0.5, 0.3)
    now = uvs(obj)
    pushed(flat)
    assert np.array_equal(uvs(obj), now)


def test_edits_of_the_flat_mesh_and_its_keyed_poses_are_pushed():
    obj = tube()
    flat = flatten(obj)
    flat.data.vertices[5].co.x += 0.2
    pushed(flat)
    assert linked(obj, flat)
    flat.shape_key_add(name="Basis")
    key = flat.shape_key_add(name="Bent")
    key.value = 1.0
    key.data[7].co.z += 0.5
    before = uvs(obj)
    pushed(flat)
    moved = np.flatnonzero((uvs(obj) != before).any(axis=1))
    assert {obj.data.loops[int(corner)].vertex_index for corner in moved} == {surface_vertices(flat)[7]}


def test_faces_taken_out_of_the_flat_mesh_leave_their_uvs():
    obj = cube()
    flat = flatten(obj)
    pushed(flat)
    before = uvs(obj)
    in_edit_mode(flat, lambda: bpy.ops.mesh.delete(type="FACE"), select=lambda vertex: vertex.index < 4)
    assert len(flat.data.polygons) == 5
    moved = coordinates(flat.data.vertices)
    moved[:, 0] += 0.3
    flat.data.vertices.foreach_set("co", moved.ravel())
    pushed(flat)
    assert np.count_nonzero((uvs(obj) != before).any(axis=1)) == 20


# ---- files and copies


def test_the_link_is_kept_in_the_file(tmp_path):
    flatten(tube())
    path = str(tmp_path / "linked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj, flat = bpy.data.objects["Tube"], bpy.data.objects["Tube Flat"]
    pushed(flat)
    assert linked(obj, flat)


def test_appended_a_flat_mesh_brings_its_surface(tmp_path):
    flatten(tube())
    path = str(tmp_path / "linked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in ("Tube", "Tube Flat"):
        bpy.ops.wm.append(directory=f"{path}/Object/", filename=name)
    flat = next(obj for obj in bpy.data.objects if obj.name.startswith("Tube Flat"))
    surface = flat.planar.surface
    if not surface.users_scene:  # the second append may have brought another copy of it
        bpy.context.scene.collection.objects.link(surface)
    pushed(flat)
    assert linked(surface, flat)


def test_duplicated_together_the_copies_belong_to_each_other():
    obj = tube()
    flat = flatten(obj)
    pushed(flat)
    before = uvs(obj)
    activate(flat)
    obj.select_set(True)
    bpy.ops.object.duplicate()
    copy = next(o for o in bpy.context.selected_objects if "Flat" in o.name)
    other = next(o for o in bpy.context.selected_objects if "Flat" not in o.name)
    assert copy.planar.surface == other
    copy.data.vertices[5].co.x += 0.2
    pushed(copy)
    assert linked(other, copy)
    assert np.array_equal(uvs(obj), before)


# ---- refusals


def deleted(obj):
    bpy.ops.object.select_all(action="DESELECT")
    activate(obj)
    bpy.ops.object.delete()


def subdivided(obj):
    in_edit_mode(obj, bpy.ops.mesh.subdivide)


def without_a_face(obj):
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.delete(type="ONLY_FACE"),
        select=lambda vertex: vertex.index in {0, 1, 24, 25},
    )


def triangulated(obj):
    in_edit_mode(obj, bpy.ops.mesh.quads_convert_to_tris)


@pytest.mark.parametrize("operator", ["push_to_uv_map", "refresh_from_surface"])
@pytest.mark.parametrize(
    ("do", "message"),
    [
        (deleted, "has been deleted: undo that, or lay the surface flat again"),
        (subdivided, "vertices, not the 168 that"),
        (without_a_face, "undo"),
        (triangulated, "undo"),
    ],
)
def test_a_lost_link_is_refused_with_the_remedy_and_nothing_changes(do, message, operator):
    obj = tube()
    flat = flatten(obj)
    pushed(flat)
    do(obj)
    activate(flat)
    kept = [flat] if do is deleted else [obj, flat]
    before = all_of(*kept)
    with pytest.raises(RuntimeError, match=message):
        getattr(bpy.ops.planar, operator)()
    assert all_of(*kept) == before


def test_parts_added_to_the_flat_mesh_are_refused():
    obj = tube()
    flat = flatten(obj)
    in_edit_mode(flat, bpy.ops.mesh.subdivide)
    activate(flat)
    before = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="undo"):
        bpy.ops.planar.push_to_uv_map()
    assert all_of(obj, flat) == before


def test_an_applied_rotation_is_refused():
    obj = tube()
    flat = flatten(obj)
    flat.rotation_euler.x = 1.0
    activate(flat)
    bpy.ops.object.transform_apply(rotation=True)
    before = all_of(obj, flat)
    for operator in ("push_to_uv_map", "refresh_from_surface"):
        with pytest.raises(RuntimeError, match="XZ plane"):
            getattr(bpy.ops.planar, operator)()
    assert all_of(obj, flat) == before


def test_a_linked_surface_is_laid_flat_but_not_written(tmp_path):
    tube()
    obj = from_library(tmp_path, "Tube")
    flat = flatten(obj)
    with pytest.raises(RuntimeError, match="linked from a library: make it local"):
        bpy.ops.planar.push_to_uv_map()
    refreshed(flat)
    activate(obj)
    with pytest.raises(RuntimeError, match="linked from a library: make it local"):
        bpy.ops.planar.flatten(to="UV")


def test_what_is_no_flat_mesh_is_refused():
    tube()
    for operator in ("push_to_uv_map", "refresh_from_surface"):
        with pytest.raises(RuntimeError, match="no flat mesh of a surface: make one with Flatten"):
            getattr(bpy.ops.planar, operator)()
