# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of objects with pins: read once for each, anew only when that object has changed."""

import bpy
import numpy as np
import pytest
from snapshots import MIDDLE, left_pin, pinned, seen_of, update
from support import bar


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
