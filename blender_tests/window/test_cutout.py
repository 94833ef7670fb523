# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts of images by hand: dropped, chosen in the file browser, with settings changed after that."""

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import bpy
import imported
import numpy as np
from cutouts import active, sheet
from harness import Window, addon
from poses import pin_place
from test_menus import search

ORANGE = (255, 140, 26)  # the preview's outline


def doll() -> Path:
    return imported.save_png(Path(tempfile.mkdtemp()) / "doll.png", imported.painted())


def blocks() -> tuple[int, ...]:
    data = bpy.data
    return tuple(map(len, (data.objects, data.meshes, data.materials, data.images)))


def drop(window: Window, *paths: Path) -> Iterator[None]:
    """What Blender does when files are let go over the 3D view; it asks which of its ways to take them."""
    yield from window.hover(window.pixel((0.0, 0.0, 0.4)))
    with window.context():
        bpy.ops.wm.drop_import_file(
            "INVOKE_DEFAULT", directory=str(paths[0].parent), files=[{"name": path.name} for path in paths]
        )
    yield from window.wait(0.4)


def near(colour: tuple[int, int, int], other: tuple[int, int, int]) -> bool:
    return max(abs(a - b) for a, b in zip(colour, other, strict=True)) < 60


def outlined(window: Window) -> int:
    """How many pixels near the doll's head have the colour of the outline."""
    top = window.pixel((0.0, 0.0, (600 - 320) / 600))
    return sum(near(colour, ORANGE) for colour in window.colours(top, radius=60))


def looking(window: Window) -> Iterator[None]:
    yield from window.look("FRONT", distance=4.5)
    bpy.ops.ed.undo_push(message="Test Scene")


def done(window: Window, operator: str = "PLANAR_OT_cutout_from_image") -> Iterator[None]:
    """Until it is."""
    for _ in range(600):
        if not window.busy:
            break
        yield
    yield from window.wait(0.3)
    assert bpy.context.window_manager.operators[-1].bl_idname == operator, window.reports()


def test_a_dropped_drawing_is_a_cutout_with_its_mesh_seen(window: Window) -> Iterator[None]:
    yield from looking(window)
    before = blocks()
    yield from drop(window, doll())
    window.picture("cutout_drop")
    yield from window.key("C")  # the entry's underlined letter
    yield from done(window)
    obj = active()
    assert (obj.name, obj.select_get(), obj.mode) == ("doll", True, "OBJECT")
    assert window.area.spaces.active.shading.color_type == "TEXTURE"
    window.picture("cutout_preview")
    assert outlined(window) > 40
    # A click beside it is something else: what was shown for changing settings goes.
    yield from window.click(window.pixel((0.9, 0.0, 0.0)))
    yield from window.wait(0.3)
    window.picture("cutout_after")
    assert outlined(window) == 0
    yield from window.undo()
    yield from window.undo()
    assert blocks() == before
    yield from window.redo()
    assert len(active().data.vertices) > 1000
    assert not window.reports().count("Error"), window.reports()


def field(window: Window, value: str) -> Iterator[None]:
    """Move the mouse to the field of a number, in the popup that is under it."""
    x, start = window.mouse[0] + 200, window.mouse[1]
    for y in range(start + 40, start - 420, -7):
        yield from window.move((x, y))
        bpy.context.window_manager.clipboard = ""
        yield from window.key("C", ctrl=True)
        if bpy.context.window_manager.clipboard.startswith(value):
            return
    raise AssertionError(f"no field with {value}")


def retype(window: Window, value: str, other: str, picture: str) -> Iterator[None]:
    """Type another number over one of the last operator's, without Enter."""
    yield from window.hover(window.pixel((0.0, 0.0, 0.3)))
    yield from window.key("F9")
    yield from window.wait(0.4)
    window.picture(picture)
    yield from field(window, value)
    yield from window.key("RET")
    yield from window.key("A", ctrl=True)
    yield from window.type(other)


def test_settings_can_be_changed_afterwards(window: Window) -> Iterator[None]:
    yield from looking(window)
    before = blocks()
    with window.context():
        path = doll()
        bpy.ops.planar.cutout_from_image("INVOKE_DEFAULT", True, filepath=str(path))
    yield from done(window)
    first, count = active().session_uid, len(active().data.vertices)
    made = blocks()
    yield from retype(window, "1500", "4000", "cutout_redo")
    start = time.monotonic()
    yield from window.press("RET")
    while active().session_uid == first:
        yield
    print(f"a changed setting took {time.monotonic() - start:.2f} s, a redraw and a tick of 0.1 s included")
    yield from window.release("RET")
    yield from window.wait(0.5)
    window.picture("cutout_redone")
    assert active().session_uid != first
    assert len(active().data.vertices) > 2 * count
    assert blocks() == made
    assert outlined(window) > 40
    yield from window.move((window.mouse[0] - 500, window.mouse[1] - 300), steps=6)
    yield from window.key("ESC")  # 5.2 leaves the popup open
    yield from window.undo()
    assert blocks() == before


