# SPDX-License-Identifier: GPL-3.0-or-later
"""Any flat mesh can be posed, in any orientation, under any transform; what is not posed keeps its bits."""

import bpy
import numpy as np
import pytest
from support import (
    PLANES,
    TRANSFORMS,
    activate,
    add_end_pins,
    add_pins,
    bar,
    coordinates,
    evaluated,
    grid,
    make_object,
    measured,
    pose,
    world,
)


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("transform", TRANSFORMS)
def test_a_pose_stays_in_the_plane_and_moves_the_pin_in_world_lengths(plane, transform):
    obj = bar(plane=plane)
    if transform == "sheared":  # an object's own transform has no shear: it comes from a parent
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        obj.parent = parent
        obj.matrix_parent_inverse = TRANSFORMS[transform]
    else:
        obj.matrix_world = TRANSFORMS[transform]
    add_end_pins(obj)
    bpy.context.view_layer.update()
    before = world(obj)
    size = float(np.linalg.norm(np.ptp(before, axis=0)))
    drawing, posing = pose(obj, offset=(0.0, 0.3 * size))
    after = world(obj)
    depth = (after - before) @ drawing.frame.n
    # float32 coordinates: their rounding seen in the world, plus the distance from the origin.
    rounding = 4e-7 * (size + np.abs(after).max())
    assert np.abs(depth).max() < rounding
    held = [element.index for element in obj.data.vertices if any(g.group == 1 for g in element.groups)]
    moved = (after - before)[held].mean(axis=0)
    # A soft pin reaches its target nearly; stretched, the bar is higher than wide and resists the most.
    assert moved @ drawing.frame.v == pytest.approx(0.3 * size, rel=0.15)
    assert moved @ drawing.frame.u == pytest.approx(0.0, abs=0.05 * size)
    assert posing.solved().report.flipped == 0


@pytest.mark.parametrize("transform", ["rotated", "mirrored", "sheared"])
def test_the_pose_depends_on_the_shape_in_the_world_only(transform):
    """A bar posed under a transform looks like the same bar made in the world and posed there."""
    matrix = TRANSFORMS[transform]
    plain = bar(triangles=True, name="Plain")
    plain.data.transform(matrix)
    moved = bar(triangles=True, name="Moved")
    if transform == "sheared":
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        moved.parent = parent
        moved.matrix_parent_inverse = matrix
    else:
        moved.matrix_world = matrix
    results = []
    for obj in (plain, moved):
        activate(obj)
        add_end_pins(obj)
        from planar_deform.scene.objects.cutout_object import begin

        frame = begin(bpy.context).frame
        wish = np.array([0.2, 0.5, -0.3])  # the same direction in the world for both
        pose(obj, offset=(wish @ frame.u, wish @ frame.v))
        results.append(world(obj))
    size = np.linalg.norm(np.ptp(results[0], axis=0))
    assert np.abs(results[0] - results[1]).max() < 2e-5 * size  # float32 in, float32 out


def test_locks_are_named_after_the_object_axes_in_the_plane():
    from planar_deform.scene.objects.cutout_object import begin

    letters = {}
    for plane in ("XY", "XZ", "YZ"):
        bar(plane=plane, name=plane)
        frame = begin(bpy.context).frame
        letters[plane] = frame.letters
        axes = ["XYZ".index(letter) for letter in frame.letters]
        assert frame.u[axes[0]] == pytest.approx(1.0)
        assert frame.v[axes[1]] == pytest.approx(1.0)
    assert letters == {"XY": ("X", "Y"), "XZ": ("X", "Z"), "YZ": ("Y", "Z")}


def test_winding_and_flipped_faces_do_not_matter():
    results = []
    for turned in (False, True):
        vertices, faces = grid(8, 4)
        faces = [list(face)[:: -1 if turned and i % 3 else 1] for i, face in enumerate(faces.tolist())]
        obj = make_object(vertices, faces)
        add_end_pins(obj, 8, 45)
        pose(obj, offset=(0.1, 0.4))
        results.append(coordinates(obj.data.vertices))
    # Quads are cut along one or the other diagonal depending on where they start: the solves differ a bit.
    assert np.abs(results[0] - results[1]).max() < 0.02


def test_ngons_and_concave_faces_are_posed_and_stay_as_they_are():
    vertices = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 0.3, 0), (0, 1, 0), (3, 0.2, 0), (3, 0.8, 0)]
    obj = make_object(vertices, [(0, 1, 2, 3, 4), (1, 5, 6, 2)])
    add_pins(obj, [0, 4], [5, 6])
    pose(obj, offset=(0.0, 0.5))
    assert [list(face.vertices) for face in obj.data.polygons] == [[0, 1, 2, 3, 4], [1, 5, 6, 2]]
    assert measured(obj).flipped == 0
    from planar_deform.scene.objects.cutout_object import begin

    triangles = begin(bpy.context).cutout.triangles
    assert sorted(np.unique(triangles).tolist()) == list(range(7))  # no corner of an n-gon is left out
    assert len(triangles) == 5


def test_faces_are_cut_the_same_however_the_drawing_is_posed():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar(nx=10, ny=2)
    add_end_pins(obj, 10, 33)
    before = begin(bpy.context).cutout.triangles
    pose(obj, offset=(-0.8, 0.9))
    assert np.array_equal(begin(bpy.context).cutout.triangles, before)


