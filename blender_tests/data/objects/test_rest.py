# SPDX-License-Identifier: GPL-3.0-or-later
"""The rest shape of a mesh without shape keys: kept through poses, completed after edits."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from support import (
    activate,
    add_end_pins,
    add_pins,
    bar,
    coordinates,
    evaluated,
    grid,
    in_edit_mode,
    make_object,
    measured,
    pose,
)


def stored_rest(obj):
    return coordinates(obj.data.attributes["planar_rest"].data, "vector")


def solved_rest(obj):
    """The rest shape as the solver gets it, in the plane of the shown shape (n x 2)."""
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    return begin(bpy.context).cutout.rest


def posed_bar(plane="XY"):
    obj = bar(plane=plane)
    add_end_pins(obj)
    pose(obj, offset=(-0.2, 0.6))
    return obj


def test_the_first_pin_stores_the_rest_and_posing_never_changes_it():
    obj = bar()
    assert "planar_rest" not in obj.data.attributes
    before = coordinates(obj.data.vertices)
    assert bpy.ops.planar.add_pin(location=(0, 0, 0)) == {"FINISHED"}
    attribute = obj.data.attributes["planar_rest"]
    assert (attribute.data_type, attribute.domain) == ("FLOAT_VECTOR", "POINT")
    assert np.array_equal(stored_rest(obj), before)
    bits = stored_rest(obj).tobytes()
    add_pins(obj, [64])
    pose(obj, offset=(0.0, 0.5))
    pose(obj, offset=(0.3, -0.9))
    add_pins(obj, [12])
    assert stored_rest(obj).tobytes() == bits


def test_reset_brings_the_rest_back_to_the_bit_and_the_pins_with_it():
    obj = bar(plane="tilted")
    before = coordinates(obj.data.vertices)
    add_end_pins(obj, kind="PATCH")
    pose(obj, offset=(0.0, 0.5), angle=0.4)
    assert obj.planar.pins[1].angle == pytest.approx(0.4)
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert np.array_equal(coordinates(obj.data.vertices), before)
    assert np.array_equal(evaluated(obj), before)
    assert obj.planar.pins[1].angle == 0.0
    assert not any(pin.has_target for pin in obj.planar.pins)
    assert (measured(obj).area, measured(obj).flipped) == (pytest.approx(2.0), 0)


def test_set_rest_to_current_makes_the_pose_the_rest():
    obj = posed_bar()
    now = coordinates(obj.data.vertices)
    assert measured(obj).area > 2.001
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}
    assert np.array_equal(coordinates(obj.data.vertices), now)
    assert np.array_equal(stored_rest(obj), now)
    assert measured(obj).area == pytest.approx(2.0)
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(coordinates(obj.data.vertices), now)


def test_set_rest_to_current_helps_a_rest_shape_that_cannot_be_used():
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.cutout_object import begin

    obj = posed_bar()
    bent = stored_rest(obj)
    bent[::2, 2] += 0.5
    obj.data.attributes["planar_rest"].data.foreach_set("vector", bent.ravel())
    with pytest.raises(Refusal, match="Set as Rest"):
        begin(bpy.context)
    with pytest.raises(RuntimeError, match="Set as Rest"):
        bpy.ops.planar.reset_to_rest()
    bpy.ops.planar.set_rest_to_current()
    begin(bpy.context)


def test_an_attribute_of_that_name_and_another_type_is_replaced():
    obj = bar()
    obj.data.attributes.new("planar_rest", "FLOAT", "FACE")
    add_end_pins(obj)
    assert np.array_equal(stored_rest(obj), coordinates(obj.data.vertices))


@pytest.mark.parametrize("plane", ["XY", "tilted"])
def test_subdivided_faces_rest_where_blender_interpolates_them(plane):
    obj = posed_bar(plane)
    in_edit_mode(obj, bpy.ops.mesh.subdivide, select=lambda vertex: True)
    plain = bar(plane=plane, nx=24, ny=8, name="Plain")
    rest, expected = stored_rest(obj), coordinates(plain.data.vertices)
    gaps = np.linalg.norm(rest[:, None] - expected[None], axis=2)
    assert gaps.min(axis=1).max() < 1e-6  # every vertex rests on the finer undeformed grid
    assert np.unique(gaps.argmin(axis=1)).size == len(expected)
    assert pose(obj, offset=(0.0, 0.1))[1].solved().report.flipped == 0
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(coordinates(obj.data.vertices), rest)


@pytest.mark.parametrize(
    ("tool", "options"),
    [
        ("inset", {"thickness": 0.02}),
        ("poke", {}),
        ("bevel", {"offset": 0.01}),
        ("quads_convert_to_tris", {}),
        ("edge_split", {}),
        ("dissolve_faces", {}),
    ],
)
def test_edits_of_a_posed_mesh_keep_a_rest_without_flips(tool, options):
    obj = posed_bar()
    in_edit_mode(
        obj, lambda: getattr(bpy.ops.mesh, tool)(**options), select=lambda vertex: 18 <= vertex.index <= 46
    )
    pose(obj, offset=(0.0, 0.05))
    assert measured(obj).flipped == 0
    assert measured(obj).area < 2.5


@pytest.mark.parametrize("plane", ["XY", "tilted"])
def test_extruded_vertices_rest_as_a_continuation_not_on_their_source(plane):
    """Blender gives extruded vertices their source's rest, which would make faces of no area."""
    obj = bar(plane=plane)
    add_end_pins(obj)
    pose(obj, offset=(-0.5, 0.8))
    before = stored_rest(obj)
    points = coordinates(obj.data.vertices)
    right = [12 + 13 * row for row in range(5)]
    across = points[right[-1]] - points[right[0]]
    from planar_deform.scene.objects.cutout_object import begin

    normal = begin(bpy.context).frame.n
    outward = np.cross(across, normal)
    outward *= 0.25 / np.linalg.norm(outward)
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": outward.tolist()}),
        select=lambda vertex: vertex.index in right,
    )
    assert len(obj.data.vertices) == 70
    assert np.array_equal(stored_rest(obj)[65:], before[right])  # the trap
    rest = solved_rest(obj)
    old = begin(bpy.context).from_local(before.astype(float))
    assert rest[:65] == pytest.approx(old, abs=1e-6)
    # The new column continues the bar to the right of x = 2 at 0.25, about as high as it is.
    inward = old[right] - old[[row - 1 for row in right]]
    along = inward / np.linalg.norm(inward, axis=1)[:, None]
    assert ((rest[65:] - old[right]) * along).sum(axis=1) == pytest.approx(0.25, abs=0.08)
    # The next posing keeps it, so that it no longer depends on the pose.
    pose(obj, offset=(0.0, 0.1))
    kept = stored_rest(obj)
    assert np.array_equal(kept[:65], before)
    assert begin(bpy.context).from_local(kept.astype(float)) == pytest.approx(rest, abs=1e-5)
    pose(obj, offset=(0.0, -0.3))
    assert np.array_equal(stored_rest(obj), kept)
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(coordinates(obj.data.vertices), kept)


