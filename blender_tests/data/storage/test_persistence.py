# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins, rest shape and settings survive saving, appending, duplicating, joining and undo."""

import bmesh
import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, add_pins, bar, coordinates, from_library, measured, pose


def state(obj):
    """All that is stored for an object, as plain values."""
    settings = obj.planar
    pins = [
        {
            name: tuple(value)
            if hasattr(value := getattr(pin, name), "__len__") and name in ("target", "reached")
            else value
            for name in (
                "name",
                "group",
                "group_index",
                "owns_group",
                "kind",
                "enabled",
                "weight",
                "select",
                "angle",
                "has_target",
                "target",
                "reached",
            )
        }
        for pin in settings.pins
    ]
    rest = obj.data.attributes.get("planar_rest")
    return (
        pins,
        (settings.active_pin, settings.method, settings.pin_weight),
        None if rest is None else coordinates(rest.data, "vector").tobytes(),
        coordinates(obj.data.vertices).tobytes(),
    )


def posed_bar():
    obj = bar()
    add_end_pins(obj)
    add_pins(obj, [32, 33, 34], kind="PATCH")
    obj.planar.pins[2].weight = 3.0
    obj.planar.pins[0].enabled = False
    obj.planar.pin_weight = 20.0
    pose(obj, offset=(0.1, 0.3), angle=0.4)
    return obj


def test_saved_and_loaded_again(tmp_path):
    before = state(posed_bar())
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Cutout"]
    assert state(obj) == before
    pose(obj, offset=(0.0, 0.1))
    bpy.ops.planar.reset_to_rest()
    assert coordinates(obj.data.vertices).tobytes() == before[2]


def test_appended(tmp_path):
    before = state(posed_bar())
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.append(directory=f"{path}/Object/", filename="Cutout")
    obj = bpy.data.objects["Cutout"]
    assert state(obj) == before
    pose(obj, offset=(0.0, 0.1))


def test_a_linked_object_that_is_made_local_can_be_posed(tmp_path):
    from planar_deform.scene.objects.cutout_object import pose_refusal

    before = state(posed_bar())
    obj = from_library(tmp_path)
    assert pose_refusal(obj) is not None
    activate(obj)
    bpy.ops.object.make_local(type="SELECT_OBDATA")
    obj = bpy.data.objects["Cutout"]
    assert state(obj) == before
    pose(obj, offset=(0.0, 0.1))


def test_duplicated():
    obj = posed_bar()
    before = state(obj)
    activate(obj)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    assert twin != obj
    assert state(twin) == before
    pose(twin, offset=(0.0, 0.2))
    assert state(obj) == before


def test_joined_into_a_pinned_object():
    obj = posed_bar()
    before = state(obj)
    other = bar(name="Other")
    other.location = (0, 4, 0)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.join()
    assert state(obj)[0] == before[0]
    pose(obj, offset=(0.0, 0.1))
    moved = coordinates(obj.data.vertices)[65:]
    assert moved[:, 1].min() == pytest.approx(4.0)


def test_joined_into_an_object_without_pins():
    obj = posed_bar()
    own_rest = coordinates(obj.data.attributes["planar_rest"].data, "vector")
    plain = bar(name="Plain")
    plain.location = (0, 4, 0)
    obj.select_set(True)
    bpy.context.view_layer.update()
    bpy.ops.object.join()  # into Plain, the active one
    joined = bpy.context.object
    assert len(joined.planar.pins) == 3
    # Plain's vertices had no rest yet, the others brought theirs, in the space of the object they came from.
    shown = coordinates(joined.data.vertices)
    rest = coordinates(joined.data.attributes["planar_rest"].data, "vector")
    assert np.array_equal(rest[:65], shown[:65])
    assert rest[65:] == pytest.approx(own_rest - [0.0, 4.0, 0.0], abs=1e-6)
    assert measured(joined).flipped == 0


class Steps:
    """Undo steps as the window's operators push them."""

    def __init__(self):
        bpy.ops.ed.undo_push(message="Start")

    def push(self):
        bpy.ops.ed.undo_push(message="Step")

    def undo(self):
        assert bpy.ops.ed.undo() == {"FINISHED"}
        return bpy.data.objects["Cutout"]

    def redo(self):
        assert bpy.ops.ed.redo() == {"FINISHED"}
        return bpy.data.objects["Cutout"]


def test_undo_and_redo_of_every_kind_of_action():
    obj = bar()
    steps = Steps()
    states = [state(obj)]

    def did(result):
        assert result == {"FINISHED"}
        steps.push()
        states.append(state(bpy.data.objects["Cutout"]))

    did(bpy.ops.planar.add_pin(location=(0.1, 0.5, 0)))
    did(bpy.ops.planar.add_pin(location=(1.9, 0.5, 0)))
    did(bpy.ops.planar.drag_pins(offset=(0.0, 0.5)))
    did(bpy.ops.planar.set_pin_kind(kind="PATCH"))
    did(bpy.ops.planar.rotate_pins(angle=0.5))
    did(bpy.ops.planar.reset_to_rest())
    did(bpy.ops.planar.remove_pins())
    for step in range(len(states) - 2, -1, -1):
        assert state(steps.undo()) == states[step], f"undo to {step}"
    for step in range(1, len(states)):
        assert state(steps.redo()) == states[step], f"redo to {step}"
    for step in range(len(states) - 2, -1, -1):
        assert state(steps.undo()) == states[step], f"undo again to {step}"


def test_an_action_after_undo_gives_the_same_bits_as_before():
    bar()
    bpy.ops.planar.add_pin(location=(0.1, 0.5, 0))
    bpy.ops.planar.add_pin(location=(1.9, 0.5, 0))
    steps = Steps()
    bpy.ops.planar.drag_pins(offset=(0.1, 0.5))
    first = state(bpy.data.objects["Cutout"])
    steps.push()
    steps.undo()
    bpy.ops.planar.drag_pins(offset=(0.1, 0.5))
    assert state(bpy.data.objects["Cutout"]) == first


def test_undo_takes_a_pose_key_away():
    obj = bar()
    obj.shape_key_add(name="Basis")
    bpy.ops.planar.add_pin(location=(0.1, 0.5, 0))
    bpy.ops.planar.add_pin(location=(1.9, 0.5, 0))
    steps = Steps()
    bpy.ops.planar.drag_pins(offset=(0.1, 0.5))
    steps.push()
    assert len(bpy.data.objects["Cutout"].data.shape_keys.key_blocks) == 2
    obj = steps.undo()
    assert len(obj.data.shape_keys.key_blocks) == 1
    obj = steps.redo()
    assert obj.active_shape_key.name == "Pose"


def test_the_measure_follows_an_edit_of_the_mesh():
    obj = posed_bar()
    before = measured(obj).area
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    for vertex in mesh.verts:
        vertex.select_set(vertex.index % 13 > 6)  # of all, the rest would follow
    bpy.ops.transform.translate(value=(2, 0, 0))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert measured(obj).area > before + 0.3