def test_files_are_chosen_in_the_file_browser(window: Window) -> Iterator[None]:
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    yield from looking(window)
    path = doll()
    yield from search(window, "Cutout from Image")
    yield from window.wait(0.5)
    area = next(area for area in window.window.screen.areas if area.type == "FILE_BROWSER")
    area.spaces.active.params.directory = str(path.parent).encode()
    area.spaces.active.params.filename = path.name
    yield from window.wait(0.5)
    window.picture("cutout_browser")
    yield from window.hover((area.x + area.width // 2, area.y + area.height // 2))
    yield from window.key("RET")
    yield from window.wait(0.3)
    yield from done(window)
    assert active().name == "doll"
    yield from window.undo()
    assert "doll" not in bpy.data.objects


def test_many_files_show_how_far_they_are_and_escape_leaves_nothing(window: Window) -> Iterator[None]:
    mine = sheet("Mine")
    yield from looking(window)
    before = blocks()
    folder, picture = Path(tempfile.mkdtemp()), imported.painted()
    paths = [imported.save_png(folder / f"doll_{number}.png", picture) for number in range(12)]
    with window.context():
        result = bpy.ops.planar.cutout_from_image(
            "INVOKE_DEFAULT",
            True,
            directory=str(folder),
            files=[{"name": path.name} for path in paths],
            vertices=20000,
        )
    assert result == {"RUNNING_MODAL"}
    yield from window.wait(0.5)
    assert window.busy == ["PLANAR_OT_cutout_from_image"]
    window.picture("cutout_progress")
    yield from window.key("ESC")
    yield
    assert window.busy == []
    assert blocks() == before
    assert active() == mine
    assert list(bpy.context.selected_objects) == [mine]
    assert not window.reports().count("Error"), window.reports()


def test_a_plane_that_is_there_becomes_a_cutout(window: Window) -> Iterator[None]:
    yield from looking(window)
    path = doll()
    with window.context():
        bpy.ops.image.import_as_mesh_planes(
            files=[{"name": path.name}], directory=str(path.parent), align_axis="-Y", size_mode="DPBU"
        )
    bpy.ops.ed.undo_push(message="Plane")
    yield from search(window, "Make Cutout")
    yield from done(window, "PLANAR_OT_make_cutout")
    assert active().name == "doll"
    assert len(active().data.polygons) > 1000
    assert outlined(window) > 40
    yield from window.undo()
    assert len(active().data.polygons) == 1
    assert not window.reports().count("Error"), window.reports()


def at(pixel: tuple[int, int]) -> tuple[float, float, float]:
    """A pixel of the doll in the world."""
    return ((pixel[0] - imported.WIDTH / 2) / 600, 0.0, (pixel[1] - imported.HEIGHT / 2) / 600)


def test_dropped_pinned_dragged_keyed_and_filled_in(window: Window) -> Iterator[None]:
    """The way that the README begins with."""
    yield from looking(window)
    yield from drop(window, doll())
    yield from window.key("C")
    yield from done(window)
    yield from window.use_tool()
    for pixel in (imported.HEAD, imported.BELLY, imported.LEFT_HAND):
        yield from window.click(window.pixel(at(pixel)), ctrl=True)
    obj = active()
    assert len(obj.planar.pins) == 3
    assert addon("scene.image.preview").now(bpy.context) is None
    yield from window.key("I")
    bpy.context.scene.frame_set(11)
    x, y, z = at(imported.LEFT_HAND)
    yield from window.drag(window.pixel((x, y, z)), window.pixel((x + 0.1, y, z + 0.25)))
    yield from window.key("I")
    yield from search(window, "Generate In")
    for _ in range(200):
        if not window.busy:
            break
        yield
    window.picture("cutout_filled_in")
    assert len(obj.planar.poses) == 2

    def hand(frame: int) -> np.ndarray:
        bpy.context.scene.frame_set(frame)
        return pin_place(2)

    places = np.array([hand(frame) for frame in range(1, 12)])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.min() > 0.0
    assert steps.sum() > 0.25, "it goes up"
    assert not window.reports().count("Error"), window.reports()


def test_what_cannot_be_cut_out_is_told_in_the_status_bar(window: Window) -> Iterator[None]:
    yield from looking(window)
    before = blocks()
    clear = imported.painted() * 0.0
    path = imported.save_png(Path(tempfile.mkdtemp()) / "clear.png", clear)
    told = ""
    with window.context():
        try:
            bpy.ops.planar.cutout_from_image("INVOKE_DEFAULT", True, filepath=str(path))
        except RuntimeError as error:
            told = str(error)
    assert "all of it is transparent" in told
    yield
    assert blocks() == before
