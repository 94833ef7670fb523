# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses of a lattice over time, by hand: keyed with I, filled in from the panel, played, undone."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved
from harness import Window
from poses import go_to, shown
from test_lattice_posing import LEFT, RIGHT, beside, place, points, ready
from test_record import done, start, up_and_on


def meshes() -> np.ndarray:
    return np.concatenate([shown(bpy.data.objects["Back"]), shown(bpy.data.objects["Front"])])


def at(frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    return meshes()


def two_poses(window: Window) -> Iterator[dict[int, np.ndarray]]:
    """Pinned at both ends, keyed with I at frames 1 and 13, the right end far up at the second."""
    yield from ready(window)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    yield from window.hover(window.pixel((0.5, 0.0, 0.0)))
    yield from window.key("I")
    yield from go_to(13)
    yield from window.drag(window.pixel(place(1)), window.pixel(beside(place(1), -1.4, 1.6)))
    yield from window.hover(window.pixel((0.5, 0.0, 0.0)))
    yield from window.key("I")
    assert [pose.frame for pose in active().planar.poses] == [1, 13], window.reports()


def test_a_lattice_is_keyed_filled_in_and_played(window: Window) -> Iterator[None]:
    yield from two_poses(window)
    keyed = {13: meshes()}
    keyed[1] = at(1)
    assert moved(keyed[1], keyed[13]) > 0.5
    blended = {frame: at(frame) for frame in range(1, 14)}
    yield from window.sidebar()
    yield from window.push("planar.generate_inbetweens")
    while window.busy:
        yield
    yield
    assert len(active().data.shape_keys.key_blocks) == 2 + 13, window.reports()
    for frame, pose in keyed.items():
        assert moved(at(frame), pose) < 1e-5
    generated = {frame: at(frame) for frame in range(1, 14)}
    assert moved(generated[7], blended[7]) > 0.02, "an arc, and no blend"

    yield from window.hover(window.pixel((0.5, 0.0, 0.0)))
    yield from window.undo()
    assert len(active().data.shape_keys.key_blocks) == 2 + 2, "generating is one step"
    assert moved(at(7), blended[7]) < 1e-5
    yield from window.redo()
    assert moved(at(7), generated[7]) < 1e-5

    active().planar.show_onion = True
    bpy.context.scene.frame_set(7)
    yield from window.wait(0.3)
    window.picture("lattice_keys")
    seen: dict[int, np.ndarray] = {}

    def watch(scene: bpy.types.Scene, _depsgraph: bpy.types.Depsgraph) -> None:
        seen[scene.frame_current] = meshes()

    bpy.context.scene.frame_end = 13
    yield from window.hover(window.pixel((0.5, 0.0, 0.0)))
    bpy.app.handlers.frame_change_post.append(watch)
    try:
        yield from window.key("SPACE")
        while len(seen) < 5:
            yield
        yield from window.key("SPACE")
    finally:
        bpy.app.handlers.frame_change_post.remove(watch)
    for frame, pose in seen.items():
        assert moved(pose, generated[frame]) < 1e-5, frame


def test_a_drag_on_a_key_changes_that_pose_and_elsewhere_goes_with_the_frame(
    window: Window,
) -> Iterator[None]:
    yield from two_poses(window)
    first, second = at(1), at(13)
    yield from go_to(13)
    yield from window.drag(window.pixel(place(1)), window.pixel(beside(place(1), 0.2, -0.3)))
    changed = meshes()
    assert moved(changed, second) > 0.1
    assert moved(at(1), first) == 0.0
    assert moved(at(13), changed) == 0.0
    yield from go_to(6)
    between = meshes()
    yield from window.drag(window.pixel(place(1)), window.pixel(beside(place(1), 0.2, 0.4)))
    assert moved(meshes(), between) > 0.1
    yield from window.hover(window.pixel(place(1)))
    yield from window.press()
    yield from window.move(window.pixel(beside(place(1), 0.4, 0.4)), steps=5)
    yield from window.wait(0.2)
    yield from window.key("ESC")
    yield from window.release()
    assert moved(meshes(), between) > 0.1, "what the first drag has left"
    yield from go_to(5)
    assert moved(at(6), between) == 0.0


def test_the_motion_of_a_pin_is_recorded_and_escape_discards_it(window: Window) -> Iterator[None]:
    yield from ready(window)
    for spot in (LEFT, RIGHT):
        yield from window.click(window.pixel(spot), ctrl=True)
    own, before = points(), meshes()
    yield from start(window)
    yield from up_and_on(window, 5)
    assert moved(meshes(), before) > 0.02
    yield from window.key("ESC")
    yield from window.release()
    yield from done(window)
    assert active().data.shape_keys is None
    assert np.array_equal(points(), own)
    yield from start(window)
    yield from up_and_on(window, 12)
    yield from window.release()
    yield from done(window)
    frames = sorted(int(pose.frame) for pose in active().planar.poses)
    assert frames[0] == 1, window.reports()
    assert len(frames) >= 13
    heights = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        heights.append(place(1)[2])
        assert np.allclose(place(0), LEFT, atol=0.05)
    assert heights[-1] > 0.5, heights
    assert np.diff(heights).min() > -0.02, "the motion was upwards"
    yield from window.undo()
    assert active().data.shape_keys is None, "one undo step"
    assert np.array_equal(points(), own)
