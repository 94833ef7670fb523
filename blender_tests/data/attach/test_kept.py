# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints come along with all that happens to a drawing, as pins do."""

import bpy
import numpy as np
import pytest
from figures import FIGURE, NECK, SHOULDER, WRIST, drag, figure, gaps, joint_places, pin_at, pinned, shown
from sequences import go_to, key
from support import activate, evaluated, in_edit_mode

HELD = 1e-3  # of the diagonal
PLACES = sorted([NECK, SHOULDER, WRIST])


def lean(obj, angle=0.3):
    """Lean by the chest: all parts are as far apart at their joints as before, which is nothing."""
    activate(obj)
    drag(obj, "Chest", (0.04, 0.02), angle=angle)
    assert len(gaps(obj)) == 3
    assert max(gaps(obj).values()) < HELD


def test_renamed_groups_are_followed():
    obj = pinned()
    for pin in obj.planar.pins:
        obj.vertex_groups[pin.group].name = f"Renamed {pin.group}"
    bpy.context.view_layer.update()
    lean(obj)


def test_a_duplicate_has_its_own():
    obj = pinned()
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy != obj
    lean(copy)
    assert np.abs(shown(obj)[0] - shown(obj)[1].rest).max() < 1e-6


def test_joined_drawings_keep_all_joints():
    first, second = pinned(), pinned(name="Second")
    second.location.x += 2.0
    activate(first)
    second.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert sorted(pin.kind for pin in first.planar.pins) == ["HINGE"] * 6 + ["PATCH"] * 2
    assert len(gaps(first)) == 6
    drag(first, "Chest", (0.04, 0.02), angle=0.3)
    drag(first, "Chest.001", (0.04, 0.02), angle=-0.3)
    assert max(gaps(first).values()) < HELD


def test_layers_that_are_joined_can_be_attached():
    layers = [figure(box, name=f"Layer {number}", parented=False) for number, box in enumerate(FIGURE)]
    pin_at(layers[0], (1.0, 2.0), "Chest", kind="PATCH")
    activate(layers[0])
    for layer in layers[1:]:
        layer.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert bpy.ops.planar.attach() == {"FINISHED"}
    np.testing.assert_allclose(joint_places(layers[0]), PLACES, atol=0.12)
    lean(layers[0])


def test_subdividing_keeps_hinges_in_their_places():
    obj = pinned(cell=0.2)
    before = joint_places(obj)
    in_edit_mode(obj, lambda: bpy.ops.mesh.subdivide(number_cuts=1))
    bpy.context.view_layer.update()
    np.testing.assert_allclose(joint_places(obj), before, atol=2e-4)
    lean(obj)


def test_a_joint_whose_part_is_gone_waits_and_the_others_hold():
    obj = pinned()
    in_edit_mode(
        obj, lambda: bpy.ops.mesh.delete(type="VERT"), select=lambda vertex: vertex.co.z == pytest.approx(0.2)
    )
    bpy.context.view_layer.update()
    assert len(obj.planar.pins) == 4
    assert len(gaps(obj)) == 2
    drag(obj, "Chest", (0.04, 0.02), angle=0.3)
    assert max(gaps(obj).values()) < HELD


def test_saved_and_loaded_and_appended(tmp_path):
    obj = pinned()
    drag(obj, "Chest", (0.04, 0.02), angle=0.3)
    before = evaluated(obj)
    path = str(tmp_path / "attached.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Figure"]
    assert np.array_equal(evaluated(obj), before)
    lean(obj, -0.2)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.append(filepath=f"{path}/Object/Figure", directory=f"{path}/Object/", filename="Figure")
    lean(bpy.data.objects["Figure"], -0.2)


def test_undo_takes_attach_back():
    obj = figure()
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.planar.attach()
    bpy.ops.ed.undo_push(message="Attach")
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Figure"]
    assert len(obj.planar.pins) == 0
    bpy.ops.ed.redo()
    obj = bpy.data.objects["Figure"]
    assert [pin.kind for pin in obj.planar.pins] == ["HINGE"] * 3
    assert len(gaps(obj)) == 3


