# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens of meshes of edges and of poly curves are the module's, in any plane, under any transform."""

import bpy
import numpy as np
import pytest
from outlines import CURVES, MESHES, PLACED, chain, edges_of, lines
from sequences import go_to, same, shown_at, stored, timing
from support import TRANSFORMS, activate, evaluated, grid, make_object

import planar_native

FRAMES = (1, 9, 21)


def swirl(obj, angle):
    """Turn the shown shape about its centre, the farther out the more."""
    from planar_deform.scene.objects.any_object import begin_shape

    activate(obj)
    drawing = begin_shape(bpy.context)
    points = drawing.positions @ np.array([1.0, 1.0j])
    arms = points - points.mean()
    points = points.mean() + arms * np.exp(1.0j * angle * (0.7 + np.abs(arms) / drawing.diagonal))
    drawing.write(np.stack([points.real, points.imag], axis=1))


def posed(obj):
    """Three poses, each keyed; what each frame of theirs shows."""
    shapes = {}
    for frame, angle in zip(FRAMES, (0.0, 1.2, -0.8), strict=True):
        go_to(frame)
        swirl(obj, angle)
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
        shapes[frame] = evaluated(obj)
    return shapes


def generate(**settings):
    assert bpy.ops.planar.generate_inbetweens(**settings) == {"FINISHED"}


def solved(obj, shapes, edges, **arguments):
    """World positions of all points at each whole frame, from the module: frame -> count x 3."""
    matrix = np.array(obj.matrix_world, float)
    world = {frame: shape.astype(float) @ matrix[:3, :3].T for frame, shape in shapes.items()}
    joined = np.unique(edges)
    compact = np.searchsorted(joined, edges).astype(np.int32)
    first = world[FRAMES[0]][joined]
    parts = connected(len(joined), compact)
    arms = first - np.stack([first[parts == part].mean(axis=0) for part in range(parts.max() + 1)])[parts]
    plane = np.linalg.svd(arms)[2][:2]
    keys = np.stack([world[frame][joined] @ plane.T for frame in FRAMES])
    frames = np.arange(FRAMES[0], FRAMES[-1] + 1)
    flat = planar_native.inbetween(
        keys,
        frames.astype(float),
        edges=compact,
        key_times=np.array(FRAMES, float),
        rest=keys[0],
        **arguments,
    )
    result = {}
    for frame, positions in zip(frames.tolist(), flat, strict=True):
        after = next(i for i, at in enumerate(FRAMES) if at >= max(frame, FRAMES[1]))
        low, high = FRAMES[after - 1], FRAMES[after]
        share = (frame - low) / (high - low)
        result[frame] = (1 - share) * world[low] + share * world[high]
        result[frame][joined] += (positions - result[frame][joined] @ plane.T) @ plane
    return result


def connected(count, edges):
    parts = np.arange(count)
    while True:
        low = parts[edges].min(axis=1)
        before = parts.copy()
        np.minimum.at(parts, edges[:, 0], low)
        np.minimum.at(parts, edges[:, 1], low)
        if np.array_equal(parts, before):
            return np.unique(parts, return_inverse=True)[1]


@pytest.mark.parametrize("transform", ["none", "stretched", "mirrored", "huge and far"])
@pytest.mark.parametrize(("kind", "plane"), PLACED)
def test_each_frame_shows_what_the_module_gives(kind, plane, transform):
    obj = lines(kind, plane)
    obj.matrix_world = TRANSFORMS[transform]
    shapes = posed(obj)
    before = stored(obj)
    generate()
    expected = solved(obj, shapes, edges_of(kind))
    size = np.linalg.norm(np.ptp(np.concatenate(list(expected.values())), axis=0))
    matrix = np.array(obj.matrix_world, float)[:3, :3]
    apart = 0.0
    for frame, places in expected.items():
        shown = shown_at(obj, frame)
        if frame in FRAMES:
            assert same(shown, shapes[frame])
        else:
            assert np.abs(shown @ matrix.T - places).max() < 1e-6 * size
            apart = max(apart, np.abs(shown - shapes[9]).max())
    assert apart > 0.0
    go_to(21)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert stored(obj) == before


