# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches that are scaled: a head that grows, kept by drags, poses, files, mirrors and in-betweens."""

import bpy
import numpy as np
import pytest
from drawings import character
from filling import generate, shown
from sequences import go_to
from support import TRANSFORMS, activate, add_pins, bar, measured

HEAD = [11, 12, 24, 25, 37, 38]  # of a bar


def headed(transform="none", method="HOLD"):
    """A bar with a patch at its right end, selected, and a point at its left one."""
    obj = bar()
    obj.matrix_world = TRANSFORMS[transform]
    obj.planar.method = method
    add_pins(obj, [26])
    add_pins(obj, HEAD, kind="PATCH")
    activate(obj)
    return obj


def drawing_of(obj):
    from planar_deform.scene.objects.cutout_object import begin

    activate(obj)
    return begin(bpy.context)


def size(obj, index=1):
    """What a patch has grown by."""
    from planar_deform.model.posing.pins import Holder
    from planar_deform.scene.pins import pin_list

    drawing = drawing_of(obj)
    holder = Holder(pin_list.model_pins(obj, drawing)[index], drawing.cutout)
    return holder.fitted_scale(drawing.positions)


def grow(obj, factor, **options):
    activate(obj)
    assert bpy.ops.planar.spread_pins(factor=factor, **options) == {"FINISHED"}


@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_a_patch_alone_is_scaled_where_it_is(transform, factor):
    obj = headed(transform)
    before = drawing_of(obj).positions[HEAD].mean(axis=0)
    grow(obj, factor)
    assert size(obj) == pytest.approx(factor, rel=0.03)
    after = drawing_of(obj)
    assert np.linalg.norm(after.positions[HEAD].mean(axis=0) - before) < 2e-3 * after.diagonal
    assert obj.planar.pins[1].scale == pytest.approx(factor)
    assert measured(obj).flipped == 0


@pytest.mark.parametrize("method", ["HOLD", "AKVF", "ARAP"])
def test_drags_keep_it_and_nothing_drifts(method):
    obj = headed(method=method)
    grow(obj, 1.3)
    grown = size(obj)
    assert 1.15 < grown < 1.4
    for offset in ((0.1, 0.2), (-0.2, 0.1), (0.1, -0.3)) * 4:
        assert bpy.ops.planar.drag_pins(offset=offset) == {"FINISHED"}
    assert size(obj) == pytest.approx(grown, rel=0.02)
    assert obj.planar.pins[1].scale == pytest.approx(1.3)
    assert bpy.ops.planar.rotate_pins(angle=0.4) == {"FINISHED"}
    grow(obj, 1.0 / 1.3)
    assert obj.planar.pins[1].scale == pytest.approx(1.0)
    assert size(obj) == pytest.approx(1.0, rel=0.02)


def test_several_patches_are_spread_and_scaled_too_where_that_is_chosen():
    obj = headed()
    add_pins(obj, [0, 1, 13, 14], kind="PATCH")
    for index in (1, 2):
        obj.planar.pins[index].select = True
    obj.planar.pins[0].enabled = False
    grow(obj, 1.2)
    assert [pin.scale for pin in obj.planar.pins] == [1.0, 1.0, 1.0]
    wide = np.ptp(drawing_of(obj).positions[:, 0])
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    grow(obj, 1.2, scale_patches=True)
    np.testing.assert_allclose([pin.scale for pin in obj.planar.pins], [1.0, 1.2, 1.2], rtol=1e-6)
    assert np.ptp(drawing_of(obj).positions[:, 0]) > wide
    assert size(obj) == pytest.approx(1.2, rel=0.03)
    grow(obj, 1.5, scale_patches=True, axis="X")
    np.testing.assert_allclose(obj.planar.pins[1].scale, 1.2, rtol=1e-6)


def test_none_of_it_can_be_scaled_to_nothing():
    obj = headed()
    for factor in (0.0, -2.0):
        grow(obj, factor)
        assert obj.planar.pins[1].scale == pytest.approx(0.05)
        assert measured(obj).flipped == 0
        assert bpy.ops.planar.reset_selected_pins() == {"FINISHED"}
        assert obj.planar.pins[1].scale == pytest.approx(1.0)
        assert size(obj) == pytest.approx(1.0, rel=0.01)


def test_each_frame_has_the_scale_of_its_pose():
    obj = headed()
    go_to(1)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    go_to(13)
    grow(obj, 1.4)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    grown = size(obj)
    generate(obj)
    sizes = []
    for frame in range(1, 14):
        go_to(frame)
        sizes.append(size(obj))
    assert np.diff(sizes).min() > 0.0
    go_to(1)  # the head is in the same place there, and as large as at rest
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.1)) == {"FINISHED"}
    assert size(obj) == pytest.approx(1.0, rel=0.01)
    go_to(13)
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.1)) == {"FINISHED"}
    assert size(obj) == pytest.approx(grown, rel=0.03)


def test_copies_mirrors_undo_and_files_have_it(tmp_path):
    obj = headed()
    add_pins(obj, [0, 1, 13, 14, 26, 27], kind="PATCH")
    for index, pin in enumerate(obj.planar.pins):
        pin.select = index == 1
    bpy.ops.ed.undo_push(message="Before")
    grow(obj, 1.3)
    bpy.ops.ed.undo_push(message="Grown")
    assert bpy.ops.planar.copy_pose() == {"FINISHED"}
    assert bpy.ops.planar.reset_to_rest() == {"FINISHED"}
    assert obj.planar.pins[1].scale == 1.0
    assert bpy.ops.planar.paste_pose() == {"FINISHED"}
    assert obj.planar.pins[1].scale == pytest.approx(1.3)
    assert size(obj) == pytest.approx(1.3, rel=0.03)
    assert bpy.ops.planar.mirror_pose() == {"FINISHED"}
    assert size(obj, 1) == pytest.approx(1.0, rel=0.03)
    assert size(obj, 2) > 1.2
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "head.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "head.blend"))
    obj = bpy.data.objects["Cutout"]
    assert obj.planar.pins[2].scale == pytest.approx(1.3, rel=0.03)


def test_a_head_of_a_character_grows():
    obj = character("giraffe")
    drawing = drawing_of(obj)
    top = drawing.rest[drawing.rest[:, 1].argmax()]
    near = np.linalg.norm(drawing.rest - top, axis=1) < 0.1 * drawing.diagonal
    add_pins(obj, [drawing.vertex_indices[drawing.rest[:, 1].argmin()]])
    add_pins(obj, drawing.vertex_indices[near], kind="PATCH")
    grow(obj, 1.5)
    assert size(obj) == pytest.approx(1.5, rel=0.04)
    assert measured(obj).flipped == 0
    assert shown(obj, 1).shape == (len(obj.data.vertices), 3)
