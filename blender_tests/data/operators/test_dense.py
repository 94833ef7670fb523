# SPDX-License-Identifier: GPL-3.0-or-later
"""Dense drawings: what is read and made at a press, a move and a release, and what is solved coarsely."""

from collections import Counter

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from sequences import go_to, shown_at
from support import TRANSFORMS, activate, add_pins, coordinates, grid, make_object

SIDE = 91  # vertices a side, 8281: more than are solved themselves


def sheet(side=9, *, name="Sheet"):
    """As importers leave it, turned and scaled; of quads, with pins in its corners, the last one selected."""
    vertices, faces = grid(side - 1, side - 1, 4.0, 4.0)
    obj = make_object(vertices, faces.tolist(), name=name)
    obj.matrix_world = Matrix.Translation((0.3, -1.0, 2.0)) @ TRANSFORMS["rotated"]
    add_pins(obj, [0], [side - 1], [side * (side - 1)], [side * side - 1])
    activate(obj)
    return obj


def shape(obj):
    return coordinates(obj.data.vertices)


@pytest.fixture
def made(monkeypatch):
    """How often what takes long on a dense mesh has been done."""
    from planar_deform import native
    from planar_deform.model.posing import pins
    from planar_deform.scene.objects import cutout_object, triangulation
    from planar_deform.scene.storage import digests, vertex_groups

    counts = Counter()

    def count(module, name):
        original = getattr(module, name)

        def counted(*of, **more):
            counts[name] += 1
            return original(*of, **more)

        monkeypatch.setattr(module, name, counted)

    count(vertex_groups, "_read")
    count(cutout_object, "read")
    count(cutout_object, "plane_of")
    count(cutout_object, "make_cutout")
    count(triangulation, "_faces")
    count(digests, "digest")
    count(pins, "nearest_point")
    count(native, "distortion")
    return counts


def begun():
    from planar_deform.operators.modal.several_posing import begin

    return begin(bpy.context, 3)


def shown():
    from planar_deform.scene.view import snapshot

    return snapshot.of_active(bpy.context)


def released(posing, solved):
    """What a session does when the drawing has settled, and Blender after it."""
    from planar_deform.scene import follow
    from planar_deform.scene.view import snapshot

    posing.show(solved)
    bpy.context.view_layer.update()
    posing.finish(solved)
    snapshot.release()
    follow.match(bpy.context.object)
    bpy.context.view_layer.update()


def test_what_is_drawn_is_read_once_for_the_press_too(made):
    sheet()
    bpy.context.view_layer.update()
    shown()
    assert made.pop("_read") == 1, "the weights of all groups in one pass"
    made.clear()
    posing = begun()
    assert posing.model is not None
    assert made == {"read": 1, "distortion": 1}, "of a mesh that is as it was drawn nothing is made anew"


def test_a_move_reads_nothing_and_a_release_reads_once(made):
    sheet()
    bpy.context.view_layer.update()
    shown()
    posing = begun()
    posing.model.move(0.1, 0.2, 0.0)
    made.clear()
    for step in range(3):
        posing.model.move(0.1, 0.2 + 0.1 * step, 0.0)
        posing.show(posing.model.solved())
        bpy.context.view_layer.update()
        shown()
    assert made == {}, "moves only write"
    released(posing, posing.model.solved())
    shown()
    assert made == {"read": 1, "plane_of": 1}, "the shape is another one, rest and weights are not"
    made.clear()
    posing = begun()
    assert made == {"read": 1}, "a later press finds what was drawn, and asks for no distortion"
    posing.click()


def test_weights_that_somebody_else_changes_during_a_drag_are_read(made):
    from planar_deform.scene.pins.pin_list import model_pins

    obj = sheet()
    bpy.context.view_layer.update()
    shown()
    posing = begun()
    posing.model.move(0.1, 0.2, 0.0)
    posing.show(posing.model.solved())
    bpy.context.view_layer.update()
    obj.vertex_groups[0].add([7], 1.0, "REPLACE")
    bpy.context.view_layer.update()
    released(posing, posing.model.solved())
    posing = begun()
    assert model_pins(obj, posing.drawing)[0].vertices.tolist() == [0, 7]
    posing.click()


