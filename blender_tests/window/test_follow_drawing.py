# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins of a drawing that follow Empties: dragged by hand, played, scrubbed, rendered."""

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from cutouts import activate, carrying, imported, pin, pin_data, shape, sheet
from harness import Window, addon

HAND = (1.5, 0.0, 0.0)
FRAMES = 20


def ready(window: Window) -> Iterator[None]:
    """A drawing, turned and scaled as imported, whose two pins have controls, seen from the front."""
    obj = imported()
    pin((-1.5, 0.0, 0.0), HAND)
    activate(obj)
    yield from window.look("FRONT")
    with window.context():
        assert bpy.ops.planar.add_controls() == {"FINISHED"}
    activate(control())
    bpy.ops.ed.undo_push(message="Test Scene")
    yield from window.hover(window.pixel(HAND))
    yield from window.wait(0.5)


def drawing() -> bpy.types.Object:
    return bpy.data.objects["Imported"]


def control(index: int = 1) -> bpy.types.Object:
    return drawing().planar.pins[index].follow


def hand(obj: bpy.types.Object | None = None) -> np.ndarray:
    """Where the right pin is seen."""
    obj = obj or drawing()
    group = obj.vertex_groups[obj.planar.pins[1].group].index
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    held = [
        (vertex.index, g.weight) for vertex in obj.data.vertices for g in vertex.groups if g.group == group
    ]
    places = [obj.matrix_world @ seen.vertices[index].co for index, _ in held]
    return np.average(places, axis=0, weights=[weight for _, weight in held])


