# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of edges and poly curves have poses over time like cutouts, whatever plane they lie in."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from outlines import CURVES, MESHES, PLACED, RING, chain, lines
from sequences import History, go_to, key, same, shown_at, stored, timing, write
from support import PLANES, TRANSFORMS, activate, coordinates, evaluated, from_library, make_object


@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize(("kind", "plane"), PLACED)
def test_each_keyed_frame_shows_its_pose_to_the_bit(kind, plane, transform):
    from planar_deform.scene.objects.any_object import begin_shape

    obj = lines(kind, plane)
    obj.matrix_world = TRANSFORMS[transform]
    go_to(1)
    write(obj, 1)
    before = stored(obj)
    shapes = {1: key(obj, 1)}
    shapes |= {frame: key(obj, frame, seed) for seed, frame in ((2, 25), (3, 49), (4, 13))}
    assert len({shape.tobytes() for shape in shapes.values()}) == 4
    for frame, shape in shapes.items():
        assert same(shown_at(obj, frame), shape)
    drawing = begin_shape(bpy.context)
    world = shapes[13].astype(float) @ np.array(obj.matrix_world.to_3x3()).T
    joined = world[drawing.vertex_indices]
    size = np.linalg.norm(np.ptp(joined, axis=0))
    # Posed in the plane alone: only rounding leaves it.
    deep = joined @ drawing.frame.n
    for part in range(drawing.parts.max() + 1):
        assert np.ptp(deep[drawing.parts == part]) < 1e-6 * size
    assert drawing.diagonal == pytest.approx(np.linalg.norm(np.ptp(drawing.rest, axis=0)))
    assert drawing.rest == pytest.approx(drawing.flattened(drawing.rest_coordinates()), abs=1e-6 * size)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(obj) == before


@pytest.fixture(params=("open line", "3D curve"))
def keyed(request):
    """An outline with three poses, and what each of their frames shows."""
    obj = lines(request.param)
    return obj, {frame: key(obj, frame, seed) for seed, frame in ((1, 1), (2, 25), (3, 49))}


def test_a_sequence_on_a_basis_of_the_users_own(keyed):
    obj, _ = keyed
    other = obj.copy()
    other.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(other)
    activate(other)
    other.shape_key_clear()
    other.planar.poses.clear()
    other.shape_key_add(name="Basis")
    other.shape_key_add(name="Pose")
    other.data.shape_keys.key_blocks[1].data[0].co.x += 0.1
    other.data.shape_keys.key_blocks[1].value = 0.5
    other.active_shape_key_index = 1
    before, shown = stored(other), evaluated(other)
    assert np.abs(key(other, 1) - shown).max() < 1e-7  # the shown shape, rounded once
    key(other, 9, 4)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(other) == before


def test_an_unkeyed_pose_is_lost_when_the_frame_changes(keyed):
    from planar_deform.scene.sequence import pose_state

    obj, shapes = keyed
    go_to(13)
    shown = evaluated(obj)
    posed = write(obj, 7)
    assert pose_state.unkeyed(obj)
    assert not same(posed, shown)
    assert same(shown_at(obj, 25), shapes[25])
    assert same(shown_at(obj, 13), shown)


def test_deleting_and_jumping(keyed):
    obj, shapes = keyed
    assert bpy.ops.planar.jump_to_pose(pose=1) == {"FINISHED"}
    assert same(evaluated(obj), shapes[25])
    assert bpy.ops.planar.delete_pose(pose=1) == {"FINISHED"}
    assert len(timing(obj)) == 2
    assert all(same(shown_at(obj, frame), shapes[frame]) for frame in (1, 49))


def test_saved_and_loaded_again(keyed, tmp_path):
    obj, shapes = keyed
    before = stored(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "file.blend"))
    obj = bpy.data.objects["Cutout"]
    assert stored(obj) == before
    shapes[13] = key(obj, 13, 5)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


@pytest.mark.parametrize("kind", ["edge soup", "3D curve"])
def test_undo_and_redo(kind):
    lines(kind)
    history = History()
    history.did(bpy.ops.planar.key_pose())
    go_to(25)
    history.did({"FINISHED"})
    write(bpy.data.objects["Cutout"], 1)
    history.did(bpy.ops.planar.key_pose())
    go_to(13)
    history.did({"FINISHED"})
    history.did(bpy.ops.planar.key_pose())
    history.did(bpy.ops.planar.delete_pose(pose=0))
    history.did(bpy.ops.planar.clear_poses())
    history.undo_all()
    history.redo_all()


def edit(obj, offset):
    """Move all points in Edit Mode."""
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    (bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve).select_all(action="SELECT")
    bpy.ops.transform.translate(value=offset)
    bpy.ops.object.mode_set(mode="OBJECT")