@pytest.mark.parametrize("kind", ["lines in parallel planes", "3D curve"])
def test_generated_frames_keep_lengths_that_blending_shrinks(kind):
    obj = lines(kind)
    posed(obj)
    edges = edges_of(kind)

    def length():
        ends = evaluated(obj)[edges].astype(float)
        return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum()

    go_to(15)
    blended = length()
    generate()
    go_to(15)
    keyed = []
    generated = length()
    for frame in FRAMES[1:]:
        go_to(frame)
        keyed.append(length())
    assert blended < 0.95 * min(keyed)
    assert generated > 0.99 * min(keyed)


def test_radius_and_tilt_go_along_in_generated_frames():
    obj = lines("3D curve")
    posed(obj)
    second, third = obj.data.shape_keys.key_blocks[-2:]
    for point in third.data:  # as in Edit Mode
        point.radius, point.tilt = 3.0 * point.radius, point.tilt + 1.2
    start, end = (points_of(block) for block in (second, third))
    before = stored(obj)
    generate()
    blocks = obj.data.shape_keys.key_blocks
    behind = blocks.find(obj.planar.poses[1].name) + 1
    count = FRAMES[2] - FRAMES[1] - 1
    assert blocks[behind + count].name == obj.planar.poses[2].name
    for number, block in enumerate(blocks[behind : behind + count], 1):
        assert points_of(block) == pytest.approx(start + (end - start) * number / 12, abs=1e-5)
    assert bpy.ops.planar.remove_inbetweens() == {"FINISHED"}
    assert stored(obj) == before


def points_of(block):
    return np.array([(point.radius, point.tilt) for point in block.data])


@pytest.mark.parametrize("kind", [MESHES[1], CURVES[1]])
def test_undone_saved_and_cleared(kind, tmp_path):
    obj = lines(kind)
    fresh = stored(obj)
    shapes = posed(obj)
    bpy.ops.ed.undo_push(message="Keyed")
    before = stored(obj)
    generate()
    bpy.ops.ed.undo_push(message="Generated")
    after, keys = stored(obj), timing(obj)
    assert len(keys) == 3
    bpy.ops.ed.undo()
    assert stored(bpy.data.objects["Cutout"]) == before
    bpy.ops.ed.redo()
    assert stored(bpy.data.objects["Cutout"]) == after
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "file.blend"))
    obj = bpy.data.objects["Cutout"]
    assert stored(obj) == after
    shown = shown_at(obj, 15)
    generate()
    assert same(shown_at(obj, 15), shown)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert same(evaluated(obj), shapes[1])
    assert obj.data.shape_keys is None
    assert fresh[1] == stored(obj)[1]


@pytest.mark.parametrize("kind", [MESHES[0], CURVES[1]])
def test_a_pose_edited_in_edit_mode_makes_its_stretches_stale(kind):
    from planar_deform.scene.sequence import stretches

    obj = lines(kind)
    posed(obj)
    generate()
    assert stretches.stale(obj) == []
    go_to(15)  # a generated frame
    shown = evaluated(obj)
    go_to(1)
    bpy.ops.object.mode_set(mode="EDIT")
    (bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve).select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.5, 0.0, 0.0))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert stretches.stale(obj) == [(0, 1)]
    old = shown_at(obj, 5)
    generate()
    assert stretches.stale(obj) == []
    assert np.abs(shown_at(obj, 5) - old - [0.25, 0.0, 0.0]).max() < 0.01
    assert np.abs(shown_at(obj, 15) - shown).max() < 1e-6


