# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving, turning and spreading pins from scripts, and again from the redo panel."""

import base64
import contextlib
import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from support import (
    PLANES,
    add_end_pins,
    add_pins,
    bar,
    coordinates,
    evaluated,
    grid,
    make_object,
    measured,
    world,
)


def drag(**arguments):
    return bpy.ops.planar.drag_pins(**arguments)


def packed(samples):
    return base64.b64encode(np.asarray(samples, "<f4").tobytes()).decode("ascii")


def circle(radius, turns=1.0, samples=40):
    """Offsets of a loop that starts and ends at 0."""
    phase = np.linspace(0.0, 2 * np.pi * turns, samples + 1)[1:]
    offsets = np.stack([radius * (np.cos(phase) - 1), radius * np.sin(phase), 0 * phase], axis=1)
    offsets[-1] = 0.0
    return offsets


def place(obj, index=1):
    """Where the last posing left a pin (object-local)."""
    return np.array(obj.planar.pins[index].reached)


@pytest.mark.parametrize("plane", PLANES)
def test_an_offset_moves_the_selected_pins_along_the_planes_axes(plane):
    from planar_deform.scene.objects.cutout_object import begin

    obj = bar(plane=plane)
    add_end_pins(obj)
    frame = begin(bpy.context).frame
    right, left = 38, 26  # the middle of either end, where the pins are
    before = coordinates(obj.data.vertices).astype(float)
    assert drag(offset=(0.1, 0.4)) == {"FINISHED"}
    moved = coordinates(obj.data.vertices) - before
    expected = 0.1 * frame.u + 0.4 * frame.v
    assert moved[right] == pytest.approx(expected, abs=1e-3)
    assert moved[left] == pytest.approx([0, 0, 0], abs=1e-3)
    assert place(obj) == pytest.approx(before[right] + expected, abs=1e-3)
    assert measured(obj).flipped == 0


def test_several_selected_pins_move_together_and_turn_about_their_centre():
    obj = bar()
    add_end_pins(obj)
    bpy.ops.planar.select_pins(action="ALL")
    before = coordinates(obj.data.vertices).astype(float)
    assert drag(offset=(0.5, -0.25)) == {"FINISHED"}
    assert coordinates(obj.data.vertices) - before == pytest.approx(
        np.tile([0.5, -0.25, 0], (65, 1)), abs=1e-5
    )
    assert bpy.ops.planar.rotate_pins(angle=math.radians(90)) == {"FINISHED"}
    centre = np.array([1.5, 0.25])
    arms = before[:, :2] + [0.5, -0.25] - centre
    turned = np.stack([-arms[:, 1], arms[:, 0]], axis=1) + centre
    # Rigid motions are exact in the method, so that this holds at any angle.
    assert coordinates(obj.data.vertices)[:, :2] == pytest.approx(turned, abs=1e-4)


def test_a_script_chooses_what_pins_turn_about():
    obj = bar()
    add_end_pins(obj)
    obj.location = (3.0, 0.0, 0.0)
    bpy.ops.planar.select_pins(action="ALL")
    before = coordinates(obj.data.vertices).astype(float)
    assert bpy.ops.planar.rotate_pins(angle=math.radians(90), pivot=(3.0, 0.0, 5.0)) == {"FINISHED"}
    turned = np.stack([-before[:, 1], before[:, 0]], axis=1)
    assert coordinates(obj.data.vertices)[:, :2] == pytest.approx(turned, abs=1e-4)


def test_turning_a_point_pin_alone_leaves_the_drawing():
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    bpy.ops.planar.rotate_pins(angle=1.0)
    assert np.abs(coordinates(obj.data.vertices) - before).max() < 1e-6


def test_repeating_an_action_with_its_path_gives_the_same_bits():
    """The redo panel runs execute() on the mesh as it was: the same path must give the same bits."""
    results = []
    for fresh in (True, False):
        obj = bar(name=f"Fresh{fresh}")
        add_end_pins(obj)
        obj.planar.pins[0].select = False
        drag(offset=(0.0, 0.3))
        before = coordinates(obj.data.vertices)
        settings = [(pin.target[:], pin.reached[:], pin.has_target) for pin in obj.planar.pins]
        path = circle(0.4, 0.7) * [1, 1, 0]
        end = tuple(path[-1, :2])
        if not fresh:  # a solver with a history: others must not see it
            drag(offset=(0.7, -0.5))
            obj.data.vertices.foreach_set("co", before.ravel())
            for pin, (target, reached, has) in zip(obj.planar.pins, settings, strict=True):
                pin.target, pin.reached, pin.has_target = target, reached, has
        drag(offset=end, path=packed(path))
        results.append(coordinates(obj.data.vertices))
    assert np.array_equal(results[0].view(np.uint32), results[1].view(np.uint32))


