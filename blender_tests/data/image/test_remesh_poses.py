# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh of a drawing with keyed poses and in-betweens."""

import bpy
import numpy as np
import pytest
from drawings import character, extremes
from filling import curve_fields, everything, stale
from pictures import corner_places
from remeshed import assert_in_place, coarse_bar, group, held, remesh
from sequences import History, curve_of, go_to, key, pull, shown_at, stored
from support import activate, add_pins, coordinates, measured, world


def keyed(**options):
    """A bar that bends, keyed and filled; its settings are not those of a new one."""
    obj = coarse_bar(**options)
    key(obj, 1)
    pull(obj, 13, (-0.3, 0.7))
    pull(obj, 25, (0.1, -1.6))
    obj.planar.smooth = True
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    obj.planar.poses[1].name = "Up"
    return obj


def without_shapes(obj):
    """All that is stored of poses but the shapes themselves and their digests."""
    keys = obj.data.shape_keys
    from planar_deform.scene.sequence.playback import record_of

    records = [record_of(pose) for pose in obj.planar.poses]
    for record in records:
        for name in ("stamp", "made_with", "copied"):
            record[name] = bool(record[name])
    return (
        [(b.name, b.frame, b.interpolation, b.lock_shape, b.mute, b.value) for b in keys.key_blocks],
        (keys.name, keys.use_relative, keys.eval_time, obj.active_shape_key_index),
        keys.animation_data.action.name,
        curve_fields(obj),
        records,
        (obj.planar.active_pose, obj.planar.anchor_path, obj.planar.smooth, obj.planar.curve_before),
        [(pin.name, pin.kind, pin.weight, pin.enabled, pin.select) for pin in obj.planar.pins],
        obj.planar.active_pin,
    )


@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_poses_and_inbetweens_are_carried(plane):
    obj = keyed(plane=plane)
    obj.planar.active_pin = 2
    go_to(7)
    before, frames = without_shapes(obj), (1, 4, 7, 13, 18, 25)
    outline = {frame: rim(obj, frame) for frame in frames}
    places = held(obj)
    go_to(7)
    remesh(obj, vertices=900)
    assert without_shapes(obj) == before
    assert stale(obj) == []
    for frame in frames:
        corners = rim(obj, frame)
        gaps = np.linalg.norm(outline[frame][:, None] - corners[None], axis=2).min(axis=1)
        assert gaps.max() < 0.05, frame  # of a drawing of 2 x 1, to its nearest vertex
        assert measured(obj).flipped == 0
    assert_in_place(obj, places)


def rim(obj, frame):
    """Where the corners and the middles of the sides are shown, in the world."""
    shown, rest = shown_at(obj, frame), coordinates(obj.data.shape_keys.reference_key.data)
    axes = np.argsort(np.ptp(rest, axis=0))[1:]
    flat = rest[:, np.sort(axes)]
    flat = (flat - flat.min(axis=0)) / np.ptp(flat, axis=0)
    marks = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0), (0.5, 1)])
    return world(obj, shown[[np.linalg.norm(flat - mark, axis=1).argmin() for mark in marks]])


def test_generate_finds_nothing_to_do_and_goes_on_after_a_change():
    obj = keyed()
    remesh(obj, vertices=700)
    count = len(obj.data.shape_keys.key_blocks)
    shapes = stored(obj)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert len(obj.data.shape_keys.key_blocks) == count
    pull(obj, 13, (0.1, 0.2))
    assert stale(obj) == [(0, 1), (1, 2)]
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert stale(obj) == []
    assert stored(obj) != shapes


def test_what_was_out_of_date_stays_so():
    obj = keyed()
    pull(obj, 25, (0.2, 0.1))
    before = stale(obj)
    assert before
    remesh(obj, vertices=700)
    assert stale(obj) == before


def test_repeated_poses_go_on_following():
    obj = coarse_bar()
    key(obj, 1)
    pull(obj, 13, (-0.3, 0.7))
    curve_of(obj).keyframe_points.insert(25, obj.planar.poses[0].at).interpolation = "LINEAR"
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    copies = [pose.copy_of for pose in obj.planar.poses]
    assert any(copies)
    assert stale(obj) == []
    remesh(obj, vertices=600)
    assert [pose.copy_of for pose in obj.planar.poses] == copies
    assert stale(obj) == []
    pull(obj, 1, (0.05, 0.3))
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert np.abs(shown_at(obj, 1) - shown_at(obj, 25)).max() < 1e-6