def swinging() -> None:
    for frame, z in ((1, 0.0), (FRAMES // 2, 0.8), (FRAMES, -0.4)):
        control().location.z = z
        control().keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = FRAMES
    bpy.context.scene.frame_set(1)


def test_the_drawing_follows_while_its_control_is_dragged(window: Window) -> Iterator[None]:
    yield from ready(window)
    before, pins = shape(drawing()), pin_data(drawing())
    yield from window.key("G")
    yield from window.move(window.pixel((1.3, 0.0, 0.8)), steps=6)
    yield from window.wait(0.5)
    moved = np.array(control().matrix_world.translation)
    assert moved[2] > 0.4, moved
    assert np.linalg.norm(hand() - moved) < 0.03, "before the button is released"
    window.picture("follow")
    yield from window.key("ESC")
    yield from window.wait(0.5)
    assert np.array_equal(shape(drawing()), before), "to the bit"
    assert pin_data(drawing()) == pins
    yield from window.use_tool()  # in which G is of pins
    yield from window.hover(window.pixel(HAND))
    yield from window.key("G")
    yield from window.move(window.pixel((1.3, 0.0, 0.8)), steps=6)
    yield from window.confirm()
    yield from window.wait(0.5)
    after = shape(drawing())
    assert np.abs(after - before).max() > 0.1
    yield from window.undo()
    yield from window.wait(0.5)
    assert np.allclose(shape(drawing()), before, atol=1e-5), "with one undo"
    yield from window.redo()
    yield from window.wait(0.5)
    assert np.allclose(shape(drawing()), after, atol=1e-5)


def test_undo_does_not_tell_again_why_live_went_off(window: Window) -> Iterator[None]:
    """A message at the mouse would take the next Ctrl-Z."""
    yield from ready(window)
    live, told = addon("operators.live"), []
    tell, live._tell = live._tell, lambda message, _title: told.append(message)
    try:
        with window.context():
            bpy.ops.object.delete("EXEC_DEFAULT", True)
        yield from window.wait(0.4)
        assert ["is not in the scene" in message for message in told] == [True]
        activate(drawing())
        bpy.ops.ed.undo_push(message="Select")
        yield from window.undo()  # to where the control has just been deleted
        yield from window.wait(0.4)
        assert (len(told), drawing().planar.live) == (1, False)
        yield from window.undo()
        yield from window.wait(0.4)
        assert (len(told), drawing().planar.live) == (1, True)
        with window.context():
            bpy.ops.object.delete("EXEC_DEFAULT", True)
        yield from window.wait(0.4)
        assert len(told) == 2, "again, as it has been done again"
    finally:
        live._tell = tell


def test_what_a_drawing_carries_goes_along_in_the_same_drag(window: Window) -> Iterator[None]:
    """Dragged by its pin it takes its lantern along before the button is released; Esc takes both back."""
    carried = sheet("Lantern", columns=2, rows=4, at=(1.5, -0.05, -0.5))
    bpy.ops.planar.add_pin(location=(1.5, -0.05, -0.1))
    bpy.ops.planar.add_pin(location=(1.5, -0.05, -0.9), extend=True)
    yield from carrying(window, carried)
    yield from window.hover(window.pixel(HAND))
    yield from window.wait(0.5)

    def now() -> list[np.ndarray]:
        return [shape(bpy.data.objects[name]) for name in ("Sheet", "Lantern")]

    before = now()
    yield from window.press()
    yield from window.move(window.pixel((1.2, 0.0, 0.7)), steps=6)
    yield from window.wait(0.5)
    window.picture("carried")
    assert (now()[1] - before[1]).mean(axis=0)[2] > 0.5, "before the button is released"
    yield from window.key("ESC")
    yield from window.release()
    yield from window.wait(0.5)
    assert np.array_equal(now()[0], before[0]), "to the bit"
    assert np.array_equal(now()[1], before[1])
    yield from window.drag(window.pixel(HAND), window.pixel((1.2, 0.0, 0.7)))
    yield from window.wait(0.5)
    after = now()
    assert np.abs(after[1] - before[1]).max() > 0.5
    for step, shapes in ((window.undo, before), (window.redo, after)):
        yield from step()
        yield from window.wait(0.5)
        assert np.allclose(now()[0], shapes[0], atol=1e-5)
        assert np.allclose(now()[1], shapes[1], atol=1e-5)


def test_the_timeline_plays_it(window: Window) -> Iterator[None]:
    yield from ready(window)
    swinging()
    yield from window.wait(0.3)
    gaps, frames = [], []

    def see(scene, _depsgraph) -> None:  # called behind the add-on's
        place = np.array(control().matrix_world.translation)
        frames.append(scene.frame_current)
        gaps.append((place, shape(drawing())))

    bpy.app.handlers.frame_change_post.append(see)
    try:
        with window.context():
            bpy.ops.screen.animation_play()
        yield from window.wait(3.0)
        window.picture("follow_played")
        yield from window.key("ESC")
        yield from window.wait(0.3)
    finally:
        bpy.app.handlers.frame_change_post.remove(see)
    assert len(set(frames)) >= 5, frames
    yield from window.wait(0.3)
    shapes = dict(zip(frames, (each for _, each in gaps), strict=True))
    for frame in sorted(shapes, reverse=True):
        bpy.context.scene.frame_set(frame)
        assert np.linalg.norm(hand() - control().matrix_world.translation) < 0.03
        assert np.abs(shape(drawing()) - shapes[frame]).max() < 1e-5, "as it was played"


def test_a_bake_is_ended_by_escape(window: Window) -> Iterator[None]:
    yield from ready(window)
    swinging()
    bpy.context.scene.frame_end = 2000
    bpy.context.scene.frame_set(5)
    activate(drawing())
    yield from window.wait(0.3)
    before, pins = shape(drawing()), pin_data(drawing())
    with window.context():
        assert bpy.ops.planar.bake_pins("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    yield from window.wait(1.0)
    assert addon("operators.modal.running").now() is not None, "it is under way"
    yield from window.key("ESC")
    yield from window.wait(0.5)
    assert addon("operators.modal.running").now() is None
    assert drawing().data.shape_keys is None
    assert bpy.context.scene.frame_current == 5
    assert np.array_equal(shape(drawing()), before), "to the bit"
    assert pin_data(drawing()) == pins
    assert drawing().planar.live
    bpy.context.scene.frame_set(10)
    assert np.linalg.norm(hand() - control().matrix_world.translation) < 0.03, "and Live goes on"


def rendered(window: Window, folder: Path, *, lock: bool) -> Iterator[None]:
    """A film of the first and the highest frame, rendered as from the Render menu."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 6.0
    camera.location, camera.rotation_euler = (0.0, -10.0, 0.0), (np.pi / 2, 0.0, 0.0)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y = 64, 64
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(folder / "frame_")
    scene.frame_step = FRAMES // 2 - 1
    scene.render.use_lock_interface = lock
    bpy.context.preferences.view.render_display_type = "NONE"
    with window.context():
        assert bpy.ops.render.render("INVOKE_DEFAULT", animation=True) == {"RUNNING_MODAL"}
    yield from window.wait(0.5)
    while bpy.app.is_job_running("RENDER"):
        yield from window.wait(0.2)
    yield from window.wait(0.5)


def highest(path: Path) -> float:
    """How high at its right end the drawing reaches in a picture, of its half."""
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:]).reshape(64, 64, 4)[..., 3] > 0.5
    rows = np.flatnonzero(pixels[:, 50:].any(axis=1))
    return (rows.max() - 31.5) / 32.0 if len(rows) else -1.0


def test_a_locked_window_renders_it(window: Window) -> Iterator[None]:
    yield from ready(window)
    swinging()
    folder = Path(bpy.app.tempdir)
    yield from rendered(window, folder, lock=True)
    first, high = (highest(folder / f"frame_{frame:04}.png") for frame in (1, FRAMES // 2))
    assert high - first > 0.15, (first, high)
    assert np.linalg.norm(hand() - control().matrix_world.translation) < 0.03, "and is right again behind it"


def test_a_window_that_draws_meanwhile_says_that_it_does_not(window: Window) -> Iterator[None]:
    yield from ready(window)
    swinging()
    said: list[str] = []
    live = addon("operators.live")
    tell = live.tell
    live.tell = lambda message, title: said.append(message)
    before = shape(drawing())
    try:
        yield from rendered(window, Path(bpy.app.tempdir), lock=False)
        yield from window.wait(0.3)
    finally:
        live.tell = tell
    assert len(said) == 1, said
    assert "Turn on Lock Interface in the Render menu" in said[0]
    assert np.abs(shape(drawing()) - before).max() < 1e-5
    assert drawing().planar.live