def test_an_edited_offset_carries_the_path_along():
    ends = {}
    path = circle(0.3, 0.5)
    path = np.concatenate([path, path[-1:].repeat(5, axis=0)])  # a rest at the end, in which it settles
    end = path[-1, :2]
    for name, factor in (("recorded", 1.0), ("edited", 0.5)):
        obj = bar(name=name)
        add_end_pins(obj)
        start = coordinates(obj.data.vertices)[12::13].mean(axis=0)
        assert drag(offset=tuple(end * factor), path=packed(path)) == {"FINISHED"}
        ends[name] = place(obj) - start
    assert ends["recorded"][:2] == pytest.approx(end, abs=2e-3)
    assert ends["edited"][:2] == pytest.approx(end / 2, abs=2e-3)


def test_a_closed_path_returns_without_jumps_or_flips():
    obj = bar(nx=24, ny=8)
    add_end_pins(obj, 24, 225)
    before = coordinates(obj.data.vertices)
    assert drag(offset=(0.0, 0.0), path=packed(circle(0.3))) == {"FINISHED"}
    after = coordinates(obj.data.vertices)
    assert measured(obj).flipped == 0
    assert place(obj) == pytest.approx([2.0, 0.5, 0.0], abs=5e-3)
    # AKVF forgets the rest shape: up to 8 % of the diagonal after a loop (METHODS, "hold the rest shape").
    assert np.linalg.norm(after - before, axis=1).max() < 0.08 * math.hypot(2, 1)


@pytest.mark.parametrize("path", ["nonsense", packed([[0, 0, np.nan]]), base64.b64encode(b"12345").decode()])
def test_a_path_that_no_drag_recorded_is_refused_and_changes_nothing(path):
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    with pytest.raises(RuntimeError, match="path"):
        drag(offset=(0.1, 0.1), path=path)
    assert np.array_equal(coordinates(obj.data.vertices), before)
    assert not obj.planar.pins[1].has_target


def test_nothing_to_move_is_refused():
    obj = bar()
    add_end_pins(obj)
    bpy.ops.planar.select_pins(action="NONE")
    before = coordinates(obj.data.vertices)
    with pytest.raises(RuntimeError, match="selected"):
        drag(offset=(0.1, 0.1))
    bpy.ops.planar.select_pins(action="ALL")
    for pin in obj.planar.pins:
        pin.enabled = False
    with pytest.raises(RuntimeError, match="enable"):
        drag(offset=(0.1, 0.1))
    assert np.array_equal(coordinates(obj.data.vertices), before)


@pytest.mark.parametrize("offset", [(1e30, 0.0), (float("inf"), 0.0), (float("nan"), 1.0)])
def test_absurd_offsets_leave_a_mesh_of_numbers(offset):
    obj = bar()
    add_end_pins(obj)
    before = coordinates(obj.data.vertices)
    try:
        drag(offset=offset)
    except RuntimeError:
        assert np.array_equal(coordinates(obj.data.vertices), before)
    assert np.isfinite(coordinates(obj.data.vertices)).all()
    assert np.isfinite(evaluated(obj)).all()


def test_an_active_basis_gets_a_pose_key_and_the_shape_shown_is_posed():
    obj = bar()
    obj.shape_key_add(name="Basis")
    add_end_pins(obj)
    assert drag(offset=(0.0, 0.5)) == {"FINISHED"}
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Pose"]
    assert evaluated(obj)[12::13].mean(axis=0) == pytest.approx([2.0, 1.0, 0.0], abs=0.02)


def test_layers_of_one_mesh_are_posed_apart_and_keep_their_depths():
    vertices, faces = grid(6, 3)
    obj = make_object(
        np.concatenate([vertices, vertices + np.array([0.3, 0.2, 0.4])]),
        faces.tolist() + (faces + 28).tolist(),
    )
    add_pins(obj, [28], [28 + 6])
    before = coordinates(obj.data.vertices)
    drag(offset=(0.0, 0.5))
    after = coordinates(obj.data.vertices)
    assert np.array_equal(after[:28], before[:28])
    assert np.array_equal(after[:, 2], before[:, 2])
    assert obj.planar.pins[1].target[2] == pytest.approx(0.4)


def test_an_edit_of_the_mesh_between_two_drags_is_seen():
    obj = bar()
    add_end_pins(obj)
    drag(offset=(0.0, 0.4))
    points = coordinates(obj.data.vertices)
    points[:, 0] += 3.0
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    drag(offset=(0.0, 0.1))
    moved = coordinates(obj.data.vertices) - points
    assert np.abs(moved).max() < 0.2  # nothing was pulled back to where it had been
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert drag(offset=(0.0, 0.1)) == {"FINISHED"}
    assert measured(obj).flipped == 0


def imported(tilt=0.0):
    """A bar as importers leave it: drawn in XY, turned to stand up, scaled; and turned in its plane."""
    obj = bar()
    obj.matrix_world = (
        Matrix.Rotation(tilt, 4, "Y") @ Matrix.Rotation(math.pi / 2, 4, "X") @ Matrix.Scale(3.0, 4)
    )
    add_end_pins(obj)
    bpy.context.view_layer.update()
    return obj