def test_a_pose_that_is_not_keyed_is_shown_on():
    obj = keyed()
    go_to(13)
    go_to(5)
    from planar_deform.scene.sequence import pose_state

    assert bpy.ops.planar.drag_pins(offset=(0.0, -0.2)) == {"FINISHED"}
    assert pose_state.unkeyed(obj)
    shown = corner_places(obj)[:, :2]
    remesh(obj, vertices=700)
    assert pose_state.unkeyed(obj)
    now = corner_places(obj)[:, :2]
    assert np.abs([shown.min(axis=0) - now.min(axis=0), shown.max(axis=0) - now.max(axis=0)]).max() < 0.02


@pytest.mark.parametrize("name", ["horse", "elephant"])
def test_bent_poses_of_characters_have_no_turned_triangles(name):
    obj = character(name)
    left, middle, right = extremes(obj)
    add_pins(obj, [left], [middle], [right])
    size = max(obj.dimensions)
    key(obj, 1)
    pull(obj, 9, (-0.2 * size, 0.3 * size))
    pull(obj, 17, (-0.5 * size, -0.2 * size))
    flipped = {frame: (go_to(frame), measured(obj).flipped)[1] for frame in (1, 9, 17)}
    for count in (600, 1500):
        remesh(obj, vertices=count)
        for frame, before in flipped.items():
            go_to(frame)
            assert measured(obj).flipped <= before


def test_undo_and_redo_bring_all_back_to_the_bit():
    obj = keyed()
    group(obj, "Weights", lambda co: co.x / 3.0)
    obj.data.uv_layers.new(name="Map")

    def state(obj):
        members = [[(g.group, g.weight) for g in v.groups] for v in obj.data.vertices]
        pins = [
            (pin.name, pin.group, pin.has_target, tuple(pin.target), tuple(pin.reached), pin.angle)
            for pin in obj.planar.pins
        ]
        places = [(p.name, tuple(p.place), p.even) for p in obj.data.planar_seen.places]
        faces = [tuple(face.vertices) for face in obj.data.polygons]
        uvs = [tuple(uv.vector) for uv in obj.data.uv_layers[0].uv]
        return everything(obj), members, pins, places, tuple(obj.data.planar_seen.counts), faces, uvs

    history = History(state)
    for count in (800, 300):
        activate(bpy.data.objects["Cutout"])
        history.did(bpy.ops.planar.remesh(source="OUTLINE", vertices=count))
    history.undo_all()
    history.redo_all()
    history.undo_all()


def test_a_duplicate_is_left_alone_and_a_file_brings_all_back(tmp_path):
    obj = keyed()
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy != obj
    shown = shown_at(copy, 7)
    before = everything(copy)
    remesh(obj, vertices=700)
    obj.name = "Renamed"
    assert everything(copy) == before
    assert np.array_equal(shown_at(copy, 7), shown)
    made, frames = without_shapes(obj), [shown_at(obj, frame) for frame in (1, 7, 25)]
    path = str(tmp_path / "remeshed.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Renamed"]
    assert without_shapes(obj)[0] == made[0]
    for frame, was in zip((1, 7, 25), frames, strict=True):
        assert np.array_equal(shown_at(obj, frame), was)
    assert stale(obj) == []
    activate(obj)
    remesh(obj, vertices=400)
    assert stale(obj) == []


def test_edits_by_hand_and_moves_after_it_are_followed():
    """Applied transforms take poses and pins along, as they do on a mesh that was always that one."""
    obj = keyed()
    remesh(obj, vertices=500)
    obj.scale, obj.rotation_euler.z = (2.0, 2.0, 2.0), 0.5
    activate(obj)
    places = held(obj)
    go_to(13)
    shown = world(obj, shown_at(obj, 13))
    assert bpy.ops.object.transform_apply(location=False, rotation=True, scale=True) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert np.abs(world(obj, shown_at(obj, 13)) - shown).max() < 1e-5
    assert stale(obj) == []
    assert len(held(obj)) == len(places)
