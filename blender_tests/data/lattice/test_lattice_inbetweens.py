# SPDX-License-Identifier: GPL-3.0-or-later
"""What is between the poses of a lattice: generated, broken down, thinned and edited."""

import bpy
import numpy as np
import pytest
from filling import stale
from lattice_poses import (
    bend,
    keyed,
    length,
    length_of,
    place_of,
    rest_of,
    shown,
    shown_at,
    stored,
    two_layers,
)
from lattice_scenes import lattice, layered, pin_at, points, solid
from sequences import go_to
from support import TRANSFORMS, activate, coordinates, evaluated, world


def test_what_is_posed_between_keys_goes_with_the_frame_until_it_is_keyed():
    cage, back, front = layered()
    pin_at(front, 3)
    keyed(cage, (back, front), {1: 0.3, 9: -0.6})
    go_to(5)
    between = shown(back, front)
    assert bpy.ops.planar.drag_pins(offset=(0.3, 0.2)) == {"FINISHED"}
    assert not np.array_equal(evaluated(front), between[1])
    go_to(6)
    for now, then in zip(shown_at((back, front), 5), between, strict=True):
        np.testing.assert_array_equal(now, then)


@pytest.mark.parametrize("build", [layered, two_layers])
@pytest.mark.parametrize("transform", ["none", "rotated", "stretched", "mirrored"])
def test_in_betweens_swing_and_what_is_keyed_stays(build, transform):
    cage, *objects = build(matrix=TRANSFORMS[transform])
    poses = keyed(cage, objects, {1: 0.01, 13: (0.5, 2.2)})
    activate(cage)
    lengths = {}
    for way in ("blended", "generated"):
        if way == "generated":
            assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
        go_to(7)
        lengths[way] = length(cage)
    straight = length_of(rest_of(cage))
    assert lengths["blended"] < 0.6 * straight
    assert abs(lengths["generated"] - straight) < 0.02 * straight
    for frame, pose in poses.items():
        for now, then in zip(shown_at(objects, frame), pose, strict=True):
            np.testing.assert_allclose(now, then, atol=2e-6 * max(1.0, np.abs(then).max()))
    generated = shown_at(objects, 7)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert not np.allclose(shown_at(objects, 7)[0], generated[0], atol=1e-2)


@pytest.mark.parametrize("path", ["STRAIGHT", "ARC"])
@pytest.mark.parametrize("smooth", [False, True])
def test_a_pin_that_stands_in_both_poses_stands_between_them(path, smooth):
    cage, back, front = layered()
    pin_at(back, 14)
    pin_at(front, 20)
    held = place_of(back, [14])
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(13)
    bpy.ops.planar.rotate_pins(angle=1.2, pivot=held.tolist())
    bpy.ops.planar.drag_pins(offset=(-0.5, 0.9))
    size = np.linalg.norm(np.ptp(world(back, evaluated(back)), axis=0))
    start = np.linalg.norm(place_of(back, [14]) - held)
    assert start < 6e-3
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    poses = {frame: shown_at((back, front), frame) for frame in (1, 13)}
    assert bpy.ops.planar.generate_inbetweens(path=path, smooth=smooth) == {"FINISHED"}
    for frame in range(2, 13):
        go_to(frame)
        assert np.linalg.norm(place_of(back, [14]) - held) < start + 1e-4 * size
    for frame, pose in poses.items():
        for now, then in zip(shown_at((back, front), frame), pose, strict=True):
            np.testing.assert_allclose(now, then, atol=2e-6)
    assert len(cage.planar.pins) == 2


def test_several_pins_of_a_lattice_stand_each():
    _, back, front = layered()
    for vertex in (0, 4):
        pin_at(back, vertex)
    pin_at(front, 20)
    size = np.linalg.norm(np.ptp(world(back, evaluated(back)), axis=0))
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(13)
    bpy.ops.planar.drag_pins(offset=(-0.5, 0.9))
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    held = [place_of(back, [vertex]) for vertex in (0, 4)]
    go_to(1)
    gap = max(np.linalg.norm(place_of(back, [v]) - place) for v, place in zip((0, 4), held, strict=True))
    assert gap < 1e-3 * size
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    for frame in range(2, 13):
        go_to(frame)
        for vertex, place in zip((0, 4), held, strict=True):
            assert np.linalg.norm(place_of(back, [vertex]) - place) < gap + 2e-4 * size


