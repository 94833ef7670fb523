# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Pins of drawings: what Live shows, as poses and as a point cache."""

import bpy
import numpy as np
import pytest
from baking import read_pc2
from follow_scenes import HAND, film, held, in_poses, swinging, with_control
from sequences import curve_of, stored
from support import activate, coordinates

from planar_deform.scene.motion import bake_pins, live

FRAMES = range(1, 18)
SAME = 1e-5  # of a drawing 2 long in its own space


def alive(**options):
    obj, control = with_control(kind="PATCH", **options)
    swinging(control)
    obj.planar.live = True
    return obj


def growing():
    """A drawing that is stretched more and more along one of its axes."""
    obj = alive()
    for frame, scale in ((1, 0.6), (17, 0.9)):
        obj.scale.x = scale
        obj.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    return obj


SCENES = {
    "drawing": alive,
    "growing": growing,
    "parented": lambda: alive(parented=True),
    "poses": lambda: in_poses(live=True)[0],
}


def pins_of(obj):
    return [
        (tuple(pin.target), tuple(pin.reached), pin.has_target, pin.angle, tuple(pin.follow_offset))
        for pin in obj.planar.pins
    ]


@pytest.mark.parametrize("scene", SCENES)
def test_poses_are_what_live_shows(scene):
    obj = SCENES[scene]()
    shapes = film(obj, FRAMES)
    bpy.context.scene.frame_set(4)
    assert bpy.ops.planar.bake_pins(frame_start=1, frame_end=17) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 4
    assert not obj.planar.live, "what is keyed plays"
    assert not curve_of(obj).mute
    assert len(curve_of(obj).keyframe_points) == len(FRAMES)
    for frame, shape in film(obj, FRAMES).items():
        np.testing.assert_allclose(shape, shapes[frame], atol=SAME)


@pytest.mark.parametrize("scene", SCENES)
def test_a_point_cache_is_what_live_shows(scene, tmp_path):
    obj = SCENES[scene]()
    shapes = film(obj, FRAMES)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    before = coordinates(obj.data.vertices)
    assert bpy.ops.planar.bake_pins(to="POINT_CACHE", frame_start=1, frame_end=17, frame_step=4) == {
        "FINISHED"
    }
    (start, rate), samples = read_pc2(tmp_path / f"{obj.name}_planar.pc2")
    assert (start, rate) == (1.0, 4.0)
    for frame, sample in zip(FRAMES[::4], samples, strict=True):
        np.testing.assert_allclose(sample, shapes[frame], atol=SAME)
    assert not obj.planar.live
    for frame, shape in film(obj, FRAMES[::4]).items():
        np.testing.assert_allclose(shape, shapes[frame], atol=SAME)
    np.testing.assert_allclose(coordinates(obj.data.vertices), before, atol=SAME)
    assert not obj.planar.cache_stamp


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("to", ["POSES", "POINT_CACHE"])
def test_ended_before_its_end_all_is_as_it_was(scene, to, tmp_path):
    obj = SCENES[scene]()
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.context.scene.frame_set(7)
    before, pins = stored(obj), pins_of(obj)
    for taken in (1, 5, 17):
        steps = (
            bake_pins.to_poses(obj, FRAMES)
            if to == "POSES"
            else bake_pins.to_point_cache(obj, FRAMES, "//bake.pc2")
        )
        shares = [next(steps) for _ in range(taken)]
        assert shares == sorted(shares)
        steps.close()
        assert (stored(obj), pins_of(obj)) == (before, pins)
        assert bpy.context.scene.frame_current == 7
        assert [file.name for file in tmp_path.iterdir()] == ["shot.blend"]
        assert obj.planar.live
    bpy.context.scene.frame_set(9)
    assert pins_of(obj) != pins, "and Live goes on"


def test_without_live_the_drawing_itself_does_not_move_meanwhile(monkeypatch):
    obj = alive()
    obj.planar.live = False
    bpy.context.scene.frame_set(1)
    before, seen = coordinates(obj.data.vertices), []
    steps = bake_pins.to_poses(obj, FRAMES)
    for _ in range(9):
        next(steps)
        seen.append(np.abs(coordinates(obj.data.vertices) - before).max())
    steps.close()
    assert max(seen) == 0.0
    assert not live.objects()


def test_pins_that_follow_nothing_stand_in_all_frames():
    obj = alive()
    bpy.ops.planar.drag_pins(pin=0, offset=(-0.1, 0.1))
    there = held(obj, [26])
    bpy.ops.planar.bake_pins(frame_start=1, frame_end=17)
    gaps = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        gaps.append(np.linalg.norm(held(obj, [26]) - there))
    assert max(gaps) < 4e-3
    assert HAND


def test_what_cannot_be_baked_is_refused_and_nothing_has_changed():
    obj = alive()
    before = stored(obj)
    with pytest.raises(RuntimeError, match="The point cache is kept beside the .blend: save that first"):
        bpy.ops.planar.bake_pins(to="POINT_CACHE", frame_start=1, frame_end=3)
    with pytest.raises(RuntimeError, match="The last frame is before the first one: exchange them"):
        bpy.ops.planar.bake_pins(frame_start=3, frame_end=1)
    control = obj.planar.pins[1].follow
    activate(control)
    bpy.ops.object.delete()
    activate(obj)
    with pytest.raises(RuntimeError, match="is not in the scene: bring it back"):
        bpy.ops.planar.bake_pins(frame_start=1, frame_end=3)
    assert stored(obj) == before
    obj.planar.pins[1].follow = None
    with pytest.raises(RuntimeError, match="No pin follows anything: choose what below Follow"):
        bpy.ops.planar.bake_pins(frame_start=1, frame_end=3)
