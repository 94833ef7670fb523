# SPDX-License-Identifier: GPL-3.0-or-later
"""The motion of one object made over to others that are built alike."""

import bpy
import numpy as np
import pytest
from sequences import curve_of, filled, key, pull, shown_at, stored, timing
from support import (
    PLANES,
    activate,
    add_pins,
    bar,
    coordinates,
    evaluated,
    grid,
    make_object,
    pose,
    world,
)

FRAMES = range(1, 26)


def transfer(source, *targets):
    activate(source)
    for target in targets:
        target.select_set(True)
    return bpy.ops.planar.transfer_motion()


def twin(obj, name="Twin"):
    """The same mesh at rest, without poses."""
    basis = coordinates(obj.data.shape_keys.key_blocks[0].data)
    return make_object(basis, [tuple(face.vertices) for face in obj.data.polygons], name=name)


@pytest.mark.parametrize("plane", PLANES)
def test_onto_a_twin_it_comes_back(plane):
    source = filled(name="Source", plane=plane)
    target = twin(source)
    assert transfer(source, target) == {"FINISHED"}
    assert timing(target) == timing(source)
    records = [[(p.name, p.at, p.generated) for p in obj.planar.poses] for obj in (source, target)]
    assert records[0] == records[1]
    assert records[0][0][2] == 11
    for frame in FRAMES:
        assert shown_at(target, frame) == pytest.approx(shown_at(source, frame), abs=1e-6)


def test_on_a_moved_turned_scaled_one_in_another_plane():
    source = filled(name="Source", plane="XZ")
    vertices, faces = grid(12, 4, 6.0, 3.0)
    target = make_object(vertices @ PLANES["YZ"].T, faces.tolist(), name="Large")
    target.location, target.rotation_euler, target.scale = (3, 2, 1), (0.3, 0.0, 0.8), (0.5, 0.5, 0.5)
    assert transfer(source, target) == {"FINISHED"}
    for frame in FRAMES:
        here, there = (shown_at(obj, frame).astype(float) for obj in (source, target))
        flat, large = here @ PLANES["XZ"], there @ PLANES["YZ"]
        assert large == pytest.approx(3.0 * flat, abs=1e-5)
    # Blender shows it there, too: three times the size, at half the scale.
    bpy.context.scene.frame_set(13)
    sizes = [
        np.linalg.norm(np.ptp(world(obj, evaluated(obj)) @ axes, axis=0))
        for obj, axes in (
            (source, PLANES["XZ"]),
            (target, np.array(target.matrix_world.to_3x3()) * 2 @ PLANES["YZ"]),
        )
    ]
    assert sizes[1] == pytest.approx(1.5 * sizes[0], rel=1e-5)


@pytest.mark.parametrize("turned", ["scale", "rotation"])
def test_on_one_that_is_seen_from_behind(turned):
    source = filled(name="Source")
    target = twin(source)
    if turned == "scale":
        target.scale.x = -1.0
    else:
        target.rotation_euler.y = np.pi
    assert transfer(source, target) == {"FINISHED"}
    for frame in (1, 8, 13, 20, 25):
        assert shown_at(target, frame) == pytest.approx(shown_at(source, frame), abs=1e-5)


def test_with_layers_and_loose_vertices():
    """Parts in planes of their own keep their depths, and what no face joins stays where it is."""
    vertices, faces = grid(6, 3)
    back, more = grid(6, 3, origin=(1.5, 0.3), depth=-0.2)
    points = np.concatenate([vertices, back, [[5.0, 5.0, 5.0]]])
    layers = [*faces.tolist(), *(more + len(vertices)).tolist()]
    source = make_object(points, layers, name="Source")
    add_pins(source, [0, 7, 14, 21], [28 + 6, 28 + 13])
    key(source, 1)
    pull(source, 9, (0.3, 0.6))
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    target = make_object(points * [2, 2, 3] + [0, 0, 1], layers, name="Large")
    assert transfer(source, target) == {"FINISHED"}
    for frame in (1, 5, 9):
        expected = shown_at(source, frame).astype(float) * [2, 2, 3] + [0, 0, 1]
        assert shown_at(target, frame) == pytest.approx(expected, abs=1e-5)
    assert np.abs(shown_at(target, 9) - shown_at(target, 1)).max() > 0.5