def test_restore_also_takes_back_a_completed_rest():
    from planar_deform.scene.objects.cutout_object import begin

    obj = posed_bar()
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.0, 0.3, 0.0)}),
        select=lambda vertex: vertex.index >= 60,
    )
    before, points = stored_rest(obj), coordinates(obj.data.vertices)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions + 0.1)
    assert not np.array_equal(stored_rest(obj), before)
    drawing.restore()
    assert np.array_equal(stored_rest(obj), before)
    assert np.array_equal(coordinates(obj.data.vertices), points)


def test_a_part_added_in_edit_mode_rests_where_it_is():
    """New primitives get a rest of zeros, which would put all their vertices on one point."""
    obj = posed_bar()
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.primitive_plane_add(size=1, location=(5, 0, 0)),
        select=lambda vertex: False,
    )
    new = coordinates(obj.data.vertices)[65:]
    assert not stored_rest(obj)[65:].any()
    pose(obj, offset=(0.0, 0.1))
    assert np.array_equal(stored_rest(obj)[65:], new)
    assert np.array_equal(coordinates(obj.data.vertices)[65:], new)


def test_a_vertex_at_the_origin_is_not_mistaken_for_one_without_a_rest():
    obj = bar()
    add_end_pins(obj)
    bits = stored_rest(obj).tobytes()
    pose(obj, offset=(0.4, 0.4), moving=[0])  # moves the vertex that rests at (0, 0, 0)
    pose(obj, offset=(0.0, 0.1))
    assert stored_rest(obj).tobytes() == bits
    assert tuple(stored_rest(obj)[0]) == (0.0, 0.0, 0.0)


