# SPDX-License-Identifier: GPL-3.0-or-later
"""Moves and edits of objects with pins: each is seen, and nothing is read for what is none."""

import bpy
import numpy as np
import pytest
from snapshots import MIDDLE, assert_as_read_anew, assert_same, left_pin, pinned, seen_of, update
from support import activate, add_pins, coordinates, grid, make_object


def turn(obj):
    obj.rotation_euler, obj.scale = (0.3, 0.0, 0.8), (2.0, 0.5, 1.0)


def move_parent(obj):
    obj.parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(obj.parent)
    update()
    obj.parent.location = (4.0, 5.0, 6.0)


MOVES = {
    "carried": lambda obj: setattr(obj, "location", (1.0, -2.0, 3.0)),
    "turned": turn,
    "mirrored": lambda obj: setattr(obj, "scale", (-1.0, 1.0, 1.0)),
    "parent": move_parent,
    "renamed": lambda obj: setattr(obj, "name", "Another Name"),
    "selected": lambda obj: obj.select_set(False),
}


@pytest.mark.parametrize("move", MOVES)
def test_nothing_of_the_mesh_is_read_when_only_the_object_moves(reads, move):
    obj = pinned()
    seen_of(obj)
    MOVES[move](obj)
    update()
    assert seen_of(obj).pin(0).place == pytest.approx(left_pin(obj), abs=1e-6)
    assert len(reads) == 1
    assert_as_read_anew(obj)


def test_a_pins_settings_read_nothing(reads):
    obj = pinned()
    seen_of(obj)
    pin = obj.planar.pins[0]
    pin.has_target, pin.target, pin.reached = True, (0.0, 0.75, 0.0), obj.data.vertices[MIDDLE].co
    assert seen_of(obj).pin(0).target == pytest.approx((0.0, 0.75, 0.0))
    assert len(reads) == 1
    assert_as_read_anew(obj)


def edit_vertex(obj):
    obj.data.vertices[MIDDLE].co.y -= 0.125
    obj.data.update()


def edit_topology(obj):
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")


def delete_faces(obj):
    import bmesh

    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    bmesh.ops.delete(mesh, geom=mesh.faces[-5:], context="FACES")
    mesh.to_mesh(obj.data)
    mesh.free()
    obj.data.update()


def edit_rest(obj):
    rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    obj.data.attributes["planar_rest"].data.foreach_set("vector", (rest * 1.5).ravel())
    obj.data.update()


def turn_one_vertex(obj):
    add_pins(obj, [20], kind="PATCH")
    update()
    seen_of(obj)
    obj.planar.pins[2].angle = 0.5  # where nothing else tells how it is turned
    assert seen_of(obj).pin(2).angle == 0.5


def swap_groups(obj):
    activate(obj)
    obj.vertex_groups.active_index = 1
    bpy.ops.object.vertex_group_move(direction="UP")


def edit_key(obj):
    obj.data.shape_keys.key_blocks[1].data[MIDDLE].co.y -= 0.125


def set_value(obj):
    obj.data.shape_keys.key_blocks[1].value = 0.25


def mask_key(obj):
    group = obj.vertex_groups.new(name="Mask")
    group.add(range(65), 0.5, "REPLACE")
    obj.data.shape_keys.key_blocks[1].vertex_group = "Mask"


def mask_weights(obj):
    mask_key(obj)
    update()
    seen_of(obj)
    obj.vertex_groups["Mask"].add([0, 13], 0.125, "REPLACE")


def remove_mask(obj):
    mask_key(obj)
    update()
    seen_of(obj)
    obj.vertex_groups.remove(obj.vertex_groups["Mask"])


def edit_basis(obj):
    obj.data.shape_keys.reference_key.data[MIDDLE].co.y -= 0.125


def animate(owner, path, values):
    for frame, value in values.items():
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)


def show_frame(obj):
    animate(obj.data.shape_keys.key_blocks[1], "value", {1: 0.2, 20: 1.0})
    update()
    seen_of(obj)
    bpy.context.scene.frame_set(13)


def show_animated_move(obj):
    animate(obj, "location", {1: (0.0, 0.0, 0.0), 20: (3.0, 2.0, 1.0)})
    update()
    seen_of(obj)
    bpy.context.scene.frame_set(13)


def show_driven(obj):
    driver = obj.data.shape_keys.key_blocks[1].driver_add("value").driver
    driver.expression = "0.5 + frame / 100"
    driven = obj.driver_add("location", 1).driver
    driven.expression = "frame / 10"
    bpy.context.scene.frame_set(3)
    seen_of(obj)
    bpy.context.scene.frame_set(23)


def drive_by_another(obj):
    other = bpy.data.objects.new("Other", None)
    bpy.context.collection.objects.link(other)
    driver = obj.data.shape_keys.key_blocks[1].driver_add("value").driver
    target = driver.variables.new().targets[0]
    target.id, target.data_path = other, "location.x"
    driver.expression = driver.variables[0].name
    update()
    seen_of(obj)
    other.location.x = 0.25


def swap_mesh(obj):
    other = bpy.data.meshes.new("Other")
    vertices, faces = grid(3, 3)
    other.from_pydata((vertices - 0.5).tolist(), [], faces.tolist())
    obj.data = other


def swap_with_groups(obj):
    obj.data = obj.data.copy()
    edit_vertex(obj)


def back_from_paint(obj):
    activate(obj)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    seen_of(obj)
    bpy.ops.object.mode_set(mode="OBJECT")


def add_modifier(obj):
    obj.modifiers.new("Subdivision", "SUBSURF")


def duplicate_linked(obj):
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)


