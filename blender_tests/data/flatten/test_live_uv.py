# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface's UV map that follows its flat mesh."""

import bpy
import numpy as np
import pytest
from support import coordinates
from surfaces import all_of, flatten, linked, live, tube, uvs


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
    from planar_deform.operators.modal.several_posing import begin

    obj = tube()
    flat = live(obj)
    layer = obj.data.uv_layers.active
    layer.uv[7].vector = (0.123, 0.456)  # edited by hand meanwhile
    before = all_of(obj, flat)
    posing = begin(bpy.context, 1, model=Posing)
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