def test_copied_mirrored_and_reset_poses_leave_joints_alone():
    obj = pinned()
    lean(obj)
    stored = [(pin.name, pin.kind, pin.has_target) for pin in obj.planar.pins if pin.kind == "HINGE"]
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    assert max(gaps(obj).values()) < HELD
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert max(gaps(obj).values()) < HELD
    bpy.ops.planar.select_pins(action="ALL")
    assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
    assert max(gaps(obj).values()) < HELD
    assert [(p.name, p.kind, p.has_target) for p in obj.planar.pins if p.kind == "HINGE"] == stored


def keyed():
    """A figure that swings its arm and leans, with in-betweens."""
    obj = pinned()
    pin_at(obj, (4.6, 3.2), "Hand")
    key(obj, 1)
    go_to(13)
    drag(obj, "Hand", (-0.1, 0.2))
    drag(obj, "Chest", (0.05, 0.0), angle=0.3)
    bpy.ops.planar.settle_pose()
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    return obj


def test_in_betweens_hold_the_joints():
    obj = keyed()
    for frame in range(1, 14):
        go_to(frame)
        assert max(gaps(obj).values()) < HELD, frame


def test_in_betweens_are_stale_once_joints_change():
    from planar_deform.scene.sequence import stretches

    obj = keyed()
    assert not stretches.stale(obj)
    obj.planar.pins[0].enabled = False
    assert len(stretches.stale(obj)) == 1
    assert stretches.why_stale(obj, 0) == ["pins"]
    obj.planar.pins[0].enabled = True
    assert not stretches.stale(obj)
    bpy.ops.planar.select_pins(action="NONE")
    assert bpy.ops.planar.detach() == {"FINISHED"}
    assert len(stretches.stale(obj)) == 1


def test_the_joints_of_a_dense_drawing_hold_through_its_coarse_mesh():
    """As without one, but for what a coarse mesh is off by."""
    came_to = []
    for above in (100_000, 4000):
        obj = pinned(cell=0.03)
        obj.planar.coarse_above = above
        pin_at(obj, (4.68, 3.2), "Hand", kind="PATCH", radius=0.2)
        key(obj, 1)
        go_to(13)
        drag(obj, "Chest", (0.05, 0.0), angle=0.3)
        assert max(gaps(obj).values()) < HELD
        came_to.append(shown(obj)[0])
    assert 8000 < len(obj.data.vertices) < 100_000
    assert np.abs(came_to[0] - came_to[1]).max() < 1e-3 * shown(obj)[1].cutout.diagonal
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert bpy.ops.planar.generate_inbetweens() == {"FINISHED"}
    for frame in (4, 7, 11):
        go_to(frame)
        assert max(gaps(obj).values()) < HELD


def test_remeshing_keeps_joints_in_their_places():
    obj = pinned()
    before = joint_places(obj)
    assert bpy.ops.planar.remesh(vertices=900) == {"FINISHED"}
    assert len(obj.data.vertices) != 1186
    np.testing.assert_allclose(joint_places(obj), before, atol=1e-3)
    lean(obj)


def test_a_weight_says_which_joint_gives_way():
    """The hand is pinned out of reach of the body: something has to give."""
    apart = {}
    for weight in (1.0, 1e-3):
        obj = pinned()
        pin_at(obj, (4.68, 3.2), "Hand", kind="PATCH", radius=0.2)
        wrist = obj.planar.pins[
            int(np.argmax([pin.kind == "HINGE" and far(obj, pin) for pin in obj.planar.pins]))
        ]
        wrist.weight = weight
        drag(obj, "Hand", (0.3, 0.0))
        apart[weight] = gaps(obj)[wrist.name]
    assert apart[1e-3] > 10.0 * apart[1.0]


def far(obj, pin):
    """How far to the right the group of a pin is, in the drawing's lengths."""
    index = obj.vertex_groups[pin.group].index
    rows = [vertex.co.x for vertex in obj.data.vertices if index in {group.group for group in vertex.groups}]
    return max(rows)
