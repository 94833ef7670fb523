# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweens in the window: keyed from the panel, generated, played, posed on, stale, undone, taken away."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import active, moved
from harness import Window, addon
from poses import at, go_to, pull, shown, stored, three_poses, timing

KEYED = (1, 25, 49)


def linear(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return (first + second) / 2


def generate(window: Window) -> Iterator[None]:
    yield from window.push("planar.generate_inbetweens")
    while window.busy:
        yield
    yield


def stale() -> list[tuple[int, int]]:
    return list(addon("scene.sequence.stretches").stale(active()))


def outlined(window: Window, pose: np.ndarray, channel: int) -> bool:
    """Whether the last corner of a pose is drawn in green (channel 1) or blue (2)."""
    place = window.pixel([float(x) for x in pose[-1]])
    return any(
        colour[channel] > 50 + max(colour[other] for other in range(3) if other != channel)
        for colour in window.colours(place, 4)
    )


def test_the_story(window: Window) -> Iterator[None]:
    yield from three_poses(window, push=True)
    poses = {frame: at(frame) for frame in KEYED}
    blended = {frame: at(frame) for frame in (13, 37)}
    assert np.allclose(blended[13], linear(poses[1], poses[25]), atol=1e-6)
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_end = 49
    keys = timing()
    yield from generate(window)
    assert [key[0] for key in timing()] == [key[0] for key in keys], (
        "the curve has a key for each pose, as before"
    )
    for frame, pose in poses.items():
        assert np.array_equal(at(frame), pose), frame
    frames = {frame: at(frame) for frame in range(1, 50)}
    assert moved(frames[13], blended[13]) > 0.02, "an arc, and no blend"
    steps = [moved(frames[frame], frames[frame + 1]) for frame in range(1, 49)]
    assert max(steps[:24]) < 3 * max(min(steps[:24]), 1e-3), "evenly timed, without jumps"
    assert stale() == []

    bpy.context.scene.frame_set(1)
    active().planar.show_onion = True
    yield from window.hover((400, 300))
    for _ in range(3):  # scrub by keys
        yield from window.key("RIGHT_ARROW")
    assert bpy.context.scene.frame_current == 4
    assert np.array_equal(shown(), frames[4])
    bpy.context.scene.frame_set(13)
    yield from window.wait(0.5)
    window.picture("inbetweens")
    assert outlined(window, poses[1], 1), "the onion skin of the pose before"
    assert outlined(window, poses[25], 2), "and of the one behind"
    seen: dict[int, bytes] = {}

    def watch(drawing, depsgraph) -> None:
        mesh = active().evaluated_get(depsgraph).data
        coordinates = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", coordinates)
        seen[drawing.frame_current] = coordinates.tobytes()

    bpy.app.handlers.frame_change_post.append(watch)
    try:
        yield from window.key("SPACE")
        assert window.window.screen.is_animation_playing
        while len(seen) < 8:
            yield
        assert not outlined(window, poses[1], 1), "not while it plays"
        yield from window.key("SPACE")
    finally:
        bpy.app.handlers.frame_change_post.remove(watch)
    assert not window.window.screen.is_animation_playing
    for frame, coordinates in seen.items():
        assert coordinates == frames[frame].tobytes(), f"played, frame {frame}"


def test_a_pose_on_a_generated_frame_is_unkeyed_and_lost_and_with_auto_key_keyed(
    window: Window,
) -> Iterator[None]:
    yield from three_poses(window)
    yield from generate(window)
    generated = at(13)
    yield from go_to(13)
    yield from pull(window, 0.0, 0.8)
    assert moved(shown(), generated) > 0.3
    assert addon("scene.sequence.pose_state").unkeyed(active())
    yield from window.wait(0.5)
    window.picture("inbetweens_unkeyed")
    bpy.context.scene.frame_set(14)
    assert np.array_equal(at(13), generated)
    yield from go_to(13)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    yield from pull(window, 0.0, 0.8)
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = False
    posed = shown()
    assert len(active().planar.poses) == 4
    assert not addon("scene.sequence.pose_state").unkeyed(active())
    assert np.array_equal(at(13), posed)
    assert len(stale()) == 2
    yield from window.wait(0.5)
    window.picture("inbetweens_stale")
    yield from go_to(13)
    yield from generate(window)
    assert stale() == []
    assert np.array_equal(at(13), posed)
    yield from window.undo()
    assert len(stale()) == 2
    for _ in range(2):  # the frame change as well
        yield from window.undo()
    assert len(active().planar.poses) == 3
    assert np.array_equal(at(13), generated)
    assert stale() == []


def test_an_edited_pose_makes_its_stretches_stale_until_they_are_generated_again(
    window: Window,
) -> Iterator[None]:
    yield from three_poses(window)
    yield from generate(window)
    generated = {frame: at(frame) for frame in (13, 37, 25)}
    yield from go_to(25)
    yield from pull(window, 0.0, -0.6)
    edited = shown()
    assert moved(edited, generated[25]) > 0.3
    assert len(stale()) == 2
    assert np.array_equal(at(13), generated[13]), "nothing is made again behind the user's back"
    yield from go_to(25)
    yield from generate(window)
    again = at(13)
    assert moved(again, generated[13]) > 0.05
    assert np.array_equal(at(25), edited)
    for _ in range(3):
        yield from window.undo()
    assert stale() == []
    for frame, shape in generated.items():
        assert np.array_equal(at(frame), shape), frame
    for _ in range(3):
        yield from window.redo()
    assert np.array_equal(at(13), again)
    assert stale() == []


def test_the_whole_way_is_undone_and_redone_step_by_step(window: Window) -> Iterator[None]:
    yield from three_poses(window)
    states = [stored()]
    yield from generate(window)
    states.append(stored())
    yield from window.push("planar.remove_inbetweens")
    states.append(stored())
    assert states[2] == states[0], "removing puts everything back to the bit"
    yield from generate(window)
    assert stored() == states[1]
    for state in (states[2], states[1], states[0]):
        yield from window.undo()
        assert stored() == state
    for _ in range(3):  # the poses themselves
        yield from window.undo()
    assert len(active().planar.poses) < 3
    for _ in range(6):
        yield from window.redo()
    assert stored() == states[1]