def test_what_is_kept_never_outlives_what_it_is_of():
    """Each reading is the one that a file just loaded gives, whatever was done before it."""
    from planar_deform.scene.objects import cutout_object, triangulation
    from planar_deform.scene.objects.cutout_object import read_cutout
    from planar_deform.scene.pins import pin_list
    from planar_deform.scene.storage import vertex_groups

    obj = sheet()

    def read():
        bpy.context.view_layer.update()
        drawing = read_cutout(obj)
        pins = pin_list.model_pins(obj, drawing)
        return drawing, pins

    def same(one, other):
        (drawing, pins), (anew, pins_anew) = one, other
        for name in ("rest", "triangles", "parts", "stiffness"):
            assert np.array_equal(getattr(drawing.cutout, name), getattr(anew.cutout, name)), name
        assert drawing.cutout.cage == anew.cutout.cage
        assert np.array_equal(drawing.positions, anew.positions)
        assert np.array_equal(drawing.distortion.triangle_area, anew.distortion.triangle_area)
        assert [pin.vertices.tolist() for pin in pins] == [pin.vertices.tolist() for pin in pins_anew]
        assert [pin.weights.tolist() for pin in pins] == [pin.weights.tolist() for pin in pins_anew]

    def painted():
        group = obj.vertex_groups.new(name="Stiff")
        group.add([40, 41], 1.0, "REPLACE")
        obj.planar.stiffness_group = "Stiff"

    def renamed():
        first, last = obj.vertex_groups[0], obj.vertex_groups[1]
        names = first.name, last.name
        obj.vertex_groups.remove(first)
        last.name = names[0]

    def edited():
        obj.data.vertices[40].co.y += 0.125
        obj.data.update()

    def turned():
        obj.rotation_euler.z += 0.5

    def mirrored():
        obj.scale.x = -1.0

    def denser():
        import bmesh

        mesh = bmesh.new()
        mesh.from_mesh(obj.data)
        bmesh.ops.subdivide_edges(mesh, edges=mesh.edges[:], cuts=1, use_grid_fill=True)
        mesh.to_mesh(obj.data)
        mesh.free()

    def weighted():
        obj.vertex_groups[1].add([12], 0.5, "REPLACE")

    def posed():
        assert bpy.ops.planar.drag_pins(offset=(0.3, 0.2)) == {"FINISHED"}

    def other_rest():
        assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}

    read()
    for change in (posed, edited, painted, weighted, renamed, turned, mirrored, posed, other_rest, denser):
        change()
        kept = read()
        for module in (cutout_object, triangulation, vertex_groups):
            module.forget()
        same(kept, read())


def test_weights_of_a_hidden_object_are_never_taken_for_what_they_were():
    """Blender tells nothing of what is done to it."""
    from planar_deform.scene.storage.vertex_groups import members

    obj = sheet()
    name = obj.vertex_groups[0].name
    obj.hide_set(True)
    bpy.context.view_layer.update()
    assert members(obj, [name])[name][0].tolist() == [0]
    obj.vertex_groups[0].add([5], 0.5, "REPLACE")
    bpy.context.view_layer.update()
    assert members(obj, [name])[name][0].tolist() == [0, 5]


@pytest.mark.parametrize("group", [[40], [40, 41], [40, 41, 50], range(30, 60), [0, 80]])
def test_a_pins_place_is_the_middle_of_its_group(group):
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.pins import pin_list

    obj = sheet()
    add_pins(obj, group)
    drawing = begin(bpy.context)
    pin = pin_list.model_pins(obj, drawing)[-1]
    place = Holder(pin, drawing.cutout).place(drawing.cutout.rest)
    assert place == pytest.approx(drawing.cutout.rest[list(group)].mean(axis=0), abs=1e-6)


# ---- solved by a cage


@pytest.fixture
def dense():
    return sheet(SIDE)


def last_place(obj):
    """Where the last pin's vertex is in the world."""
    return np.array(obj.matrix_world @ obj.data.vertices[SIDE * SIDE - 1].co)


