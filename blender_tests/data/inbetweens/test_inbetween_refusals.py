# SPDX-License-Identifier: GPL-3.0-or-later
"""What in-betweens are refused for, and errors: nothing has changed then."""

import bpy
import pytest
from filling import bent_bar, everything, frames_shown, generate, remove, stale
from sequences import curve_of, go_to, key, same, shown_at
from support import activate, add_end_pins, bar, evaluated, from_library


def refused(obj, operator, match, **options):
    """It is refused with a reason, and nothing has changed."""
    before = everything(obj) if obj.data.shape_keys is not None else None
    activate(obj)
    if operator.poll():
        with pytest.raises(RuntimeError, match=match):
            operator(**options)
    else:
        with pytest.raises(RuntimeError, match="poll"):
            operator(**options)
        from planar_deform.scene.inbetweens import planning

        assert match in (planning.refusal(obj) or "There are no in-betweens")
    if before is not None:
        assert everything(obj) == before


def test_refusals_change_nothing():
    generating, removing = bpy.ops.planar.generate_inbetweens, bpy.ops.planar.remove_inbetweens
    obj = bar()
    refused(obj, generating, "Key two poses first")
    refused(obj, removing, "Key two poses first")
    add_end_pins(obj)
    key(obj, 1, 0)
    refused(obj, generating, "Key two poses first")
    key(obj, 2, 1)
    refused(obj, generating, "no frames to fill")
    refused(obj, removing, "There are no in-betweens")
    key(obj, 9)
    curve_of(obj).keyframe_points[1].co[0] = 1.5
    key(obj, 20, 4)
    curve = curve_of(obj)
    curve.lock = True
    refused(obj, generating, "locked")
    curve.lock = False
    generate(obj)
    curve.lock = True
    refused(obj, generating, "locked")
    refused(obj, removing, "locked")
    curve.lock = False
    obj.data.shape_keys.use_relative = True
    refused(obj, generating, "Relative")
    obj.data.shape_keys.use_relative = False
    obj.data.shape_keys.key_blocks[5].driver_add("value")
    refused(obj, removing, "drivers")
    obj.data.shape_keys.key_blocks[5].driver_remove("value")
    obj.lock_location[0] = True
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    refused(obj, generating, "shared")
    bpy.data.objects.remove(twin)
    remove(obj)


def test_a_shot_that_is_too_long_is_refused():
    obj, _ = bent_bar((1, 100_000))
    refused(obj, bpy.ops.planar.generate_inbetweens, "cut the shot")


def test_linked_objects_are_refused_and_play(tmp_path):
    obj, _poses = bent_bar()
    generate(obj)
    before = frames_shown(obj, range(1, 50, 6))
    obj = from_library(tmp_path)
    activate(obj)
    assert not bpy.ops.planar.generate_inbetweens.poll()
    assert not bpy.ops.planar.remove_inbetweens.poll()
    assert stale(obj) == []
    obj.planar.poses[1].frame = 30  # nothing happens
    for frame, seen in before.items():
        assert same(shown_at(obj, frame), seen)


@pytest.mark.parametrize("generated", [False, True])
def test_an_error_at_the_very_end_puts_everything_back(generated, monkeypatch):
    from planar_deform.scene.inbetweens import writing

    def fails(*_):
        raise MemoryError

    obj, _ = bent_bar()
    curve = curve_of(obj)
    curve.keyframe_points.insert(73, curve.keyframe_points[0].co[1])
    curve.update()
    if generated:
        generate(obj)
        obj.planar.poses[1].frame = 30
    go_to(20)
    before, seen = everything(obj), evaluated(obj)
    monkeypatch.setattr(writing, "remember", fails)
    with pytest.raises(RuntimeError, match="MemoryError"):
        bpy.ops.planar.generate_inbetweens()
    assert everything(obj) == before
    assert same(evaluated(obj), seen)
    monkeypatch.undo()
    generate(obj)
    assert stale(obj) == []
