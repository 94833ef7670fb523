# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat meshes laid flat again after their surface has been edited, with pins and poses."""

import bpy
import numpy as np
import pytest
from filling import stale
from support import activate, coordinates, evaluated, in_edit_mode
from surfaces import all_of, flatten, linked, live, pin_at, pushed, refreshed, stretches, tube, uvs


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


@pytest.mark.parametrize("posed", ["", "posed", "keyed"])
def test_refreshed_in_vain_everything_is_as_it_was(posed, monkeypatch):
    from planar_deform.errors import Refusal
    from planar_deform.operators import flatten as operators

    def refuse(*_args, **_options):
        raise Refusal("not now")

    obj = tube()
    flat = live(obj)
    if posed:
        assert bpy.ops.planar.drag_pins(pin=1, offset=(0.4, 0.5)) == {"FINISHED"}
    if posed == "keyed":
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    bpy.context.view_layer.update()
    keys = blocks(flat) if posed == "keyed" else {}
    obj.data.vertices[60].co *= 1.2
    obj.data.update()
    monkeypatch.setattr(operators, "ObjectPosing", refuse)
    monkeypatch.setattr(operators.pushing, "push", refuse)
    before = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="not now"):
        bpy.ops.planar.refresh_from_surface()
    assert all_of(obj, flat) == before
    assert all(np.array_equal(shape, keys[name]) for name, shape in (blocks(flat) if keys else {}).items())


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


def keyed_flat():
    """A tube laid flat, with two poses and what is generated between them."""
    obj = tube()
    flat = flatten(obj)
    pin_at(flat, 0, len(flat.data.vertices) - 1)
    for frame, offset in ((1, (0.0, 0.0)), (9, (0.5, 0.6))):
        bpy.context.scene.frame_set(frame)
        bpy.ops.planar.drag_pins(pin=1, offset=offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    return obj, flat


def blocks(flat):
    return {block.name: coordinates(block.points) for block in flat.data.shape_keys.key_blocks}


def shown_at(flat, frame):
    bpy.context.scene.frame_set(frame)
    return evaluated(flat)


def test_refreshed_in_vain_keyed_poses_are_what_they_were():
    _, flat = keyed_flat()
    before = blocks(flat)
    refreshed(flat)
    for name, shape in blocks(flat).items():
        np.testing.assert_allclose(shape, before[name], atol=1e-4)
    assert stale(flat) == []


def test_refreshed_keyed_poses_and_in_betweens_are_those_of_the_new_shape():
    """Each pose is the new flat mesh, as little distorted as it was, and lies where it lay."""
    obj, flat = keyed_flat()
    before = {frame: shown_at(flat, frame) for frame in (1, 5, 9)}
    places = coordinates(obj.data.vertices)
    places[:, :2] *= 1.2  # the tube gets thicker: wider, laid flat
    obj.data.vertices.foreach_set("co", places.ravel())
    obj.data.update()
    refreshed(flat)
    assert (len(flat.planar.poses), len(flat.planar.pins)) == (2, 2)
    assert stale(flat) == []
    assert np.abs(stretches(obj, flat) - 1.0).max() < 0.02, "the Basis is true to scale"
    for frame, was in before.items():
        now = shown_at(flat, frame)
        np.testing.assert_allclose(now.mean(axis=0), was.mean(axis=0), atol=1e-3)
        lengths = [edge_lengths(flat, shape) for shape in (was, now)]
        assert 1.05 < np.sum(lengths[1]) / np.sum(lengths[0]) < 1.2
        assert np.abs(now[:, 1]).max() < 1e-6
    assert np.abs(shown_at(flat, 9) - shown_at(flat, 1)).max() > 0.3
    # Posed and refreshed once more, all goes on.
    assert bpy.ops.planar.drag_pins(pin=1, offset=(0.1, 0.1)) == {"FINISHED"}
    assert bpy.ops.planar.update_pose() == {"FINISHED"}
    refreshed(flat)


def edge_lengths(flat, shape):
    return [np.linalg.norm(shape[edge.vertices[0]] - shape[edge.vertices[1]]) for edge in flat.data.edges]


def test_an_unkeyed_pose_and_other_shape_keys_are_not_refreshed():
    _, flat = keyed_flat()
    bpy.context.scene.frame_set(4)
    bpy.ops.planar.drag_pins(pin=1, offset=(0.2, 0.1))
    before = blocks(flat)
    with pytest.raises(RuntimeError, match="not keyed: use Key Pose, or change the frame"):
        bpy.ops.planar.refresh_from_surface()
    assert all(np.array_equal(shape, before[name]) for name, shape in blocks(flat).items())
    bpy.ops.planar.clear_poses()
    flat.shape_key_add(name="Basis")
    flat.shape_key_add(name="Smile")
    with pytest.raises(RuntimeError, match="shape keys of its own"):
        bpy.ops.planar.refresh_from_surface()