def test_a_hole_stays_open_and_parts_without_pins_keep_their_bits():
    vertices, faces = grid(9, 9, 3, 3)
    faces = [face for i, face in enumerate(faces.tolist()) if not (3 <= i % 9 < 6 and 3 <= i // 9 < 6)]
    other, other_faces = grid(3, 3, 1, 1, origin=(5, 0), depth=0.25)
    obj = make_object(np.concatenate([vertices, other]), faces + (other_faces + len(vertices)).tolist())
    before = coordinates(obj.data.vertices)
    add_pins(obj, [0], [99])
    pose(obj, offset=(0.5, 0.5), moving=[1])
    after = coordinates(obj.data.vertices)
    assert np.array_equal(after[100:], before[100:])
    assert np.linalg.norm(after[99] - before[99]) > 0.5
    # The four vertices inside the hole belong to no face.
    loose = [44, 45, 54, 55]
    assert np.array_equal(after[loose], before[loose])


def test_loose_vertices_and_edges_keep_their_bits_even_off_the_plane():
    vertices, faces = grid(6, 3)
    extra = [(0.1, 0.2, 7.7), (5, 5, 5), (6, -3, 1e-8), (np.nan, 0, 0)]
    count = len(vertices)
    obj = make_object(np.concatenate([vertices, extra]), faces.tolist(), edges=[(count, count + 1)])
    add = coordinates(obj.data.vertices)
    add_pins(obj, [0], [count - 1])
    pose(obj, offset=(0.3, 0.3), moving=[1])
    after = coordinates(obj.data.vertices)
    assert np.array_equal(after[count:].view(np.uint32), add[count:].view(np.uint32))
    assert not np.array_equal(after[:count], add[:count])


def test_depth_within_the_tolerance_is_kept():
    vertices, faces = grid(8, 4)
    rng = np.random.default_rng(1)
    vertices[:, 2] = rng.uniform(-4e-4, 4e-4, len(vertices))
    obj = make_object(vertices, faces.tolist())
    before = coordinates(obj.data.vertices)
    add_end_pins(obj, 8, 45)
    drawing, _ = pose(obj, offset=(0.2, 0.4))
    after = coordinates(obj.data.vertices)
    assert np.abs((after - before) @ drawing.frame.n).max() < 2e-7
    assert np.abs(after - before).max() > 0.3


def test_writing_the_shape_that_is_shown_changes_no_bit():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar(plane="tilted")
    obj.matrix_world = TRANSFORMS["rotated"]
    obj.data.vertices[0].co = (-0.0, 0.0, -0.0)
    before = coordinates(obj.data.vertices)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions)
    assert np.array_equal(coordinates(obj.data.vertices).view(np.uint32), before.view(np.uint32))


def test_restore_brings_back_every_bit():
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar(plane="tilted")
    obj.matrix_world = TRANSFORMS["stretched"]
    before = coordinates(obj.data.vertices)
    drawing = begin(bpy.context)
    drawing.write(drawing.positions * 1.7 + 0.3)
    assert not np.array_equal(coordinates(obj.data.vertices), before)
    drawing.restore()
    assert np.array_equal(coordinates(obj.data.vertices).view(np.uint32), before.view(np.uint32))
    assert np.array_equal(evaluated(obj), before)


def test_what_is_written_is_shown():
    obj = bar()
    before = evaluated(obj)
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.5))
    shown = evaluated(obj)
    assert np.abs(shown - before).max() > 0.3
    assert np.array_equal(shown, coordinates(obj.data.vertices))


def test_modifiers_are_allowed_and_those_that_shift_the_view_are_named():
    from planar_deform.scene.objects import modifiers

    obj = bar()
    obj.modifiers.new("Bend", "SIMPLE_DEFORM")
    obj.modifiers.new("Thick", "SOLIDIFY")
    hidden = obj.modifiers.new("Waves", "WAVE")
    hidden.show_viewport = False
    assert modifiers.shifting(obj) == ["Bend"]
    before = coordinates(obj.data.vertices)
    add_end_pins(obj)
    pose(obj, offset=(0.0, 0.4))
    assert np.abs(coordinates(obj.data.vertices) - before).max() > 0.3


def test_a_ray_finds_the_nearest_layer_first_and_an_edge_on_view_finds_nothing():
    from planar_deform.scene.objects.cutout_object import begin

    front, faces = grid(2, 2, 1, 1, depth=1.0)
    back, _ = grid(2, 2, 4, 4, depth=0.0)
    make_object(np.concatenate([front, back]), faces.tolist() + (faces + 9).tolist())
    drawing = begin(bpy.context)
    part_of = drawing.cutout.parts[drawing.cutout.triangles[:, 0]]
    down = np.array([0.0, 0.0, -1.0])
    assert part_of[drawing.pick(np.array([0.5, 0.4, 9.0]), down).triangle] == 0
    assert part_of[drawing.pick(np.array([0.5, 0.4, -9.0]), -down).triangle] == 1
    assert part_of[drawing.pick(np.array([3.0, 3.1, 9.0]), down).triangle] == 1
    assert drawing.pick(np.array([7.0, 0.0, 9.0]), down) is None
    assert drawing.pick(np.array([0.5, 0.4, 9.0]), np.array([1.0, 0.0, -0.01])) is None
    met = drawing.plane_from_ray(np.array([0.0, 0.0, 5.0]), np.array([0.3, 0.0, -1.0]))
    assert met == pytest.approx([1.2, 0.0])  # in the first part, at depth 1
