# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that go on paths of their own between two poses, and what they tell when they cannot."""

import bpy
import numpy as np
import pytest
from filling import generate, remove, shown, stale
from sequences import go_to, pull, same, stored
from support import activate, add_pins, bar
from test_planted import FRAMES, drawing_of, drift, places_of

HAND = 1


def reaching(plane="XY", kind="POINT", **options):
    """A bar that stands on one end, and lifts a hand at the other; the paths of the hand are to be made."""
    obj = bar(plane=plane, nx=24, ny=8, **options)
    add_pins(obj, [0, 1, 25, 26], kind="PATCH")
    add_pins(obj, [224, 223, 199, 198] if kind == "PATCH" else [224], kind=kind)
    obj.planar.active_pin = HAND
    pull(obj, 1, (0.0, 0.0))
    pull(obj, 13, (-0.7, 0.9))
    return obj


def give_path(obj, kind, ease="LINEAR", curve=None, pose=0):
    activate(obj)
    assert bpy.ops.planar.add_pin_path(pose=pose) == {"FINISHED"}
    path = obj.planar.pins[HAND].paths[-1]
    path.kind, path.ease, path.curve = kind, ease, curve
    return path


def line(points, *, closed=False, kind="POLY", matrix=None):
    """A curve object along n x 3 points."""
    curve = bpy.data.curves.new("Way", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new(kind)
    stored = spline.bezier_points if kind == "BEZIER" else spline.points
    stored.add(len(points) - 1)
    for point, place in zip(stored, points, strict=True):
        point.co = place if kind == "BEZIER" else (*place, 1.0)
        if kind == "BEZIER":
            point.handle_left_type = point.handle_right_type = "AUTO"
    spline.use_cyclic_u = closed
    obj = bpy.data.objects.new("Way", curve)
    bpy.context.scene.collection.objects.link(obj)
    if matrix is not None:
        obj.matrix_world = matrix
    bpy.context.view_layer.update()
    return obj


def bow(lift=0.8, count=17):
    """A bow from 0 to 1 on X, in the plane XY."""
    along = np.linspace(0.0, 1.0, count)
    return np.stack([along, lift * 4.0 * along * (1.0 - along), 0.0 * along], axis=1)


def hand(obj):
    return places_of(obj)[0][:, HAND]


def fit(obj):
    places, _ = places_of(obj)
    off, _, flips = drift(obj, [0])
    assert off <= 2e-4, "the foot stands"
    assert flips == 0
    return places[:, HAND]


@pytest.mark.parametrize("kind", ["POINT", "PATCH"])
@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_a_straight_path_and_its_timing(plane, kind):
    obj = reaching(plane, kind)
    generate(obj)
    free = hand(obj)
    give_path(obj, "STRAIGHT", "EASE_IN")
    assert stale(obj) == [(0, 1)]
    generate(obj)
    assert stale(obj) == []
    found = fit(obj)
    u = np.linspace(0.0, 1.0, len(FRAMES))[:, None] ** 2
    np.testing.assert_allclose(found, found[0] + u * (found[-1] - found[0]), atol=2e-4)
    assert np.abs(found - free).max() > 0.05
    assert bpy.ops.planar.remove_pin_path(pose=0) == {"FINISHED"}
    generate(obj)
    np.testing.assert_allclose(hand(obj), free, atol=1e-6)


def test_a_new_path_is_told_between_which_poses_it_is(capfd):
    obj = reaching()
    bpy.context.scene.frame_set(20)  # behind both, whichever pose is active
    capfd.readouterr()
    give_path(obj, "STRAIGHT")
    assert "From 'Pose' to 'Pose.001': choose its path" in capfd.readouterr().out


def test_an_arc_is_round_where_the_hand_turns():
    obj = reaching(kind="PATCH")
    bpy.ops.planar.rotate_pins(angle=1.0)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    give_path(obj, "ARC")
    generate(obj)
    found = fit(obj) @ [1.0, 1.0j]
    step = np.diff(found)
    turns = np.angle(step[1:] / step[:-1])
    assert turns.min() > 0.0 or turns.max() < 0.0
    np.testing.assert_allclose(turns, turns.mean(), atol=5e-3)
    np.testing.assert_allclose(np.abs(step), np.abs(step).mean(), rtol=5e-3)


@pytest.mark.parametrize("kind", ["POLY", "BEZIER"])
@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_a_curve_leads_the_hand_whatever_the_objects_are_like(plane, kind):
    obj = reaching(plane)
    obj.matrix_world = [[0.5, 0.1, 0.0, 3.0], [0.0, 0.5, 0.0, -1.0], [0.0, 0.2, 0.5, 2.0], [0, 0, 0, 1]]
    bpy.context.view_layer.update()
    generate(obj)
    drawing = drawing_of(obj)
    ends = drawing.to_world(hand(obj)[[0, -1]])
    normal = np.cross(*(drawing.to_world(np.eye(2)) - drawing.to_world(np.zeros((2, 2)))))
    along = ends[1] - ends[0]
    across = np.cross(normal / np.linalg.norm(normal), along)
    shape = bow()
    points = ends[0] + shape[:, :1] * along + 0.5 * shape[:, 1:2] * across
    give_path(obj, "CURVE", curve=line(points, kind=kind))
    generate(obj)
    found = drawing.to_world(fit(obj))
    dense = np.stack([np.interp(np.linspace(0, 16, 2000), np.arange(17), row) for row in points.T], axis=1)
    gaps = np.linalg.norm(found[:, None] - dense, axis=2).min(axis=1)
    assert gaps.max() < 5e-3
    assert np.linalg.norm(found[6] - (ends[0] + ends[1]) / 2) > 0.25 * np.linalg.norm(along)


def test_a_closed_curve_leads_a_hand_round():
    obj = reaching()
    pull(obj, 25, (0.0, 0.0))
    angles = np.linspace(0.0, 2 * np.pi, 32, endpoint=False)
    circle = 0.15 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    give_path(obj, "CURVE", curve=line(circle, closed=True), pose=1)
    generate(obj)
    places, _ = places_of(obj, range(13, 26))
    way = places[:, HAND] - places[0, HAND]
    middle = way[:12].mean(axis=0)
    np.testing.assert_allclose(np.linalg.norm(way - middle, axis=1), 0.15, atol=3e-3)


def broken_down(obj, frame=7):
    go_to(frame)
    activate(obj)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    generate(obj)
    return hand(obj)


def test_a_breakdown_leaves_a_hand_on_its_arc_and_its_timing():
    obj = reaching(kind="PATCH")
    bpy.ops.planar.rotate_pins(angle=1.0)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    give_path(obj, "ARC", "EASE_IN")
    generate(obj)
    whole = hand(obj)
    halves = broken_down(obj)
    assert [(path.pose, path.ease) for path in obj.planar.pins[HAND].paths] == [
        (obj.planar.poses[0].name, "EASE_IN"),
        (obj.planar.poses[1].name, "LINEAR"),
    ]
    np.testing.assert_allclose(halves[:7], whole[:7], atol=6e-3)
    rows = np.column_stack([2.0 * whole, np.ones(len(whole))])  # of the circle through the whole way
    x, y, rest = np.linalg.lstsq(rows, (whole**2).sum(axis=1), rcond=None)[0]
    radius = np.sqrt(rest + x * x + y * y)
    np.testing.assert_allclose(np.linalg.norm(halves - [x, y], axis=1), radius, rtol=1e-2)
    broken_down(obj, frame=7)  # once more, at the same frame
    assert len(obj.planar.pins[HAND].paths) == 2


def test_a_breakdown_on_a_curve_tells_that_it_ends_there(capfd):
    obj = reaching()
    ends = drawing_of(obj).to_world(hand(obj)[[0, -1]])
    give_path(obj, "CURVE", curve=line(ends[0] + bow(0.1)[:, :1] * (ends[1] - ends[0])))
    broken_down(obj)
    assert "ends at the new pose now" in capfd.readouterr().out
    assert len(obj.planar.pins[HAND].paths) == 1


def refused(obj, match, frame=7):
    activate(obj)
    go_to(frame)
    before = stored(obj)
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.planar.generate_inbetweens()
    assert stored(obj) == before
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.planar.breakdown(percent=50.0)
    assert stored(obj) == before


def test_what_cannot_lead_is_told_and_changes_nothing():
    obj = reaching()
    path = give_path(obj, "CURVE")
    refused(obj, "has no curve for its path from 'Pose': choose one")
    path.curve = line(bow(), closed=True)
    refused(obj, "'Way' ends where it begins, and pin 'Pin.001' does not from 'Pose': open")
    path.curve = line(bow(), kind="NURBS")
    refused(obj, "make it a Bezier curve")
    path.curve = line(np.zeros((2, 3)))
    refused(obj, "has no length")
    path.curve = line(np.array([[0.0, 0, 0], [0, 0, 2]]))
    refused(obj, "lies across the plane of 'Cutout'")
    path.curve = line(bow())
    pull(obj, 25, (0.0, 0.0))
    give_path(obj, "CURVE", curve=path.curve, pose=1)
    refused(obj, "ends where it begins from 'Pose.001', and 'Way.004' does not: close", frame=19)
    obj.planar.pins[HAND].enabled = False
    generate(obj)


def test_what_makes_paths_stale():
    obj = reaching()
    way = line(bow())
    path = give_path(obj, "CURVE", curve=way)
    generate(obj)
    assert stale(obj) == []
    obj.planar.poses[0].name = "Low"
    assert path.pose == "Low"
    obj.planar.pins[HAND].name = "Hand"
    way.location, way.rotation_euler = (3.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    assert stale(obj) == [], "a curve is brought to the poses anyway"
    way.data.splines[0].points[5].co.y += 0.3
    assert stale(obj) == [(0, 1)]
    generate(obj)
    path.ease = "EASE"
    assert stale(obj) == [(0, 1)]
    from planar_deform.scene.sequence import stretches

    assert stretches.why_stale(obj, 0) == ["paths of pins"]
    generate(obj)
    bpy.data.objects.remove(way)
    assert stale(obj) == [(0, 1)]
    remove(obj)
    assert len(obj.planar.pins[HAND].paths) == 1
    activate(obj)
    assert bpy.ops.planar.delete_pose(pose=0) == {"FINISHED"}
    assert len(obj.planar.pins[HAND].paths) == 0


def test_a_new_pose_has_no_path_of_an_earlier_one_of_its_name():
    obj = reaching()
    pull(obj, 25, (0.2, 0.1))
    name = obj.planar.poses[1].name
    give_path(obj, "ARC", pose=1)
    obj.planar.poses[1].name = "Gone"
    obj.planar.pins[HAND].paths[0].pose = name  # as what goes away unseen leaves it
    pull(obj, 37, (0.1, 0.1))
    assert name in [pose.name for pose in obj.planar.poses]
    assert len(obj.planar.pins[HAND].paths) == 0


def test_a_breakdown_and_smooth_go_on_the_path_and_overshoot_leaves_it():
    obj = reaching()
    pull(obj, 25, (0.6, -0.2))
    give_path(obj, "ARC", "EASE")
    generate(obj, smooth=True)
    fit(obj)
    wanted = shown(obj, 7)
    go_to(7)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    assert np.abs(shown(obj, 7) - wanted).max() < 1e-5
    go_to(7)
    assert bpy.ops.planar.breakdown(percent=120.0) == {"FINISHED"}


def test_paths_of_a_file_undo_and_a_duplicate(tmp_path):
    obj = reaching()
    way = line(bow())
    bpy.ops.ed.undo_push(message="Before")
    give_path(obj, "CURVE", "EASE", way)
    bpy.ops.ed.undo_push(message="Path")
    generate(obj)
    between = shown(obj, 7)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy.planar.pins[HAND].paths[0].curve == way
    generate(copy)
    assert same(shown(copy, 7), between)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "paths.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "paths.blend"))
    obj = bpy.data.objects["Cutout"]
    path = obj.planar.pins[HAND].paths[0]
    assert (path.kind, path.ease, path.curve.name) == ("CURVE", "EASE", "Way")
    assert stale(obj) == []
    activate(obj)
    with pytest.raises(RuntimeError, match="has a path from 'Pose' already"):
        bpy.ops.planar.add_pin_path(pose=0)
    with pytest.raises(RuntimeError, match="There is no pin 9"):
        bpy.ops.planar.add_pin_path(pose=0, pin=9)