def test_edit_mode_edits_the_pose_of_the_frame(keyed):
    obj, shapes = keyed
    offset = np.array([0.25, 0.5, 0.0], np.float32)  # without rounding
    edit(obj, offset)  # the one keyed last
    shapes[49] = shapes[49] + offset
    assert same(evaluated(obj), shapes[49])
    go_to(1)
    edit(obj, offset)
    shapes[1] = shapes[1] + offset
    assert same(evaluated(obj), shapes[1])
    assert all(np.abs(shown_at(obj, frame) - shape).max() < 1e-6 for frame, shape in shapes.items())
    assert same(shown_at(obj, 25), shapes[25])
    rest = coordinates(obj.data.shape_keys.reference_key.data)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert obj.data.shape_keys is None
    assert np.abs(evaluated(obj) - shapes[1] + offset).max() < 1e-6
    assert rest.shape == shapes[1].shape


def test_edit_mode_between_the_keys_edits_the_pose_that_was_active(keyed):
    obj, shapes = keyed
    go_to(25)
    shown = shown_at(obj, 13)
    edit(obj, (0.0, 0.5, 0.0))
    assert np.abs(evaluated(obj) - shown - [0.0, 0.25, 0.0]).max() < 1e-5  # half-way to the edited pose
    assert np.abs(shown_at(obj, 25) - shapes[25] - [0.0, 0.5, 0.0]).max() < 1e-6


def radii(obj):
    values = np.empty(len(obj.data.shape_keys.key_blocks[0].data), np.float32)
    return [
        (block.name, tuple(np.round(values, 6)))
        for block in obj.data.shape_keys.key_blocks
        if block.data.foreach_get("radius", values) is None
    ]


def test_radius_and_tilt_of_a_curve_are_part_of_its_poses():
    obj = lines("3D curve")
    go_to(1)
    before = stored(obj)
    shapes = {1: key(obj, 1)}
    shapes[25] = key(obj, 25, 2)
    second = obj.data.shape_keys.key_blocks[-1]
    for point in second.data:  # as in Edit Mode
        point.radius, point.tilt = 3.0 * point.radius, 0.5
    drawn = dict(radii(obj))[second.name]
    shapes[13] = key(obj, 13, 3)  # the one behind it is taken out and put back
    assert dict(radii(obj))[obj.planar.poses[2].name] == drawn
    # Half-way between the two: what Blender shows there.
    middle = obj.data.shape_keys.key_blocks[obj.planar.poses[1].name]
    assert middle.data[3].radius == pytest.approx(1.3 * 2.0, rel=1e-5)
    assert middle.data[3].tilt == pytest.approx((0.15 + 0.5) / 2.0, rel=1e-5)
    go_to(7)
    write(obj, 4)
    scratch = obj.data.shape_keys.key_blocks[-1]
    assert scratch.data[3].radius == pytest.approx(1.3 * 1.5, rel=1e-5)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(obj) == before


def refusal(obj):
    """Why it cannot be keyed; nothing has changed."""
    from planar_deform.errors import Refusal
    from planar_deform.scene.objects.any_object import read_shape, shape_refusal

    activate(obj)
    reason = shape_refusal(obj)
    if reason is not None:
        assert not bpy.ops.planar.key_pose.poll()
        return reason
    with pytest.raises(Refusal) as caught:
        read_shape(obj)
    with pytest.raises(RuntimeError, match="planes|numbers|scale"):
        bpy.ops.planar.key_pose()
    assert obj.data.shape_keys is None
    return str(caught.value)


def test_splines_that_are_not_lines():
    for kind in ("BEZIER", "NURBS"):
        obj = lines("3D curve", name=kind)
        obj.data.splines.new(kind)
        assert "Set Spline Type > Poly" in refusal(obj)


def test_nothing_to_key():
    assert "no edges" in refusal(make_object([(0, 0, 0), (1, 0, 0)], []))
    curve = bpy.data.objects.new("Empty", bpy.data.curves.new("Empty", "CURVE"))
    bpy.context.scene.collection.objects.link(curve)
    assert "no lines" in refusal(curve)
    curve.data.splines.new("POLY")  # of one point
    assert "no lines" in refusal(curve)
    empty = bpy.data.objects.new("Null", None)
    bpy.context.scene.collection.objects.link(empty)
    assert "Convert" in refusal(empty)


@pytest.mark.parametrize("kind", MESHES[:2] + CURVES[1:])
def test_lines_that_are_not_flat(kind):
    obj = lines(kind)
    points = obj.data.vertices if obj.type == "MESH" else obj.data.splines[0].points
    points[2].co[2] += 0.1
    assert "parallel planes" in refusal(obj)


@pytest.mark.parametrize("kind", MESHES[:1] + CURVES[1:])
def test_coordinates_that_are_not_numbers_and_a_scale_of_zero(kind):
    obj = lines(kind)
    obj.scale.x = 0.0
    assert "scale" in refusal(obj)
    obj.scale.x = 1.0
    points = obj.data.vertices if obj.type == "MESH" else obj.data.splines[0].points
    points[2].co[1] = np.nan
    assert "not numbers" in refusal(obj)