def test_a_pin_of_a_lattice_goes_on_its_path():
    _, back, front = layered()
    pin_at(back, 0)
    pin_at(front, 20)
    ends = []
    for frame, offset in ((1, (0.0, 0.0)), (13, (-0.5, 0.9))):
        go_to(frame)
        bpy.ops.planar.drag_pins(offset=offset)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
        ends.append(place_of(front, [20]))
    assert bpy.ops.planar.add_pin_path(pin=1, pose=0) == {"FINISHED"}
    bpy.context.object.planar.pins[1].paths[0].ease = "EASE_IN"
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    size = np.linalg.norm(np.ptp(world(back, evaluated(back)), axis=0))
    for frame in range(2, 13):
        go_to(frame)
        wanted = ends[0] + ((frame - 1) / 12) ** 2 * (ends[1] - ends[0])
        assert np.linalg.norm(place_of(front, [20]) - wanted) < 1e-3 * size


def test_a_point_of_the_lattice_that_is_pinned_stands_too():
    cage, back, _ = layered()
    assert bpy.ops.planar.add_pin(lattice_point=31) == {"FINISHED"}
    pin_at(back, 12)
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    held = points(cage)[31]
    go_to(13)
    bpy.ops.planar.drag_pins(offset=(-0.9, 1.2))
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    block = cage.data.shape_keys.key_blocks[cage.planar.poses[1].name]
    end = np.array(block.data[31].co)
    for inbetween in cage.data.shape_keys.key_blocks[3:-1]:
        gap = np.abs(np.array(inbetween.data[31].co) - held).max()
        assert gap <= np.abs(end - held).max() + 1e-4


def test_in_betweens_are_stale_when_other_pins_hold_the_lattice():
    cage, back, front = layered()
    pin_at(back, 14)
    pin_at(front, 20)
    keyed(cage, (back, front), {1: 0.3, 13: (0.5, 1.0)})
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert stale(cage) == []
    cage.planar.pins[0].enabled = False
    bpy.context.view_layer.update()
    assert stale(cage) == [(0, 1)]
    cage.planar.pins[0].enabled = True
    assert stale(cage) == []
    assert bpy.ops.planar.add_pin(lattice_point=0) == {"FINISHED"}
    assert stale(cage) == [(0, 1)]


def test_equal_layers_stay_equal_in_between_and_a_pin_stands():
    cage, drawing = two_layers()
    pin_at(drawing, 14)
    pin_at(drawing, 90)
    held = place_of(drawing, [14])
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(13)
    bpy.ops.planar.rotate_pins(angle=1.2, pivot=held.tolist())
    start = np.linalg.norm(place_of(drawing, [14]) - held)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    for block in cage.data.shape_keys.key_blocks:
        first, second = coordinates(block.data).reshape(2, -1, 3)
        np.testing.assert_allclose(first[:, :2], second[:, :2], atol=1e-6)
        np.testing.assert_allclose(second[:, 2] - first[:, 2], 1.0, atol=1e-6)
    for frame in range(2, 13):
        go_to(frame)
        assert np.linalg.norm(place_of(drawing, [14]) - held) < start + 3e-4


def test_a_key_with_cells_turned_over_does_not_hinder_in_betweens():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.3, 9: -1.2})
    for block in cage.data.shape_keys.key_blocks:
        if block.name == cage.planar.poses[1].name:
            block.data[40].co.x += 0.4
            block.data[41].co = block.data[42].co
    go_to(9)
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    assert np.isfinite(shown_at(objects, 5)[0]).all()


def test_depth_between_poses_goes_in_proportion():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.3, 9: -1.2})
    for point in cage.data.shape_keys.key_blocks[cage.planar.poses[1].name].data:
        point.co.z += 0.8
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    go_to(1)
    start = shown(*objects)[0][:, 2]
    heights = [np.median(shown_at(objects, frame)[0][:, 2] - start) for frame in (3, 5, 9)]
    scale = heights[2]
    np.testing.assert_allclose(heights, scale * np.array([0.25, 0.5, 1.0]), atol=1e-5)