def size_of(obj):
    corners = np.array([obj.matrix_world @ obj.data.vertices[row].co for row in (0, SIDE * SIDE - 1)])
    return float(np.linalg.norm(corners[1] - corners[0]))


def test_a_dense_drawing_is_solved_by_a_cage_and_says_so(dense):
    from planar_deform.scene.objects.cutout_object import begin
    from planar_deform.scene.storage.cage import VERTICES, cage_of

    assert begin(bpy.context).cutout.cage == cage_of(dense) == VERTICES
    dense.planar.coarse_above = SIDE * SIDE
    assert cage_of(dense) is None
    assert begin(bpy.context).cutout.cage is None
    small = sheet(name="Small")
    assert cage_of(small) is None
    lattice = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    assert cage_of(lattice) is None


def test_the_cage_poses_as_the_drawing_itself(dense):
    rest = shape(dense)
    assert bpy.ops.planar.drag_pins(offset=(-0.6, 0.5)) == {"FINISHED"}
    caged = shape(dense)
    assert dense.planar.solved_stiffness == "neutral"
    bpy.ops.planar.reset_to_rest()
    assert np.array_equal(shape(dense), rest)
    dense.planar.coarse_above = 20_000
    assert bpy.ops.planar.drag_pins(offset=(-0.6, 0.5)) == {"FINISHED"}
    whole = shape(dense)
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))
    assert not np.array_equal(caged, whole)
    apart = np.linalg.norm(caged - whole, axis=1) / diagonal
    assert apart.mean() < 5e-3
    assert apart.max() < 1e-2, "at the corner itself, which one pin pulls, no two meshes agree"
    assert np.linalg.norm(whole - rest, axis=1).mean() > 2e-2 * diagonal


def test_a_settled_pose_is_that_of_the_drawing_itself(dense):
    posed = {}
    for above in (5_000, 20_000):
        bpy.ops.planar.reset_to_rest()
        dense.planar.coarse_above = above
        bpy.ops.planar.drag_pins(offset=(-0.6, 0.5))
        assert bpy.ops.planar.settle_pose() == {"FINISHED"}
        posed[above] = shape(dense)
    diagonal = np.linalg.norm(np.ptp(posed[5_000], axis=0))
    assert np.abs(posed[5_000] - posed[20_000]).max() < 1e-4 * diagonal


def test_a_script_a_thread_and_a_new_solver_give_the_same_bits(dense):
    from planar_deform.model.posing import solver_cache
    from planar_deform.model.posing.solving import Solving

    rest = shape(dense)
    path = [(0.05 * step, 0.1 * step, 0.02 * step) for step in range(1, 7)]
    posing = begun()
    posing.solve(path)
    by_script = posing.model.solved().positions
    posing.click()
    for clear in (False, True):
        if clear:
            solver_cache.clear()
        posing = begun()
        solving = Solving(posing.model)
        solving.retrace(path)
        assert solving.wait(60.0)
        solved = solving.newest()
        solving.end()
        assert len(solved.path) == len(path)
        assert np.array_equal(solved.positions, by_script)
        posing.show(solved)
        assert not np.array_equal(shape(dense), rest)
        posing.cancel()
        assert np.array_equal(shape(dense), rest)


def test_undo_brings_back_every_bit(dense):
    bpy.ops.ed.undo_push(message="Before")
    shapes = [shape(dense)]
    for offset in ((0.2, 0.3), (-0.4, 0.1)):
        assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}
        bpy.ops.ed.undo_push(message="Drag")
        shapes.append(shape(bpy.context.object))
    for step in (1, 0):
        bpy.ops.ed.undo()
        assert np.array_equal(shape(bpy.context.object), shapes[step])
    for step in (1, 2):
        bpy.ops.ed.redo()
        assert np.array_equal(shape(bpy.context.object), shapes[step])