def undo(obj):
    bpy.ops.ed.undo_push(message="Start")
    edit_vertex(obj)
    bpy.ops.ed.undo_push(message="Edit")
    update()
    seen_of(obj)
    bpy.ops.ed.undo()


EDITS = {
    "vertex": edit_vertex,
    "topology": edit_topology,
    "faces": delete_faces,
    "rest": edit_rest,
    "weight": lambda obj: obj.vertex_groups[0].add([2, 3], 0.5, "REPLACE"),
    "weight taken": lambda obj: obj.vertex_groups[0].remove([0]),
    "group emptied": lambda obj: obj.vertex_groups[0].remove(range(65)),
    "group renamed": lambda obj: setattr(obj.vertex_groups[0], "name", "Renamed"),
    "group removed": lambda obj: obj.vertex_groups.remove(obj.vertex_groups[0]),
    "groups swapped": swap_groups,
    "another group": lambda obj: setattr(obj.planar.pins[0], "group", obj.vertex_groups[1].name),
    "pin": lambda obj: add_pins(obj, [20]),
    "angle of one vertex": turn_one_vertex,
    "edges": lambda obj: setattr(obj.planar, "show_mesh", False),
    "edit mode": lambda obj: (activate(obj), bpy.ops.object.mode_set(mode="EDIT")),
    "paint mode": lambda obj: (activate(obj), bpy.ops.object.mode_set(mode="WEIGHT_PAINT")),
    "back": back_from_paint,
    "modifier": add_modifier,
    "another mesh": swap_mesh,
    "copied mesh": swap_with_groups,
    "linked duplicate": duplicate_linked,
    "scale of zero": lambda obj: setattr(obj, "scale", (0.0, 1.0, 1.0)),
    "undo": undo,
    "animated move": show_animated_move,
}


KEY_EDITS = {
    "key": edit_key,
    "value": set_value,
    "mask": mask_key,
    "weights of the mask": mask_weights,
    "basis": edit_basis,
    "mask gone": remove_mask,
    "muted": lambda obj: setattr(obj.data.shape_keys.key_blocks[1], "mute", True),
    "active": lambda obj: setattr(obj, "active_shape_key_index", 0),
    "pinned key": lambda obj: setattr(obj, "show_only_shape_key", True),
    "frame": show_frame,
    "driven frame": show_driven,
    "driven by another": drive_by_another,
    "undo": undo,
}


SHOWN_AS_BEFORE = {
    *("undo", "back", "modifier", "group renamed", "groups swapped"),
    *("active", "pinned key", "mask gone"),
}


def assert_seen(edit, before):
    """What is shown after an edit of the cutout is what a new reading shows, and not what was before."""
    update()
    obj = bpy.context.view_layer.objects["Cutout"]
    if edit not in SHOWN_AS_BEFORE:
        with pytest.raises(AssertionError):
            assert_same(before, seen_of(obj))
    assert_as_read_anew(obj)


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_is_seen(edit):
    obj = pinned()
    before = seen_of(obj)
    EDITS[edit](obj)
    assert_seen(edit, before)


@pytest.mark.parametrize("edit", KEY_EDITS)
def test_an_edit_of_shape_keys_is_seen(edit):
    obj = pinned()
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Key")
    rows = coordinates(key.data)
    key.data.foreach_set("co", (rows * [1.0, 1.25, 1.0] + [0.5, 0.0, 0.0]).astype(np.float32).ravel())
    key.value, obj.active_shape_key_index = 1.0, 1
    update()
    before = seen_of(obj)
    KEY_EDITS[edit](obj)
    assert_seen(edit, before)


def test_a_shared_mesh_is_refused_and_its_objects_are_read_when_either_edits_it():
    obj = pinned()
    seen_of(obj)
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)
    update()
    assert "shared" in seen_of(obj).refusal
    assert "shared" in seen_of(copy).refusal
    copy.data = copy.data.copy()
    edit_vertex(copy)
    update()
    for each in (obj, copy):
        assert seen_of(each).pin(0).place == pytest.approx(left_pin(each), abs=1e-6)


def test_painted_stiffness_is_not_felt_by_what_is_shown_but_a_reading_knows_it(reads):
    from planar_deform.scene.objects.cutout_object import read_cutout
    from planar_deform.scene.objects.stiffness import ensure_group

    obj = pinned()
    seen_of(obj)
    ensure_group(obj).add(range(30), 1.0, "REPLACE")
    update()
    assert_as_read_anew(obj)
    assert read_cutout(obj).cutout.stiffness.max() == pytest.approx(100.0)


def test_a_random_walk_of_edits_always_shows_what_a_new_reading_shows():
    rng = np.random.default_rng(3)
    obj = pinned()
    walk = [edit_vertex, edit_rest, turn, MOVES["carried"], MOVES["mirrored"], EDITS["weight"], EDITS["pin"]]
    for step in rng.integers(0, len(walk), 60):
        walk[step](obj)
        update()
        kept = seen_of(obj)
        from planar_deform.scene.view import snapshot

        other = snapshot._read(obj, snapshot._state(obj), None).snapshot
        assert_same(kept, other)


def test_meshes_in_several_parts():
    vertices, faces = grid(4, 2)
    rows = np.concatenate([vertices, vertices + np.array([3.0, 0.0, 0.5])])
    obj = make_object(rows, [*faces.tolist(), *(faces + len(vertices)).tolist()])
    add_pins(obj, [0], [len(vertices)])
    seen_of(obj)
    for move in MOVES.values():
        move(obj)
        update()
        assert_as_read_anew(obj)
        seen_of(obj)