@pytest.mark.parametrize("kind", ["edge soup", "3D curve"])
def test_breakdown_and_thinning(kind):
    obj = lines(kind)
    shapes = posed(obj)
    go_to(5)
    assert bpy.ops.planar.breakdown(percent=50.0) == {"FINISHED"}
    middle = evaluated(obj)
    generate()
    assert same(shown_at(obj, 5), middle)
    # The breakdown is on the way: without it, the same frames come out.
    with_it = [shown_at(obj, frame) for frame in range(1, 22)]
    assert bpy.ops.planar.thin_poses(tolerance=0.02) == {"FINISHED"}
    assert len(timing(obj)) == 3
    for frame, shape in enumerate(with_it, 1):
        assert np.abs(shown_at(obj, frame) - shape).max() < 0.02 * max(obj.dimensions)
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())


@pytest.mark.parametrize("kind", ["edge soup", "3D curve"])
def test_an_edited_sequence_and_its_transfer(kind):
    obj = lines(kind)
    posed(obj)
    generate()
    go_to(5)
    swirl(obj, 0.2)
    posed_there = evaluated(obj)
    assert bpy.ops.planar.edit_sequence() == {"FINISHED"}
    assert same(shown_at(obj, 5), posed_there)
    target = lines(kind, name="Target")
    target.location.x = 9.0
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.planar.transfer_motion() == {"FINISHED"}
    for frame in range(1, 22):
        assert np.abs(shown_at(target, frame) - shown_at(obj, frame)).max() < 1e-6


@pytest.mark.parametrize("to", ["SHAPES", "RELATIVE_KEYS"])
def test_a_baked_curve_keeps_its_radii(to):
    obj = lines("3D curve")
    posed(obj)
    for point in obj.data.shape_keys.key_blocks[-1].data:  # as in Edit Mode
        point.radius *= 3.0
    generate()
    frames = range(1, 22, 4)
    shown = {frame: (shown_at(obj, frame), tube(obj)) for frame in frames}
    assert bpy.ops.planar.bake(to=to, frame_start=1, frame_end=21, frame_step=4) == {"FINISHED"}
    for frame, (shape, thick) in shown.items():
        assert np.abs(shown_at(obj, frame) - shape).max() < 1e-6
        assert np.abs(tube(obj) - thick).max() < 1e-5


def tube(obj):
    """The surface of the curve made thick, which tells its radii."""
    obj.data.bevel_depth = 0.1
    surface = evaluated(obj)
    obj.data.bevel_depth = 0.0
    return surface


@pytest.mark.parametrize("kind", ["edge soup", "3D curve"])
def test_what_panels_ask_in_edit_mode_while_points_are_added(kind):
    from planar_deform.scene.objects.any_object import shape_refusal
    from planar_deform.scene.sequence import stretches
    from planar_deform.scene.view import onion

    obj = lines(kind)
    posed(obj)
    generate()
    obj.planar.show_onion = True
    edits = bpy.ops.mesh if obj.type == "MESH" else bpy.ops.curve
    bpy.ops.object.mode_set(mode="EDIT")
    edits.select_all(action="SELECT")
    edits.subdivide()
    bpy.context.view_layer.update()
    assert stretches.stale(obj) == []  # as long as Edit Mode has not been left
    assert "Object Mode" in shape_refusal(obj)
    onion.of_active(bpy.context)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert stretches.stale(obj) == [(0, 1), (1, 2)]


def test_lines_that_hang_on_a_mesh_with_faces_are_blended():
    vertices, faces = grid(4, 2)
    count = len(vertices)
    tail = [(2.0 + 0.3 * i, 0.5, 0.0) for i in range(1, 5)]
    middle = 9  # of the right side
    obj = make_object(np.concatenate([vertices, tail]), faces.tolist(), [(middle, count), *chain(4, count)])
    shapes = posed(obj)
    for point in obj.data.shape_keys.key_blocks[-1].data[count:]:
        point.co.y += 0.5
    shapes[21] = shown_at(obj, 21)
    generate()
    assert all(same(shown_at(obj, frame), shape) for frame, shape in shapes.items())
    blended = shapes[9] + (shapes[21] - shapes[9]) / 2
    middle = shown_at(obj, 15)
    assert np.abs(middle[count:] - blended[count:]).max() < 1e-6
    assert np.abs(middle[:count] - blended[:count]).max() > 0.01
