# SPDX-License-Identifier: GPL-3.0-or-later
"""Joined drawings keep all their pins where they were, whatever their vertex groups were called."""

import bpy
import numpy as np
import pytest
from drawings import DRAWINGS, extremes
from sequences import go_to, key, pull
from support import activate, add_pins, bar, coordinates, evaluated, grid, make_object, measured, pose, world


def pinned(kind="outline", name=None, patch=True):
    """A drawing from elsewhere with two points and a patch, posed."""
    obj = DRAWINGS[kind]()
    if name:
        obj.name = name
    left, middle, right = extremes(obj)
    add_pins(obj, [left], [right])
    if patch:
        near = np.argsort(np.linalg.norm(world(obj) - world(obj)[middle], axis=1))[:5]
        faces = np.unique([vertex for face in obj.data.polygons for vertex in face.vertices])
        add_pins(obj, [row for row in near if row in faces], kind="PATCH")
    obj.planar.pins[0].weight, obj.planar.pins[0].name = 3.0, f"{obj.name}.L"
    size = np.ptp(world(obj), axis=0).max()
    pose(obj, offset=(0.1 * size, 0.15 * size), moving=[1])
    return obj


def standing(obj):
    """Each pin that can be used, by where it is in the world: kind, weight, enabled, target, name."""
    from planar_deform.scene.view import snapshot

    activate(obj)
    snapshot.forget()
    found = []
    for pin in snapshot.of_active(bpy.context).pins:
        stored = obj.planar.pins[pin.key]
        settings = stored.kind, round(stored.weight, 4), stored.enabled, stored.name.split(".0")[0]
        found.append((pin.place, pin.target, settings))
    return found


def assert_all_stand(joined, expected, size):
    now = standing(joined)
    assert len(now) == len(expected) == len(joined.planar.pins)
    left = list(now)
    for place, target, settings in expected:
        gaps = [
            np.linalg.norm(place - other[0]) + np.linalg.norm(target - other[1])
            if other[2] == settings
            else np.inf
            for other in left
        ]
        assert min(gaps) < 1e-4 * size
        left.pop(int(np.argmin(gaps)))


def join(active, *others):
    activate(active)
    for other in others:
        other.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    return bpy.context.object


def size_of(obj):
    return np.ptp(world(obj), axis=0).max()


def test_groups_of_pins_have_names_that_are_unique_in_the_file():
    first, second = bar(), bar(name="Second")
    for obj in (first, second):
        add_pins(obj, [0], [12])
    names = [pin.group for obj in (first, second) for pin in obj.planar.pins]
    assert len(set(names)) == 4
    # In the list each drawing counts for itself: poses are carried from one to the other by these names.
    assert [[pin.name for pin in obj.planar.pins] for obj in (first, second)] == [["Pin", "Pin.001"]] * 2
    second.vertex_groups[second.planar.pins[0].group].name = "Tail"
    bpy.context.view_layer.update()
    assert (second.planar.pins[0].group, second.planar.pins[0].name) == ("Tail", "Tail")


@pytest.mark.parametrize(
    "kinds", [("outline", "text"), ("character", "outline"), ("text", "outline", "outline")]
)
def test_joined_layers_keep_their_pins(kinds):
    layers = [pinned(kind) for kind in kinds]
    for depth, layer in enumerate(layers):
        layer.location.y += 0.1 * depth
        layer.location.x += 3.0 * depth
        layer.scale *= 1.0 + depth
    expected = [pin for layer in layers for pin in standing(layer)]
    shapes = np.concatenate([world(layer) for layer in layers])
    areas = [measured(layer).area for layer in layers]
    joined = join(layers[0], *layers[1:])
    size = size_of(joined)
    assert np.sort(world(joined), axis=0) == pytest.approx(np.sort(shapes, axis=0), abs=1e-5 * size)
    assert_all_stand(joined, expected, size)
    assert min(areas) - 1e-4 < measured(joined).area < max(areas) + 1e-4
    shape = world(joined)
    assert bpy.ops.planar.select_pins(action="ALL") == {"FINISHED"}
    assert bpy.ops.planar.drag_pins(offset=(1e-4 * size, 0.0)) == {"FINISHED"}
    assert np.abs(world(joined) - shape).max() < 0.02 * size
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert measured(joined).area == pytest.approx(2.0, abs=1e-6)