def test_a_duplicated_part_rests_beside_its_original():
    obj = posed_bar()
    shown = coordinates(obj.data.vertices)
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.duplicate_move(TRANSFORM_OT_translate={"value": (5.0, 1.0, 0.0)}),
        select=lambda vertex: True,
    )
    rest = solved_rest(obj)
    assert len(rest) == 130
    assert np.linalg.norm(rest[65:].mean(axis=0) - shown[:, :2].mean(axis=0) - (5.0, 1.0)) < 1e-3
    # Its own shape is that of the original.
    sides = [np.linalg.norm(np.diff(part, axis=0), axis=1) for part in (rest[:65], rest[65:])]
    assert sides[0] == pytest.approx(sides[1], abs=1e-6)


@pytest.mark.parametrize("pinned", [True, False])
def test_a_joined_object_rests_in_its_place_scale_and_turn(pinned):
    obj = posed_bar()
    before = stored_rest(obj)
    turned = Matrix.LocRotScale((4, 1, 0), Matrix.Rotation(np.pi / 2, 3, "X").to_quaternion(), (3, 3, 3))
    vertices, faces = grid(6, 3)
    other = make_object(vertices[:, [0, 2, 1]] * [1, 1, -1], faces.tolist(), name="Other")
    other.matrix_world = turned
    if pinned:
        add_pins(other, [0])
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.join()
    joined = coordinates(obj.data.vertices)[65:]
    assert np.ptp(joined[:, 0]) == pytest.approx(6.0, abs=1e-5)
    pose(obj, offset=(0.0, 0.1))
    assert np.array_equal(stored_rest(obj)[:65], before)
    assert stored_rest(obj)[65:] == pytest.approx(joined, abs=1e-5)
    assert measured(obj).flipped == 0
    # No pin is on the joined part, so it has not moved.
    assert np.array_equal(coordinates(obj.data.vertices)[65:], joined)


def test_deleting_and_merging_vertices_keeps_the_rest_of_the_others():
    obj = posed_bar()
    before = stored_rest(obj)
    in_edit_mode(
        obj, lambda: bpy.ops.mesh.delete(type="VERT"), select=lambda vertex: vertex.index in (0, 1, 30)
    )
    keep = np.setdiff1d(np.arange(65), [0, 1, 30])
    assert np.array_equal(stored_rest(obj), before[keep])
    pose(obj, offset=(0.0, 0.1))
    assert np.array_equal(stored_rest(obj), before[keep])


def test_a_drawing_turned_over_since_is_not_taken_for_flipped():
    obj = posed_bar()
    obj.data.transform(Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)))
    pose(obj, offset=(0.0, 0.1))
    assert measured(obj).flipped == 0
    assert measured(obj).area < 2.2


def test_a_drawing_stood_up_since_is_posed_in_its_new_plane():
    obj = posed_bar()
    obj.data.transform(Matrix.Rotation(np.pi / 2, 4, "X"))
    drawing, _ = pose(obj, offset=(0.0, 0.1))
    assert drawing.frame.letters == ("X", "Z")
    assert measured(obj).flipped == 0
    assert measured(obj).area < 2.2


def test_a_rest_is_stored_by_the_first_action_where_shape_keys_that_held_it_are_gone():
    obj = bar()
    obj.shape_key_add(name="Basis")
    add_end_pins(obj)
    assert "planar_rest" not in obj.data.attributes
    obj.shape_key_clear()
    before = coordinates(obj.data.vertices)
    from planar_deform.scene.objects.cutout_object import begin

    drawing = begin(bpy.context)
    drawing.write(drawing.positions + 0.5)
    assert np.array_equal(stored_rest(obj), before)
    drawing.restore()
    assert "planar_rest" not in obj.data.attributes
    pose(obj, offset=(-0.6, 0.9))
    assert np.array_equal(stored_rest(obj), before)
    assert measured(obj).area > 2.001
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(coordinates(obj.data.vertices), before)


def test_parts_added_to_a_drawing_that_was_turned_over_and_lifted_keep_their_depth():
    obj = posed_bar()
    obj.data.transform(Matrix.Translation((0, 0, 2)) @ Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)))
    in_edit_mode(
        obj,
        lambda: bpy.ops.mesh.primitive_plane_add(size=1, location=(5, 0, 3)),
        select=lambda vertex: False,
    )
    pose(obj, offset=(0.0, 0.1))
    assert stored_rest(obj)[65:, 2] == pytest.approx(np.full(4, 3.0))
