# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of objects with pins: read once for each, anew only when that object has changed."""

import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, add_pins, bar, coordinates, grid, make_object, world


def seen_of(obj):
    """What a window shows whose active object this is."""
    from planar_deform.scene.view import snapshot

    with bpy.context.temp_override(object=obj):
        return snapshot.of_active(bpy.context)


def update():
    bpy.context.view_layer.update()


def pinned(name="Cutout", at=(0.0, 0.0, 0.0)):
    obj = bar(name=name)
    obj.location = at
    add_end_pins(obj)
    obj.planar.show_mesh = True
    update()
    return obj


MIDDLE = 26  # of the left column, whose pin is there


def left_pin(obj):
    """Where the pin on the left column should be, seen from the mesh itself."""
    return world(obj)[MIDDLE]


@pytest.fixture
def reads(monkeypatch):
    """The names of the objects whose meshes are read, in order."""
    from planar_deform.scene.objects import cutout_object

    names, read = [], cutout_object.read

    def counted(obj, **more):
        names.append(obj.name)
        return read(obj, **more)

    monkeypatch.setattr(cutout_object, "read", counted)
    return names


def assert_same(seen, other):
    """Two snapshots show the same, to the bit."""
    assert seen.refusal == other.refusal
    assert [pin.key for pin in seen.pins] == [pin.key for pin in other.pins]
    for mine, theirs in zip(seen.pins, other.pins, strict=True):
        assert np.array_equal(mine.place, theirs.place)
        assert np.array_equal(mine.target, theirs.target)
        assert np.array_equal(mine.turned, theirs.turned)
        assert mine.angle == theirs.angle
    assert np.array_equal(seen.edges, other.edges)
    if seen.refusal is None:
        assert np.array_equal(seen.points, other.points)
        assert np.array_equal(seen.triangles, other.triangles)
        assert np.array_equal(seen.distortion.triangle_area, other.distortion.triangle_area)


def assert_as_read_anew(obj):
    """What is shown is what a new reading shows."""
    from planar_deform.scene.objects import cutout_object, triangulation
    from planar_deform.scene.storage import vertex_groups
    from planar_deform.scene.view import snapshot

    seen = seen_of(obj)
    for module in (snapshot, cutout_object, triangulation, vertex_groups):
        module.forget()
    assert_same(seen, seen_of(obj))


# ---- two windows


def test_two_windows_have_their_own_objects(reads):
    first, second = pinned("First"), pinned("Second", (0.0, 5.0, 0.0))
    shown = [seen_of(first), seen_of(second)]
    for obj, seen in zip((first, second), shown, strict=True):
        assert seen.pin(0).place == pytest.approx(left_pin(obj), abs=1e-6)
        assert seen_of(obj) is seen
    assert reads == ["First", "Second"]


def test_a_drag_is_of_one_object():
    from planar_deform.scene.objects.cutout_object import read_cutout
    from planar_deform.scene.view import snapshot

    first, second = pinned("First"), pinned("Second", (0.0, 5.0, 0.0))
    drawing = read_cutout(first)
    snapshot.follow(drawing, drawing.positions + np.array([0.0, 3.0]), [])
    followed = seen_of(first)
    assert followed.points[:, 1].min() == pytest.approx(3.0)
    assert seen_of(second).pin(0).place == pytest.approx(left_pin(second), abs=1e-6)
    assert seen_of(first) is followed, "another window does not end it"
    assert snapshot.following(first)
    assert not snapshot.following(second)
    second.data.vertices[MIDDLE].co.y -= 0.125
    second.data.update()
    update()
    assert seen_of(second).pin(0).place == pytest.approx(left_pin(second), abs=1e-6), "that is not followed"
    snapshot.release()
    assert seen_of(first).pin(0).place == pytest.approx(left_pin(first), abs=1e-6)


def test_few_are_kept_and_none_that_is_gone():
    from planar_deform.scene.view import snapshot

    objects = [pinned(f"Cutout {index}") for index in range(snapshot.CAPACITY + 3)]
    for obj in objects:
        seen_of(obj)
    assert len(snapshot._kept) == snapshot.CAPACITY
    for obj in objects[5:]:
        bpy.data.objects.remove(obj)
    seen_of(objects[0])
    assert objects[0].session_uid in snapshot._kept
    assert len(snapshot._kept) <= 5
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not snapshot._kept


# ---- what else changes


def change_another(other):
    other.location.x += 1.0
    update()
    other.data.vertices[MIDDLE].co.y -= 0.125
    other.data.update()
    update()
    other.vertex_groups.new(name="Another").add([3], 0.5, "REPLACE")
    update()
    bpy.data.objects.remove(other)
    update()


def test_another_objects_changes_drop_nothing(reads):
    obj, other = pinned("Cutout"), pinned("Other")
    seen = seen_of(obj)
    change_another(other)
    assert seen_of(obj) is seen
    bpy.context.scene.frame_set(7)
    assert seen_of(obj) is seen
    assert reads == ["Cutout"]


def test_an_object_without_pins_costs_nothing(reads, monkeypatch):
    from planar_deform.scene.sequence import pose_state
    from planar_deform.scene.storage import changes, points
    from planar_deform.scene.view import onion, snapshot

    obj = bar()
    changes.tell_all()
    looked = []
    for owner, name in ((points, "read"), (points, "read_block"), (pose_state, "is_ours")):
        monkeypatch.setattr(owner, name, lambda *_, name=name, **__: looked.append(name))
    assert seen_of(obj) is None
    with bpy.context.temp_override(object=obj):
        assert onion.of_active(bpy.context) is None
    change_another(obj)
    bpy.context.scene.frame_set(7)
    assert not looked
    assert not reads
    assert not snapshot._kept
    assert not changes._counts


def test_asking_an_object_without_pins_gives_it_no_settings():
    obj = bpy.data.objects.new("New", bar().data)
    seen_of(obj)
    assert not obj.is_property_set("planar")


# ---- the object itself


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


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_is_seen(edit):
    obj = pinned()
    before = seen_of(obj)
    EDITS[edit](obj)
    update()
    obj = bpy.context.view_layer.objects["Cutout"]
    if edit not in SHOWN_AS_BEFORE:
        with pytest.raises(AssertionError):
            assert_same(before, seen_of(obj))
    assert_as_read_anew(obj)


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
    update()
    obj = bpy.context.view_layer.objects["Cutout"]
    if edit not in SHOWN_AS_BEFORE:
        with pytest.raises(AssertionError):
            assert_same(before, seen_of(obj))
    assert_as_read_anew(obj)


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