def test_another_shape_moves_by_its_own_edges():
    source = filled(name="Source")
    target = twin(source, "Other")
    rest = coordinates(target.data.vertices)
    rest[:, 0] *= 1.0 + 0.2 * rest[:, 1]
    rest[:, 1] += 0.1 * np.sin(2.0 * rest[:, 0])
    target.data.vertices.foreach_set("co", rest.ravel())
    target.data.update()
    assert transfer(source, target) == {"FINISHED"}
    assert shown_at(target, 1) == pytest.approx(rest, abs=1e-6)
    edges = np.array([edge.vertices[:] for edge in source.data.edges])
    ends = [obj.astype(float)[edges] for obj in (shown_at(source, 1), shown_at(source, 13))]
    own = [obj.astype(float)[edges] for obj in (shown_at(target, 1), shown_at(target, 13))]
    spans = [np.linalg.norm(points[:, 1] - points[:, 0], axis=1) for points in (*ends, *own)]
    # Each edge grows about as the source's does; exactly it cannot, for its edges have to meet.
    assert spans[3] / spans[2] == pytest.approx(spans[1] / spans[0], abs=0.15)
    assert np.abs(spans[1] / spans[0] - 1.0).max() > 0.02


def test_easing_names_and_marks_go_along():
    source = filled(name="Source")
    source.planar.poses[1].name = "Up"
    curve = curve_of(source)
    curve.keyframe_points[0].interpolation = "BEZIER"
    curve.keyframe_points[1].interpolation = "CONSTANT"
    targets = [twin(source, name) for name in "AB"]
    assert transfer(source, *targets) == {"FINISHED"}
    for target in targets:
        assert timing(target) == timing(source)
        assert [pose.name for pose in target.planar.poses] == [pose.name for pose in source.planar.poses]
        assert "Up" in target.data.shape_keys.key_blocks
        action = target.data.shape_keys.animation_data.action
        assert action != source.data.shape_keys.animation_data.action
        assert action.name == f"{target.name} Poses"
    curve_of(targets[0]).keyframe_points[2].co.x = 30
    assert timing(targets[1]) == timing(source)


def test_what_was_filled_is_fresh_and_what_was_stale_is_stale():
    from planar_deform.scene.sequence import stretches

    source = filled(name="Source")
    target = twin(source)
    assert transfer(source, target) == {"FINISHED"}
    assert stretches.stale(source) == stretches.stale(target) == []
    bpy.context.scene.frame_set(25)
    activate(source)
    pose(source, offset=(0.1, 0.0))
    late = twin(source, "Late")
    assert stretches.stale(source) == [(1, 2)]
    assert transfer(source, late) == {"FINISHED"}
    assert stretches.stale(late) == [(1, 2)]


def test_refused_with_what_differs_and_nothing_changed_anywhere():
    source = filled(name="Source")
    good, other = twin(source, "Good"), bar(nx=11, name="Other")
    before = stored(good), stored(other), stored(source)
    with pytest.raises(RuntimeError, match="'Other' is built differently from 'Source': 60 vertices, not 65"):
        transfer(source, good, other)
    assert (stored(good), stored(other), stored(source)) == before
    key(other, 1)
    with pytest.raises(RuntimeError, match="'Other' has poses.*Clear Poses"):
        transfer(source, good, other)
    assert good.data.shape_keys is None
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    bpy.context.scene.collection.objects.link(camera)
    with pytest.raises(RuntimeError, match="'Eye'"):
        transfer(source, good, camera)
    assert good.data.shape_keys is None
    activate(source)
    with pytest.raises(RuntimeError, match="No other object is selected"):
        bpy.ops.planar.transfer_motion()


