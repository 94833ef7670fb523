# SPDX-License-Identifier: GPL-3.0-or-later
"""What a flat mesh can do for its surface: pushed back, live, refreshed; kept through files and copies."""

import bpy
import numpy as np
import pytest
from support import activate, coordinates, in_edit_mode, world
from surfaces import all_of, cap, cube, flatten, numbers, stretches, surface_vertices, tube, uv_ratios, uvs


def pushed(flat):
    activate(flat)
    assert bpy.ops.planar.push_to_uv_map() == {"FINISHED"}


def pin_at(flat, *vertices):
    activate(flat)
    for vertex in vertices:
        assert bpy.ops.planar.add_pin(location=world(flat)[vertex].tolist()) == {"FINISHED"}


def linked(obj, flat):
    """Whether each corner of the surface has its flat mesh's place, in one scale."""
    places = coordinates(flat.data.vertices)[:, [0, 2]]
    corners = numbers(flat.data, "planar_surface_corner") - 1
    of_flat = np.array([loop.vertex_index for loop in flat.data.loops])
    expected = places[of_flat] * flat.planar.uv_scale + np.array(flat.planar.uv_offset)
    return np.abs(uvs(obj)[corners] - expected).max() < 1e-6


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


# ---- live


def live(obj):
    flat = flatten(obj)
    flat.planar.live_uv = True
    pin_at(flat, 0, len(flat.data.vertices) - 1)
    return flat


def test_live_the_map_is_pushed_when_it_is_turned_on_and_follows_pins():
    obj = tube()
    flat = live(obj)
    assert linked(obj, flat)
    before = uvs(obj)
    for offset in ((0.4, 0.1), (0.0, 0.6)):
        assert bpy.ops.planar.drag_pins(pin=1, offset=offset) == {"FINISHED"}
        assert linked(obj, flat)
    assert np.abs(uvs(obj) - before).max() > 0.1
    flat.planar.live_uv = False
    before = uvs(obj)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.1)) == {"FINISHED"}
    assert np.array_equal(uvs(obj), before)


def test_a_drag_taken_back_gives_the_map_back_to_the_bit():
    from planar_deform.model.posing.posing import Posing
    from planar_deform.operators.modal.object_posing import ObjectPosing

    obj = tube()
    flat = live(obj)
    layer = obj.data.uv_layers.active
    layer.uv[7].vector = (0.123, 0.456)  # edited by hand meanwhile
    before = all_of(obj, flat)
    posing = ObjectPosing(bpy.context, 1, model=Posing)
    posing.solve([(0.4, 0.3, 0.0)], posing.show)
    assert all_of(obj, flat) != before
    assert linked(obj, flat)
    posing.cancel()
    assert all_of(obj, flat) == before


def test_live_a_drag_goes_on_where_the_surface_is_lost_and_tells_so(capfd):
    obj = tube()
    flat = live(obj)
    bpy.data.objects.remove(obj)
    before = coordinates(flat.data.vertices)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.1)) == {"FINISHED"}
    assert np.abs(coordinates(flat.data.vertices) - before).max() > 0.1
    assert "The UV map did not follow: The surface of" in capfd.readouterr().out


def edited(flat):
    places = coordinates(flat.data.vertices)
    places[5] += (0.2, 0.0, 0.1)
    flat.data.vertices.foreach_set("co", places.ravel())
    flat.data.update()


def bent(flat):
    modifier = flat.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "BEND", "Y"


CHANGES = {
    "reset": lambda flat: bpy.ops.planar.reset_to_rest(),
    "reset pins": lambda flat: bpy.ops.planar.reset_selected_pins(),
    "mirror": lambda flat: bpy.ops.planar.mirror_pose(),
    "edit": edited,
    "modifier": bent,
}


