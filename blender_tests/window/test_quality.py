# SPDX-License-Identifier: GPL-3.0-or-later
"""Quality as colours on the drawing, with a legend, and as totals in the panel."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, ready, shape, sheet
from harness import Window, addon

LEFT, RIGHT = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)
STRETCHED, UNTOUCHED = (1.6, 0.0, 0.3), (-1.0, 0.0, 0.3)


def mean(window: Window, where: tuple[int, int], radius: int = 5) -> np.ndarray:
    """The mean colour (r, g, b) there."""
    return np.mean(window.colours(where, radius), axis=0)


def stretch(window: Window) -> Iterator[None]:
    """The right half of the drawing becomes twice as wide."""
    obj = active()
    points = shape(obj).reshape(-1, 3)
    points[:, 0] = np.where(points[:, 0] > 0.0, 2.0 * points[:, 0], points[:, 0])
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    bpy.ops.ed.undo_push(message="Stretch")
    yield from window.wait(0.2)


def show(window: Window, quality: str) -> Iterator[None]:
    active().planar.show_quality = quality
    window.area.tag_redraw()
    yield from window.wait(0.3)


def sidebar(window: Window) -> Iterator[None]:
    """The Planar tab, scrolled so far that the totals are seen."""
    window.area.spaces.active.show_region_ui = True
    yield from window.wait(0.5)
    window.region("UI").active_panel_category = "Planar"
    window.region("UI").tag_redraw()
    yield from window.wait(0.3)
    region = window.region("UI")
    yield from window.move((region.x + region.width // 2, region.y + region.height // 2))
    for _ in range(10):
        yield from window.event("WHEELDOWNMOUSE", "PRESS")
    yield from window.wait(0.3)


def test_the_drawing_is_coloured_where_it_is_stretched(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    yield from stretch(window)
    places = [window.pixel(STRETCHED), window.pixel(UNTOUCHED)]
    plain = [mean(window, place) for place in places]
    assert np.allclose(plain[0], plain[1], atol=3.0)
    corner = window.region().x + window.region().width - 100, window.region().y + 40
    empty = window.colours(corner, 30)
    for quality in ("AREA", "ANGLE"):
        yield from show(window, quality)
        far, near = (mean(window, place) for place in places)
        assert np.abs(far - plain[0]).max() > 60.0, "twice as wide: the end of the scale"
        assert far[0] > far[1] + 50.0, "which is red"
        assert np.abs(near - plain[1]).max() < 60.0, "covered less"
        assert near[2] >= near[0] - 3.0, "with blue"
        assert window.colours(corner, 30) != empty, "the legend"
        window.picture(f"quality-{quality.lower()}")
    yield from show(window, "OFF")
    for place, before in zip(places, plain, strict=True):
        assert np.allclose(mean(window, place), before, atol=1.0)
    assert window.colours(corner, 30) == empty


def test_area_and_angle_tell_different_things(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    obj = active()
    points = shape(obj).reshape(-1, 3)
    corner = np.float32((-1.0, 0.0, 0.0))
    right = points[:, 0] > -1.0  # all of it would be a drawing that is larger as it is meant to be
    points[right] = corner + np.float32(1.5) * (points[right] - corner)  # larger, of the same form
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    place = window.pixel((1.1, 0.0, 0.4))
    yield from show(window, "ANGLE")
    angle = mean(window, place)
    yield from show(window, "AREA")
    area = mean(window, place)
    assert angle[2] >= angle[0] - 3.0, "no angle has changed"
    assert area[0] > area[2] + 50.0, "the area is 2.25 times as large"


def test_flipped_triangles_are_marked_in_either(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    obj = active()
    points = shape(obj).reshape(-1, 3)
    vertex = int(np.argmin(np.abs(points - (1.0, 0.0, 0.0)).sum(axis=1)))
    points[vertex] = (1.4, 0.0, 0.4)  # over the opposite corner of its cell
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    place = window.pixel((1.3, 0.0, 0.3))
    for quality in ("AREA", "ANGLE"):
        yield from show(window, quality)
        magenta = sum(r > 150 and g < 80 and b > 150 for r, g, b in window.colours(place, 8))
        assert magenta > 30, quality
    window.picture("quality-flipped")


def test_colours_and_totals_follow_a_drag(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT, RIGHT)
    yield from sidebar(window)
    yield from show(window, "AREA")
    panel = window.region("UI")
    middle, radius = (panel.x + panel.width // 2, panel.y + panel.height // 2), panel.width // 2
    yield from window.hover(window.pixel(RIGHT))
    yield from window.press()
    seen = []
    for x in (1.6, 2.2, 2.8):
        yield from window.move(window.pixel((x, 0.0, 0.0)), steps=3)
        yield from window.wait(0.5)
        assert window.busy == ["PLANAR_OT_drag_pins"]
        colour = mean(window, window.pixel((0.5 * (x - 1.5), 0.0, 0.2)))
        seen.append((tuple(colour), tuple(window.colours(middle, radius))))
    window.picture("quality-drag")
    yield from window.key("ESC")
    yield from window.release()
    yield from window.wait(0.3)
    colours = np.array([colour for colour, _ in seen])
    redness = colours[:, 0] - colours[:, 2]
    assert redness[0] + 10.0 < redness[1], redness
    assert redness[1] + 10.0 < redness[2] or colours[2][0] < colours[1][0], "on to dark red"
    assert len({panel for _, panel in seen}) == 3, "the totals are drawn anew"


def test_hidden_overlays_and_other_modes_hide_it(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    yield from stretch(window)
    place = window.pixel(STRETCHED)
    plain = mean(window, place)
    yield from show(window, "AREA")
    yield from window.use_tool("builtin.select_box")
    assert np.abs(mean(window, place) - plain).max() > 60.0, "any tool of Object Mode"
    window.area.spaces.active.overlay.show_overlays = False
    window.area.tag_redraw()
    yield from window.wait(0.3)
    assert mean(window, place)[1] > 80.0
    window.area.spaces.active.overlay.show_overlays = True
    active().hide_set(True)
    window.area.tag_redraw()
    yield from window.wait(0.3)
    red = mean(window, place)
    assert red[0] < red[1] + 10.0, "a hidden object is not coloured"


def test_the_scale_is_as_large_as_the_interface(window: Window) -> Iterator[None]:
    yield from ready(window, LEFT)
    yield from show(window, "AREA")
    view, region = bpy.context.preferences.view, window.region()
    place = region.x + region.width - 320, region.y + 30
    before = window.colours(place, 10)
    view.ui_scale = 2.0
    try:
        yield from window.wait(0.5)
        window.picture("quality-large")
        assert window.colours(place, 10) != before
    finally:
        view.ui_scale = 1.0
    yield from window.wait(0.3)


def test_nothing_is_made_anew_while_another_object_moves(window: Window) -> Iterator[None]:
    other = sheet("Other", columns=2, rows=2, at=(0.0, 1.0, 1.5))
    yield from ready(window, LEFT, RIGHT)
    obj = active()
    obj.planar.show_mesh = True
    obj.planar.pins[0].kind = "PATCH"
    yield from stretch(window)
    yield from show(window, "AREA")
    yield from window.wait(0.3)
    made, originals = [], {}
    makers = {"quality": "_make", "mesh_edges": "_make"}
    for name in ("quality", "mesh_edges", "onion_skin", "marks"):
        module, maker = addon(f"ui.draw.{name}"), makers.get(name, "batch_for_shader")
        originals[module, maker] = make = getattr(module, maker)
        counted = lambda *of, name=name, make=make, **more: made.append(name) or make(*of, **more)  # noqa: E731
        setattr(module, maker, counted)
    try:
        for step in range(5):
            other.location.x = 0.1 * step
            window.area.tag_redraw()
            yield from window.wait(0.1)
        assert made == []
        yield from stretch(window)
        assert {*made} >= {"quality", "mesh_edges"}, "another shape is drawn anew"
        count = len(made)
        activate(other)
        window.area.tag_redraw()
        yield from window.wait(0.2)
        activate(obj)
        window.area.tag_redraw()
        yield from window.wait(0.2)
        assert len(made) == count, "what another object shows is kept"
    finally:
        for (module, maker), original in originals.items():
            setattr(module, maker, original)