@pytest.mark.parametrize("tilt", [0.0, 0.6, -2.5])
def test_an_offset_along_global_axes_is_the_worlds(tilt):
    obj = imported(tilt)
    before = world(obj)[12::13].mean(axis=0)
    assert drag(offset=(0.3, 0.5), orientation="GLOBAL") == {"FINISHED"}
    moved = np.array(obj.matrix_world @ Vector(place(obj)))
    assert moved - before == pytest.approx([0.3, 0.0, 0.5], abs=3e-3)
    assert drag(offset=(0.0, -0.5)) == {"FINISHED"}, "by itself a script's is along the object's own axes"
    own = obj.matrix_world.to_3x3().normalized() @ Vector((0.0, -0.5, 0.0))
    assert np.array(obj.matrix_world @ Vector(place(obj))) - moved == pytest.approx(list(own), abs=3e-3)


@pytest.mark.parametrize("orientation", ["GLOBAL", "LOCAL"])
def test_a_recorded_path_that_ends_at_its_offset_is_repeated_to_the_bit(orientation):
    from planar_deform.model.plane.axes import plane_axes
    from planar_deform.operators.modal.several_posing import begin

    path = circle(0.4, 0.7)
    obj = imported(0.6)
    begin(bpy.context).run(np.float32(path).astype(float).tolist(), settle=False)
    recorded = coordinates(obj.data.vertices)
    obj = imported(0.6)
    axes = plane_axes(begin(bpy.context).drawing.frame, orientation)
    drag(
        offset=axes.values(np.float32(path[-1, :2]).astype(float)), path=packed(path), orientation=orientation
    )
    assert np.array_equal(coordinates(obj.data.vertices), recorded)
    obj = imported(0.6)
    drag(offset=(0.1, 0.1), path=packed(path), orientation=orientation)
    assert not np.array_equal(coordinates(obj.data.vertices), recorded)


@pytest.mark.parametrize("plane", PLANES)
def test_a_factor_spreads_and_gathers_the_selected_pins(plane):
    obj = bar(plane=plane)
    add_end_pins(obj)
    bpy.ops.planar.select_pins(action="ALL")
    before = coordinates(obj.data.vertices).astype(float)
    left, right = before[26], before[38]
    centre = (left + right) / 2
    for factor, total in ((1.5, 1.5), (0.5, 0.75)):
        assert bpy.ops.planar.spread_pins(factor=factor) == {"FINISHED"}
        assert place(obj, 0) == pytest.approx(centre + total * (left - centre), abs=0.02)
        assert place(obj, 1) == pytest.approx(centre + total * (right - centre), abs=0.02)
        assert measured(obj).flipped == 0


@pytest.mark.parametrize(
    ("axis", "orientation", "grows"),
    [
        ("X", "GLOBAL", (1, 0, 0)),
        ("Z", "GLOBAL", (0, 0, 1)),
        ("Y", "GLOBAL", (0, 0, 0)),
        ("X", "LOCAL", None),
        ("Y", "LOCAL", None),
        ("Z", "LOCAL", (0, 0, 0)),
    ],
)
def test_pins_are_spread_along_an_axis_of_an_imported_drawing(axis, orientation, grows):
    obj = imported(0.6)
    bpy.ops.planar.select_pins(action="ALL")
    own = np.array(obj.matrix_world.to_3x3().normalized())[:, "XYZ".index(axis)]
    way = own if grows is None else np.array(grows, float)
    starts = np.array([world(obj)[column::13].mean(axis=0) for column in (0, 12)])
    middle = starts.mean(axis=0)
    assert bpy.ops.planar.spread_pins(factor=1.25, axis=axis, orientation=orientation) == {"FINISHED"}
    for index, start in enumerate(starts):
        target = np.array(obj.matrix_world @ Vector(obj.planar.pins[index].target))
        assert target == pytest.approx(start + 0.25 * way * (way @ (start - middle)), abs=2e-4)


def test_pins_are_spread_from_a_given_pivot_and_patches_keep_their_angle():
    obj = bar()
    add_end_pins(obj, kind="PATCH")
    bpy.ops.planar.select_pins(action="ALL")
    bpy.ops.planar.rotate_pins(angle=0.2)
    angles = [pin.angle for pin in obj.planar.pins]
    starts = [place(obj, 0), place(obj, 1)]
    assert bpy.ops.planar.spread_pins(factor=1.2, pivot=(0.0, 0.5, 7.0)) == {"FINISHED"}
    for index, start in enumerate(starts):
        target = np.array(obj.planar.pins[index].target)
        assert target == pytest.approx(np.array([0, 0.5, 0]) + 1.2 * (start - [0, 0.5, 0]), abs=1e-2)
    assert [pin.angle for pin in obj.planar.pins] == pytest.approx(angles)


@pytest.mark.parametrize("factor", [0.0, -1.0, 1e30, float("nan")])
def test_absurd_factors_leave_a_mesh_of_numbers(factor):
    obj = bar()
    add_end_pins(obj)
    bpy.ops.planar.select_pins(action="ALL")
    with contextlib.suppress(RuntimeError):
        bpy.ops.planar.spread_pins(factor=factor)
    assert np.isfinite(coordinates(obj.data.vertices)).all()
    assert np.isfinite(evaluated(obj)).all()