@pytest.mark.parametrize("change", CHANGES)
def test_live_the_map_follows_whatever_changes_the_flat_mesh(change):
    obj = tube()
    flat = live(obj)
    bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5))
    before = uvs(obj)
    CHANGES[change](flat)
    bpy.context.view_layer.update()
    assert np.abs(uvs(obj) - before).max() > 0.01
    assert flat.planar.live_uv
    assert linked(obj, flat) or change == "modifier"


def test_live_the_map_follows_a_pasted_pose():
    obj = tube()
    flat = live(obj)
    bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5))
    posed = uvs(obj)
    bpy.ops.planar.copy_pose()
    bpy.ops.planar.reset_to_rest()
    bpy.context.view_layer.update()
    assert np.abs(uvs(obj) - posed).max() > 0.1
    bpy.ops.planar.paste_pose()
    bpy.context.view_layer.update()
    assert np.abs(uvs(obj) - posed).max() < 1e-5
    assert linked(obj, flat)


def test_live_the_map_follows_the_frames():
    obj = tube()
    live(obj)
    shown = {}
    for frame, offset in ((1, (0.0, 0.0)), (11, (0.4, 0.5))):
        bpy.context.scene.frame_set(frame)
        bpy.ops.planar.drag_pins(pin=1, offset=offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
        shown[frame] = uvs(obj)
    assert np.abs(shown[11] - shown[1]).max() > 0.1
    for frame in (1, 11, 1):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(uvs(obj), shown[frame], atol=1e-6)
    bpy.context.scene.frame_set(6)
    middle = uvs(obj)
    assert 0.0 < np.abs(middle - shown[1]).max() < np.abs(shown[11] - shown[1]).max()


def test_live_what_has_been_pushed_leaves_the_map_to_be_edited():
    obj = tube()
    flat = live(obj)
    bpy.context.view_layer.update()
    obj.data.uv_layers.active.uv[7].vector = (0.123, 0.456)
    kept = uvs(obj)
    flat.data.update()  # it is evaluated anew, as the same shape
    flat.location.x += 1.0
    bpy.context.view_layer.update()
    assert np.array_equal(uvs(obj), kept)


def test_live_undone_and_redone_the_map_goes_with_the_flat_mesh():
    obj = tube()
    flat = live(obj)
    bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5))
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.planar.reset_to_rest()
    bpy.ops.ed.undo_push(message="Reset")  # before Blender evaluates it, as in the window
    bpy.context.view_layer.update()
    flat.planar.pins[0].name = "Renamed"
    bpy.ops.ed.undo_push(message="Rename")
    for step in (bpy.ops.ed.undo, bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.redo):
        step()
        bpy.context.view_layer.update()
        assert linked(bpy.data.objects["Tube"], bpy.data.objects["Tube Flat"])


def test_live_goes_off_where_it_cannot_follow_and_tells_why(capfd):
    obj = tube()
    flat = live(obj)
    bpy.data.objects.remove(obj)
    edited(flat)
    bpy.context.view_layer.update()
    assert not flat.planar.live_uv
    assert "has been deleted" in capfd.readouterr().out


def test_live_is_not_turned_on_where_there_is_no_surface(capfd):
    obj = tube()
    flat = flatten(obj)
    bpy.data.objects.remove(obj)
    flat.planar.live_uv = True
    assert not flat.planar.live_uv
    assert "has been deleted" in capfd.readouterr().out


# ---- refresh


def refreshed(flat, **options):
    activate(flat)
    assert bpy.ops.planar.refresh_from_surface(**options) == {"FINISHED"}


def test_refreshed_the_flat_mesh_is_that_of_the_edited_surface_where_it_lay():
    obj = tube()
    flat = flatten(obj)
    pin_at(flat, 0, 70)
    pins = [(pin.name, pin.group) for pin in flat.planar.pins]
    middle = coordinates(flat.data.vertices).mean(axis=0)
    for vertex in obj.data.vertices:
        vertex.co.z *= 1.5
    obj.data.update()
    refreshed(flat)
    assert np.abs(stretches(obj, flat) - 1.0).max() < 2e-6
    assert np.abs(coordinates(flat.data.vertices).mean(axis=0) - middle).max() < 1e-5
    assert [(pin.name, pin.group) for pin in flat.planar.pins] == pins
    before = coordinates(flat.data.vertices)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.3, 0.0)) == {"FINISHED"}
    moved = coordinates(flat.data.vertices) - before
    assert np.abs(moved[70] - (0.3, 0.0, 0.0)).max() < 1e-2
    assert np.abs(moved[0]).max() < 1e-2