def test_keys_targets_and_records_go_through_the_cage(dense, monkeypatch):
    from planar_deform.model.posing import solver_cache
    from planar_deform.operators.drag import pack_path
    from planar_deform.scene.motion import follow_offset
    from planar_deform.scene.storage.cage import VERTICES

    asked, make = [], solver_cache.native.Poser

    def counted(*of, cage, **more):
        asked.append(cage)
        return make(*of, cage=cage, **more)

    monkeypatch.setattr(solver_cache.native, "Poser", counted)
    target = bpy.data.objects.new("Target", None)
    target.location = last_place(dense) + np.array([0.0, 0.2 * size_of(dense), 0.0])
    bpy.context.scene.collection.objects.link(target)
    dense.planar.pins[3].follow = target
    follow_offset.clear(dense, [3])
    assert bpy.ops.planar.follow_now() == {"FINISHED"}
    pin = dense.matrix_world @ Vector(dense.planar.pins[3].reached)
    assert np.array(pin) == pytest.approx(last_place(dense), abs=1e-3 * size_of(dense))
    bpy.context.scene.frame_set(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    before = dense.data.shape_keys.eval_time
    path = pack_path([(0.02 * frame, 0.01 * frame, 0.0) for frame in range(9)])
    dense.planar.pins[3].follow = None
    assert bpy.ops.planar.record_pins(path=path, frame=13, frame_step=4) == {"FINISHED"}
    assert [pose.frame for pose in dense.planar.poses] == [1, 13, 17, 21]
    assert dense.data.shape_keys.eval_time != before
    assert asked == [VERTICES], "one cage for all"


def test_in_betweens_of_a_dense_drawing_go_through_the_cage(dense):
    from planar_deform.scene.sequence import stretches

    for frame, offset in ((1, (0.3, 0.2)), (5, (-0.9, 0.6))):
        go_to(frame)
        assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}
        assert bpy.ops.planar.key_pose() == {"FINISHED"}
    keyed = [shown_at(dense, frame) for frame in (1, 5)]
    for pin in dense.planar.pins:  # the whole drawing holds those that stand each, the cage their middle
        pin.enabled = False

    def frames():
        assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
        assert stretches.stale(dense) == []
        assert [np.array_equal(shown_at(dense, frame), key) for frame, key in zip((1, 5), keyed, strict=True)]
        return [shown_at(dense, frame) for frame in (2, 3, 4)]

    caged = frames()
    dense.planar.coarse_above = 20_000
    assert stretches.stale(dense) == [(0, 1)], "solved in another way they would be others"
    assert stretches.why_stale(dense, 0) == ["coarse solving"]
    whole = frames()
    diagonal = np.linalg.norm(np.ptp(keyed[0], axis=0))
    for one, other in zip(caged, whole, strict=True):
        assert not np.array_equal(one, other)
        assert np.linalg.norm(one - other, axis=1).max() < 5e-3 * diagonal


def test_quads_are_cut_as_blender_cuts_them():
    from planar_deform.scene.objects import triangulation

    rng = np.random.default_rng(0)
    vertices = rng.normal(size=(400, 3)) * [1.0, 1.0, 0.0]
    faces = [rng.permutation(400)[: 4 if number % 3 else 3].tolist() for number in range(300)]
    obj = make_object(vertices, faces)
    expected = triangulation._cut_ngons(obj.data, shape(obj))
    assert np.array_equal(triangulation.corner_triangles(obj.data, shape(obj)), expected)
    quads = triangulation.faces_of(obj.data, shape(obj))
    corners = np.array([corner.vertex_index for corner in obj.data.loops])
    assert np.array_equal(quads.vertices[quads.triangles], corners[expected])


@pytest.mark.parametrize("method", ["HOLD", "AKVF", "ARAP"])
def test_a_later_drag_goes_on_from_what_the_one_before_has_left(dense, method):
    """The cage begins where it finds the drawing, as float32 has kept that."""
    dense.planar.method = method
    assert bpy.ops.planar.drag_pins(offset=(-0.5, 0.6)) == {"FINISHED"}
    left, place = shape(dense), last_place(dense)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.0)) == {"FINISHED"}
    diagonal = np.linalg.norm(np.ptp(left, axis=0))
    assert np.linalg.norm(shape(dense) - left, axis=1).max() < 2e-3 * diagonal
    assert bpy.ops.planar.drag_pins(offset=(0.2, 0.0)) == {"FINISHED"}
    assert np.linalg.norm(last_place(dense) - place) == pytest.approx(0.2, abs=1e-2)