@pytest.mark.parametrize("kind", MESHES[:1] + CURVES[1:])
def test_shared_linked_and_edited_data(kind, tmp_path):
    obj = lines(kind)
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    assert "Make Single User" in refusal(obj)
    bpy.data.objects.remove(twin)
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.planar.key_pose.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    shapes = {frame: key(obj, frame, seed) for seed, frame in ((1, 1), (2, 25))}
    obj = from_library(tmp_path)
    assert "Make Local" in refusal(obj)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


def test_pins_say_that_they_need_faces():
    from planar_deform.scene.objects.cutout_object import pose_refusal

    for kind in ("open line", "3D curve"):
        assert "faces" in pose_refusal(lines(kind, name=kind))
        assert not bpy.ops.planar.add_pin.poll()
        assert bpy.ops.planar.key_pose.poll()


def test_a_straight_line_lies_in_the_plane_of_its_other_shapes():
    from planar_deform.scene.objects.any_object import begin_shape

    stick = [(0.3 * i, 0.0, 0.0) for i in range(5)]
    obj = make_object(stick, [], chain(5))
    drawing = begin_shape(bpy.context)
    assert drawing.frame.letters == ("X", "Y")
    assert drawing.diagonal == pytest.approx(1.2)
    key(obj, 1)
    key(obj, 9)
    obj.data.shape_keys.key_blocks[-1].data[2].co.z = 0.2  # bent in XZ
    assert begin_shape(bpy.context).frame.letters == ("X", "Z")
    go_to(1)
    assert begin_shape(bpy.context).frame.letters == ("X", "Z")
    for axis, letters in ((0, ("X", "Y")), (1, ("X", "Y")), (2, ("X", "Z"))):
        stick = np.zeros((5, 3))
        stick[:, axis] = np.arange(5)
        make_object(stick, [], chain(5), name=f"Along {axis}")
        assert begin_shape(bpy.context).frame.letters == letters
    fence = [(0.3 * i, 0.0, z) for i in range(4) for z in (0.0, 1.0)]
    make_object(fence, [], [(i, i + 1) for i in range(0, 8, 2)], name="Fence")  # straight, but side by side
    assert begin_shape(bpy.context).frame.letters == ("X", "Z")


@pytest.mark.parametrize("turn", [PLANES["tilted"], np.array(Matrix.Rotation(np.pi / 4, 3, "X"))])
def test_axes_do_not_depend_on_the_order_or_the_place_of_points(turn):
    from planar_deform.scene.objects.any_object import begin_shape

    rng = np.random.default_rng(5)
    frames = []
    for step in range(6):
        order = rng.permutation(len(RING))
        turned = np.array(RING)[order] @ turn.T + step
        place = np.argsort(order)
        make_object(
            turned, [], [(place[a], place[b]) for a, b in chain(12, closed=True)], name=f"Ring {step}"
        )
        frames.append(begin_shape(bpy.context).frame)
    for frame in frames[1:]:
        assert np.abs(np.stack([frame.u, frame.v]) - [frames[0].u, frames[0].v]).max() < 1e-5


def test_curves_joined_to_a_sequence_are_refused():
    """Blender leaves the shape keys as they were, too short for the points there are now."""
    obj = lines("3D curve")
    key(obj, 1, 1)
    key(obj, 25, 2)
    other = lines("3D curve", name="Other")
    activate(obj)
    other.select_set(True)
    bpy.ops.object.join()
    before = stored(obj)
    for operator in (bpy.ops.planar.key_pose, bpy.ops.planar.clear_poses):
        with pytest.raises(RuntimeError, match="joining curves"):
            operator()
        assert stored(obj) == before


@pytest.mark.parametrize("kind", ["open line", "3D curve"])
def test_points_added_and_deleted_in_edit_mode(kind):
    obj = lines(kind)
    shapes = {frame: key(obj, frame, seed) for seed, frame in ((1, 1), (2, 25), (3, 49))}
    first = coordinates(obj.data.shape_keys.key_blocks["Before Poses"].data)
    edits = bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve
    bpy.ops.object.mode_set(mode="EDIT")
    edits.select_all(action="SELECT")
    edits.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    count = len(evaluated(obj))
    assert count > len(first)
    shown = {frame: shown_at(obj, frame) for frame in shapes}
    assert all({*map(tuple, shapes[frame])} <= {*map(tuple, shape)} for frame, shape in shown.items())
    shown[13] = key(obj, 13, 4)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shown.items())
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert len(evaluated(obj)) == count
    assert {*map(tuple, first)} <= {*map(tuple, evaluated(obj))}


def test_faces_made_and_deleted_during_a_sequence():
    obj = lines("closed line")
    shapes = {frame: key(obj, frame, seed) for seed, frame in ((1, 1), (2, 25))}
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.edge_face_add()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(obj.data.polygons) == 1
    shapes[13] = key(obj, 13, 3)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.delete(type="ONLY_FACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    shapes[37] = key(obj, 37, 4)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