def test_of_a_lattice_in_space_blenders_blend_is_told_and_a_breakdown_lies_on_it():
    cage, sheet = solid()
    keyed(cage, [sheet], {1: 0.3, 9: -1.2})
    activate(cage)
    with pytest.raises(RuntimeError, match="is a lattice in space, between whose poses Blender blends"):
        bpy.ops.planar.generate_inbetweens()
    go_to(5)
    start, end = shown_at([sheet], 1)[0], shown_at([sheet], 9)[0]
    go_to(5)
    assert bpy.ops.planar.breakdown(percent=25.0) == {"FINISHED"}
    np.testing.assert_allclose(evaluated(sheet), 0.75 * start + 0.25 * end, atol=2e-6)
    assert [pose.frame for pose in cage.planar.poses] == [1, 5, 9]


def test_a_breakdown_of_a_flat_lattice_swings():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.01, 13: (0.5, 2.2)})
    activate(cage)
    go_to(7)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    straight = length_of(rest_of(cage))
    assert abs(length(cage) - straight) < 0.02 * straight


@pytest.mark.parametrize("build", [layered, two_layers])
def test_a_row_of_poses_is_thinned_and_one_frame_of_it_edited(build):
    cage, *objects = build()
    keyed(cage, objects, {1: 0.1, 13: (0.5, 1.2)})
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    before = {frame: shown_at(objects, frame) for frame in range(1, 14)}
    assert bpy.ops.planar.bake(to="SHAPES", frame_start=1, frame_end=13) == {"FINISHED"}
    assert len(cage.planar.poses) == 13
    assert bpy.ops.planar.thin_poses(tolerance=0.01) == {"FINISHED"}
    assert len(cage.planar.poses) < 6
    for frame, then in before.items():
        for now, was in zip(shown_at(objects, frame), then, strict=True):
            np.testing.assert_allclose(now, was, atol=0.1)
    keys = shown_at(objects, 1), shown_at(objects, 13)
    go_to(6)
    bend(cage, 0.8, 0.9)
    wanted = shown(*objects)
    assert bpy.ops.planar.edit_sequence(keep_poses=True) == {"FINISHED"}
    for now, then in zip(shown_at(objects, 6), wanted, strict=True):
        np.testing.assert_allclose(now, then, atol=1e-4)
    for frame, then in zip((1, 13), keys, strict=True):
        for now, was in zip(shown_at(objects, frame), then, strict=True):
            np.testing.assert_array_equal(now, was)


@pytest.mark.parametrize("name", ["generate_inbetweens", "edit_sequence", "thin_poses", "transfer_motion"])
def test_what_solves_between_poses_is_refused_in_space_and_nothing_changes(name):
    cage, sheet = solid()
    twin = lattice((6, 5, 4), (1, 1, 1), (9, 0, 0), "Twin")
    keyed(cage, [sheet], {1: 0.3, 5: 0.1, 9: -1.2})
    go_to(6)
    bend(cage, 0.8)
    twin.select_set(True)
    before, shows = stored(cage), shown(sheet)
    with pytest.raises(RuntimeError, match="is a lattice in space"):
        getattr(bpy.ops.planar, name)()
    assert stored(cage) == before
    np.testing.assert_array_equal(shown(sheet), shows)
    assert twin.data.shape_keys is None


def test_the_headless_command_fills_in_flat_lattices_and_leaves_others_to_blender(capsys):
    from planar_deform import batch

    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: (0.5, 1.2)})
    space, sheet = solid()
    space.name = "Space"
    keyed(space, [sheet], {1: 0.1, 9: 0.5})
    assert batch.run(["--generate"]) == batch.DONE
    assert len(cage.data.shape_keys.key_blocks) == 2 + 9
    assert len(space.data.shape_keys.key_blocks) == 2 + 2
    assert batch.run(["--generate", "--object", "Space"]) == batch.FAILED
    assert "is a lattice in space" in capsys.readouterr().err
    assert batch.run(["--bake", "SHAPES", "--object", "Space", "--start", "1", "--end", "9"]) == batch.DONE
    assert len(space.planar.poses) == 9


def test_undo_of_a_frame_change_brings_an_unkeyed_pose_back():
    cage, *objects = layered()
    keyed(cage, objects, {1: 0.1, 9: 1.2})
    go_to(5)
    bpy.ops.ed.undo_push(message="Frame")
    bend(cage, 2.0)
    bpy.ops.ed.undo_push(message="Drag")
    then = shown(*objects)
    go_to(6)
    bpy.ops.ed.undo_push(message="Frame")
    bpy.ops.ed.undo()
    objects = [bpy.data.objects[name] for name in ("Back", "Front")]
    for now, was in zip(shown(*objects), then, strict=True):
        np.testing.assert_array_equal(now, was)