def test_refreshed_in_a_pose_the_pins_stay_where_they_hold_it():
    obj = tube()
    flat = flatten(obj)
    last = len(flat.data.vertices) - 1
    pin_at(flat, 0, last)
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5)) == {"FINISHED"}
    before = coordinates(flat.data.vertices)
    for vertex in obj.data.vertices:
        vertex.co.z *= 1.2
    obj.data.update()
    refreshed(flat)
    after = coordinates(flat.data.vertices)
    assert np.abs(after - before)[[0, last]].max() < 1e-2
    assert np.abs(after - before).max() > 0.02
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert np.abs(stretches(obj, flat) - 1.0).max() < 2e-6


@pytest.mark.parametrize("posed", [False, True])
def test_refreshed_in_vain_everything_is_as_it_was(posed, monkeypatch):
    from planar_deform.errors import Refusal
    from planar_deform.operators import flatten as operators

    def refuse(*_args, **_options):
        raise Refusal("not now")

    obj = tube()
    flat = live(obj)
    if posed:
        assert bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5)) == {"FINISHED"}
    obj.data.vertices[60].co *= 1.2
    obj.data.update()
    monkeypatch.setattr(operators, "ObjectPosing", refuse)
    monkeypatch.setattr(operators.pushing, "push", refuse)
    before = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="not now"):
        bpy.ops.planar.refresh_from_surface()
    assert all_of(obj, flat) == before


def test_refreshed_live_the_map_follows():
    obj = tube()
    flat = live(obj)
    obj.data.vertices[60].co *= 1.2
    obj.data.update()
    before = uvs(obj)
    refreshed(flat)
    assert linked(obj, flat)
    assert np.abs(uvs(obj) - before).max() > 1e-3


def test_faces_numbered_anew_are_found_by_their_vertices():
    obj = tube()
    flat = flatten(obj)
    pushed(flat)
    before = {(loop.vertex_index, tuple(uv)) for loop, uv in zip(obj.data.loops, uvs(obj), strict=True)}
    in_edit_mode(
        obj, lambda: bpy.ops.mesh.sort_elements(type="REVERSE", elements={"FACE"}), select=lambda vertex: True
    )
    obj.data.uv_layers.active.uv.foreach_set("vector", np.zeros(2 * len(obj.data.loops), np.float32))
    activate(flat)
    kept = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="use Refresh from Surface"):
        bpy.ops.planar.push_to_uv_map()
    assert all_of(obj, flat) == kept
    refreshed(flat)
    pushed(flat)
    after = {(loop.vertex_index, tuple(uv)) for loop, uv in zip(obj.data.loops, uvs(obj), strict=True)}
    assert [vertex for vertex, _ in sorted(after)] == [vertex for vertex, _ in sorted(before)]
    assert np.abs(np.array([uv for _, uv in sorted(after)]) - [uv for _, uv in sorted(before)]).max() < 1e-5


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


def test_keyed_poses_are_not_refreshed():
    obj = tube()
    flat = flatten(obj)
    pin_at(flat, 0)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    before = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="Clear Poses"):
        bpy.ops.planar.refresh_from_surface()
    assert all_of(obj, flat) == before


def test_a_linked_surface_is_laid_flat_but_not_written(tmp_path):
    tube()
    path = str(tmp_path / "surface.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.link(directory=f"{path}/Object/", filename="Tube")
    obj = bpy.data.objects["Tube"]
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