def test_joined_into_a_drawing_that_was_never_pinned():
    obj = pinned("character")
    expected, shape = standing(obj), world(obj)
    vertices, faces = grid(6, 3)
    plain = make_object(vertices[:, [0, 2, 1]] * [1, 1, -1] + [4, 0, 0], faces.tolist(), name="Plain")
    before = world(plain)
    joined = join(plain, obj)
    assert_all_stand(joined, expected, size_of(joined))
    assert world(joined)[len(before) :] == pytest.approx(shape, abs=1e-5)
    bpy.ops.planar.reset_to_rest()
    assert world(joined)[: len(before)] == pytest.approx(before, abs=1e-6)
    assert measured(joined).area == pytest.approx(2.0, abs=1e-6)


@pytest.mark.parametrize("pose_again", [False, True])
def test_a_duplicate_joined_with_its_original(pose_again):
    obj = pinned("outline")
    activate(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    twin.location.x += 4.0
    twin.scale *= 1.5
    if pose_again:
        pose(twin, offset=(-0.2, 0.1), moving=[0])
    expected = standing(obj) + standing(twin)
    areas = measured(obj).area, measured(twin).area
    joined = join(obj, twin)
    assert_all_stand(joined, expected, size_of(joined))
    assert min(areas) - 1e-4 < measured(joined).area < max(areas) + 1e-4
    bpy.ops.planar.reset_to_rest()
    assert measured(joined).area == pytest.approx(2.0, abs=1e-6)


@pytest.mark.parametrize("keyed", [False, True])
def test_pins_on_groups_of_the_user_that_have_the_same_names(keyed):
    layers = []
    for number in range(3):
        obj = bar(name=f"Layer {number}")
        obj.location = (0.0, 3.0 * number, 0.1 * number)
        if keyed:
            obj.shape_key_add(name="Basis")
        for name, rows in (("Hand", [0, 13, 26]), ("Foot", [12, 25]), ("Head", [32, 33])):
            obj.vertex_groups.new(name=name).add(rows[: 3 - number % 2], 1.0, "REPLACE")
        activate(obj)
        bpy.ops.planar.add_pins_from_all_groups(kind="PATCH")
        obj.planar.pins[0].kind = "POINT"
        layers.append(obj)
    expected = [pin for layer in layers for pin in standing(layer)]
    joined = join(layers[1], layers[0], layers[2])
    assert_all_stand(joined, expected, size_of(joined))
    hands = joined.vertex_groups["Hand"].index
    members = [v.index for v in joined.data.vertices if any(g.group == hands for g in v.groups)]
    assert len(members) == 8, "the user's group is what Blender made of it"


def test_pins_of_a_file_that_has_just_been_opened(tmp_path):
    first, second = pinned("outline", "First"), pinned("text", "Second")
    expected = standing(first) + standing(second)
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    joined = join(bpy.data.objects["First"], bpy.data.objects["Second"])
    assert_all_stand(joined, expected, size_of(joined))


def test_a_layer_that_is_off_and_a_weight_of_all_pins():
    first, second = bar(), bar(name="Second")
    second.location.x = 4.0
    for obj in (first, second):
        add_pins(obj, [0], [12])
    second.planar.pins[0].enabled = False
    second.planar.pin_weight = 4.0
    joined = join(first, second)
    assert [pin.enabled for pin in joined.planar.pins] == [True, True, False, True]
    assert [pin.weight for pin in joined.planar.pins] == pytest.approx([1, 1, 4, 4])
    assert len({pin.name for pin in joined.planar.pins}) == 4
    assert [pin.select for pin in joined.planar.pins] == [False, True, False, False]


def test_a_join_is_undone_and_redone():
    pinned("outline", "First")
    pinned("text", "Second")

    def state(*names):
        objects = [bpy.data.objects[name] for name in names]
        return [pin for obj in objects for pin in standing(obj)]

    expected = state("First", "Second")
    size = size_of(bpy.data.objects["Second"])
    activate(bpy.data.objects["First"])
    bpy.data.objects["Second"].select_set(True)
    bpy.ops.ed.undo_push(message="Start")
    bpy.ops.object.join()
    bpy.ops.ed.undo_push(message="Join")
    for _ in range(2):
        assert_all_stand(bpy.data.objects["First"], expected, size)
        bpy.ops.ed.undo()
        assert len(bpy.data.objects["First"].planar.pins) == 3
        assert len(bpy.data.objects["Second"].planar.pins) == 3
        found = state("First", "Second")
        assert len(found) == 6
        for now, then in zip(found, expected, strict=True):
            assert now[0] == pytest.approx(then[0], abs=1e-4 * size)
        bpy.ops.ed.redo()
    bpy.ops.planar.select_pins(action="ALL")
    bpy.ops.planar.drag_pins(offset=(1e-3, 0.0))
    bpy.ops.ed.undo_push(message="Drag")
    bpy.ops.ed.undo()
    assert_all_stand(bpy.data.objects["First"], expected, size)


def test_a_part_that_was_separated_comes_back():
    obj = bar()
    vertices, faces = grid(4, 4)
    other = make_object(vertices + np.array([3.0, 0.0, 0.0]), faces.tolist(), name="Other")
    add_pins(obj, [0], [12])
    add_pins(other, [0], [24])
    joined = join(obj, other)
    expected = standing(joined)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.separate(type="LOOSE")
    bpy.ops.object.mode_set(mode="OBJECT")
    parts = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    assert len(parts) == 2
    assert sum(len(standing(part)) for part in parts) == 4
    again = join(parts[0], parts[1])
    now = standing(again)
    assert sorted(tuple(np.round(pin[0], 4)) for pin in now) == sorted(
        tuple(np.round(pin[0], 4)) for pin in expected
    )
    assert evaluated(again).shape == coordinates(again.data.vertices).shape


def test_a_posed_layer_joined_to_one_with_keyed_poses_keeps_its_rest():
    obj = bar()
    add_pins(obj, [26], [38])
    key(obj, 1)
    pull(obj, 25, (-0.3, 0.7))
    other = bar(name="Other")
    other.location = (0.0, 3.0, 0.1)
    add_pins(other, [26], [38])
    pose(other, offset=(-0.2, 0.8))
    area, expected = measured(other).area, standing(other)
    go_to(1)
    joined = join(obj, other)
    assert len(joined.planar.pins) == 4
    now = standing(joined)
    for pin, then in zip(now[2:], expected, strict=True):
        assert pin[0] == pytest.approx(then[0], abs=1e-4)
    assert measured(joined).area == pytest.approx(1.0 + area / 2, abs=1e-4)
    assert bpy.ops.planar.clear_poses() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert measured(joined).area == pytest.approx(2.0, abs=1e-6)
    assert np.ptp(world(joined)[65:], axis=0) == pytest.approx([2.0, 1.0, 0.0], abs=1e-5)


@pytest.mark.parametrize("own", ["", "Stiffness", "Mine"])
def test_painted_stiffness_comes_along(own):
    from planar_deform.scene.objects.stiffness import painted

    first, second = bar(), bar(name="Second")
    second.location.x = 4.0
    for obj, name, weight in ((first, own, 0.25), (second, "Stiffness", 1.0)):
        add_pins(obj, [0], [12])
        if name:
            obj.vertex_groups.new(name=name).add([3, 4], weight, "REPLACE")
            obj.planar.stiffness_group = name
    joined = join(first, second)
    expected = np.full(130, 0.5)
    expected[[68, 69]] = 1.0
    if own:
        expected[[3, 4]] = 0.25
    assert painted(joined) == pytest.approx(expected)


def test_targets_of_pins_come_along():
    first, second = bar(), bar(name="Second")
    target = bpy.data.objects.new("Target", None)
    bpy.context.scene.collection.objects.link(target)
    for obj in (first, second):
        add_pins(obj, [0], [12])
    second.planar.pins[1].follow, second.planar.pins[1].follow_bone = target, "Hand"
    second.location.x = 5.0
    joined = join(first, second)
    bpy.context.view_layer.update()
    targets = [(pin.follow, pin.follow_bone) for pin in joined.planar.pins]
    assert targets == [(None, ""), (None, ""), (None, ""), (target, "Hand")]