def test_closed_while_it_is_written_everything_is_as_it_was():
    from planar_deform.scene.motion.transfer import Transfer

    source = filled(name="Source")
    plain, with_key = twin(source, "Plain"), twin(source, "WithKey")
    with_key.shape_key_add(name="Basis")
    activate(with_key)
    before = stored(plain), stored(with_key), stored(source), set(bpy.data.actions.keys())
    activate(source)
    for target in (plain, with_key):
        target.select_set(True)
    plan = Transfer(bpy.context)
    shapes = plan.solve(lambda share: True)
    for steps in (1, 5, 30, 45):
        writing = plan.write(shapes)
        shares = [next(writing) for _ in range(steps)]
        assert shares == sorted(shares)
        assert 0.0 <= shares[-1] < 1.0
        assert (stored(plain), stored(with_key)) != before[:2]
        writing.close()
        assert (stored(plain), stored(with_key), stored(source), set(bpy.data.actions.keys())) == before
    for _ in plan.write(shapes):
        pass
    assert len(plain.planar.poses) == len(with_key.planar.poses) == 3


def test_cleared_the_target_is_as_before():
    source = filled(name="Source")
    target = twin(source)
    before = stored(target)
    transfer(source, target)
    activate(target)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert stored(target) == before


def test_one_undo_step():
    source = filled(name="Source")
    target = twin(source)
    bpy.ops.ed.undo_push(message="Start")
    before = stored(target)
    transfer(source, target)
    bpy.ops.ed.undo_push(message="Transfer")
    after = stored(bpy.data.objects["Twin"])
    bpy.ops.ed.undo()
    assert stored(bpy.data.objects["Twin"]) == before
    bpy.ops.ed.redo()
    assert stored(bpy.data.objects["Twin"]) == after


def test_outlines():
    """Lines without faces: an open one and a closed one, on a twin that is seen from behind."""
    angles = np.linspace(0, 2 * np.pi, 17)[:-1]
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    line = np.stack([np.linspace(-2, 2, 9), 0 * np.arange(9) - 2.0, 0 * np.arange(9)], axis=1)
    points = np.concatenate([ring, line])
    edges = [(i, (i + 1) % 16) for i in range(16)] + [(i, i + 1) for i in range(16, 24)]
    source = make_object(points, [], edges, name="Lines")
    key(source, 1)
    bpy.context.scene.frame_set(9)
    key(source, 9)
    bent = points.copy()
    bent[16:, 1] += 0.3 * bent[16:, 0] ** 2
    bent[:16] = ring[:, [1, 0, 2]] * [-1.3, 1.0, 1.0]
    block = source.data.shape_keys.key_blocks[-1]
    block.data.foreach_set("co", bent.astype(np.float32).ravel())
    source.data.update()
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    target = make_object(points * [-1, 1, 1], [], edges, name="Behind")
    assert transfer(source, target) == {"FINISHED"}
    for frame in range(1, 10):
        assert shown_at(target, frame) * [-1, 1, 1] == pytest.approx(shown_at(source, frame), abs=1e-5)


def test_a_twin_without_pins_gets_those_of_the_source():
    from planar_deform.scene.sequence import stretches

    source = filled(name="Source", plane="XZ")
    add_pins(source, [30, 31], kind="PATCH")
    source.planar.pins[2].name, source.planar.pins[0].enabled = "Tail", False
    source.vertex_groups[source.planar.pins[2].group].add([30], 0.25, "REPLACE")
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    target, pinned = twin(source), twin(source, name="Pinned")
    add_pins(pinned, [5])
    assert transfer(source, target, pinned) == {"FINISHED"}
    assert [pin.name for pin in target.planar.pins] == [pin.name for pin in source.planar.pins]
    assert [pin.enabled for pin in target.planar.pins] == [False, True, True]
    assert target.planar.pins[2].kind == "PATCH"
    group = target.vertex_groups[target.planar.pins[2].group]
    assert (group.weight(30), group.weight(31)) == (0.25, 1.0)
    assert len(pinned.planar.pins) == 1
    assert stretches.stale(target) == stretches.stale(pinned) == []
    activate(target)
    bpy.context.scene.frame_set(13)
    for index, pin in enumerate(target.planar.pins):
        pin.select = index == 1
    before = evaluated(target)[38]
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.0)) == {"FINISHED"}
    assert evaluated(target)[38] - before == pytest.approx([0.1, 0.0, 0.0], abs=0.02)
