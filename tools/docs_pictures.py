# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the add-on in use, for docs/; `make docs` runs it by the window tests' harness."""

import math
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import harness  # type: ignore[import-not-found]
import test_first_shot as first_shot  # type: ignore[import-not-found]  # tests of the window run in the harness
from harness import addon
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
REST, WAVE = 1, 25  # frames of the demo's poses

harness.set_views = lambda: None  # Blender as it is, however long a redraw takes


def shot(window: Any, name: str, area: Any = None) -> Path:
    """The area (by default the whole window) as a PNG."""
    raw: Path = window.picture(name)
    if area is not None:
        crop = f"{area.width}x{area.height}+{area.x}+{window.window.height - area.y - area.height}"
        subprocess.run(["convert", raw, "-crop", crop, "+repage", raw], check=True)
    return raw


def save(name: str, *shots: Path, crop: str = "100%x100%+0+0") -> None:
    """Shots side by side as a JPEG in docs/images, each cut to the same rectangle."""
    layout = ["-crop", crop, "+repage", "-bordercolor", "white", "-border", "2x0" if shots[1:] else "0"]
    layout += ["+append", "-quality", "88"]
    subprocess.run(["convert", *map(str, shots), *layout, str(IMAGES / f"{name}.jpg")], check=True)


def pin_place(window: Any, name: str) -> tuple[int, int]:
    """Where a pin of the active object is on the screen."""
    obj = bpy.context.object
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    index = obj.vertex_groups[name].index
    points = [shown[v.index].co for v in obj.data.vertices if any(g.group == index for g in v.groups)]
    place: tuple[int, int] = window.pixel(obj.matrix_world @ (sum(points[1:], points[0]) / len(points)))
    return place


def opened(window: Any, name: str, frame: int, at: tuple[float, float], distance: float) -> Iterator[None]:
    """The demo with a character active in the Pose tool, seen from the front about a place beside it."""
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "out" / "demo.blend"), load_ui=False)
    yield from window.wait(0.5)
    bpy.context.preferences.view.show_tooltips = False
    bpy.context.scene.frame_set(frame)
    obj = bpy.data.objects[name]
    bpy.context.view_layer.objects.active = obj
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    yield from window.look("FRONT", distance)
    space = window.area.spaces.active
    space.region_3d.view_location = (obj.location.x + at[0], 0, at[1])
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "TEXTURE"
    space.overlay.show_outline_selected = False
    space.overlay.show_object_origins = False
    space.overlay.show_cursor = False
    space.overlay.show_extras = False
    space.show_region_ui = True
    yield from window.use_tool()
    yield from window.wait(0.5)  # the sidebar knows its tabs once it has been drawn
    window.region("UI").active_panel_category = "Planar"
    window.region("UI").tag_redraw()
    yield from window.wait(0.5)


def large_view(window: Any) -> Iterator[None]:
    with window.context():
        bpy.ops.screen.screen_full_area()
    yield from window.wait(0.5)


def timeline_below(window: Any) -> Iterator[None]:
    """Make the timeline high enough to show keys, and show all of them."""
    timeline = next(area for area in window.window.screen.areas if area.type == "DOPESHEET_EDITOR")
    middle, edge = timeline.x + timeline.width // 2, timeline.y + timeline.height
    yield from window.hover((middle, edge))
    yield from window.press()
    yield from window.move((middle, edge + 40), steps=4)
    yield from window.release()
    yield from window.wait(0.3)
    region = next(region for region in timeline.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window.window, area=timeline, region=region):
        bpy.ops.action.view_all()
    yield from window.wait(0.5)


def graph_below(window: Any) -> Iterator[None]:
    """A Graph Editor in place of the timeline, high enough for the curve of the poses."""
    area = next(area for area in window.window.screen.areas if area.type == "DOPESHEET_EDITOR")
    area.ui_type = "FCURVES"
    yield from window.wait(0.3)
    middle, edge = area.x + area.width // 2, area.y + area.height
    yield from window.hover((middle, edge))
    yield from window.press()
    yield from window.move((middle, edge + 200), steps=8)
    yield from window.release()
    yield from window.wait(0.3)
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window.window, area=area, region=region):
        bpy.ops.graph.view_all()
    yield from window.wait(0.5)


def pulled(window: Any, name: str, by: tuple[int, int]) -> Iterator[None]:
    """Press a pin, move it by pixels, and wait until the drawing has followed; the button stays down."""
    x, y = pin_place(window, name)
    yield from window.hover((x, y))
    yield from window.press()
    yield from window.move((x + by[0], y + by[1]), steps=16)
    yield from window.settled()
    yield from window.wait(0.3)


def switch_off(*names: str) -> None:
    for pin in bpy.context.object.planar.pins:
        pin.enabled = pin.group not in names


def released(window: Any) -> Iterator[None]:
    yield from window.release()
    yield from window.settled()


def test_where_to_install(window: Any) -> Iterator[None]:
    """The menu of Get Extensions; the preferences take the place of the 3D view."""
    yield from large_view(window)
    area = window.area
    area.type = "PREFERENCES"
    bpy.context.preferences.active_section = "EXTENSIONS"
    yield from window.wait(1.0)
    region = next(region for region in area.regions if region.type == "WINDOW")
    right, top = region.x + region.width, region.y + region.height
    yield from window.click((right - 19, top - 19))  # the arrow
    yield from window.wait(0.5)
    yield from window.move((right - 60, top - 142), steps=4)
    yield from window.wait(0.5)
    save("install", shot(window, "install"), crop="1280x330+0+0")
    yield from window.key("ESC")
    area.type = "VIEW_3D"


def test_the_first_shot(window: Any) -> Iterator[None]:
    """The shot that is a test of the window, too."""
    yield from first_shot.on_stage(window)
    yield from first_shot.through_the_camera(window)
    yield from first_shot.take_the_tool(window)
    yield from first_shot.pins_put(window)
    yield from window.wait(0.3)
    save("first_shot_pins", shot(window, "first_shot_pins"))
    yield from first_shot.poses_keyed(window)
    shots = []
    for frame in (1, 60, 120, 180, first_shot.LAST):
        bpy.context.scene.frame_set(frame)
        yield from window.wait(0.3)
        shots.append(shot(window, f"first_shot_{frame}"))
    save("first_shot_poses", *shots, crop="300x330+400+190")
    yield from window.sidebar()
    yield from window.push("planar.generate_inbetweens")
    yield from window.wait(0.5)
    bpy.context.object.planar.show_onion = True
    bpy.context.scene.frame_set(90)
    yield from window.wait(0.5)
    save("first_shot_generated", shot(window, "first_shot_generated"))


def test_cutout_settings(window: Any) -> Iterator[None]:
    """A drawing of the demo that has just been dropped, and its settings at the lower left."""
    yield from large_view(window)
    yield from window.look("FRONT", 3.2)
    space = window.area.spaces.active
    space.shading.light = "FLAT"
    space.overlay.show_outline_selected = space.overlay.show_extras = space.overlay.show_cursor = False
    with window.context():
        path = ROOT / "out" / "drawings" / "Lantern Fox Body.png"
        bpy.ops.planar.cutout_from_image("INVOKE_DEFAULT", True, filepath=str(path), factor=480.0)
    yield from window.wait(1.0)
    yield from window.hover((window.area.x + 850, window.area.y + 640))
    yield from window.key("F9")
    yield from window.wait(0.8)
    save("cutout_settings", shot(window, "cutout_settings", window.area), crop="800x600+400+70")
    yield from window.key("ESC")


def test_the_pose_tool(window: Any) -> Iterator[None]:
    yield from opened(window, "Lantern Fox", WAVE, (0.35, 2.0), 6.6)
    yield from large_view(window)
    obj = bpy.context.object
    yield from window.click(pin_place(window, "Near Hand"))
    yield from window.hover(pin_place(window, "Near Elbow"))
    save("pose_tool", shot(window, "pose_tool", window.area))
    obj.planar.show_mesh = True
    yield from pulled(window, "Near Hand", (-130, -60))
    save("pose_tool_drag", shot(window, "pose_tool_drag", window.area))
    yield from window.key("ESC")
    obj.planar.show_mesh = False


def oval(name: str, at: tuple[float, float, float], size: tuple[float, float], colour: str) -> Any:
    """A drawing of one colour, round at its ends, in the XZ plane about a place."""
    columns, rows = 8, max(8, round(8 * size[1] / size[0]))
    places = [(2 * i / columns - 1, 2 * j / rows - 1) for j in range(rows + 1) for i in range(columns + 1)]
    round_x = ((x * math.sqrt(1 - 0.5 * z**4), z * math.sqrt(1 - 0.5 * x * x)) for x, z in places)
    corners = [j * (columns + 1) + i for j in range(rows) for i in range(columns)]
    mesh = bpy.data.meshes.new(name)
    faces = [(k, k + 1, k + columns + 2, k + columns + 1) for k in corners]
    mesh.from_pydata([(0.5 * size[0] * x, 0.0, 0.5 * size[1] * z) for x, z in round_x], [], faces)
    obj = bpy.data.objects.new(name, mesh)
    obj.location = at
    obj.color = [*(int(colour[k : k + 2], 16) / 255 for k in (0, 2, 4)), 1.0]
    bpy.context.collection.objects.link(obj)
    return obj


def test_several(window: Any) -> Iterator[None]:
    """A doll of six objects, all selected, whose head and hands are dragged as one."""
    pink, blue, grey = "d98c7a", "4a6fa5", "39424e"
    doll = [
        oval("Leg.L", (0.28, 0.02, -1.25), (0.34, 1.5), grey),
        oval("Leg.R", (-0.28, 0.02, -1.25), (0.34, 1.5), grey),
        oval("Arm.L", (0.62, 0.01, 0.0), (0.28, 1.5), pink),
        oval("Arm.R", (-0.62, 0.01, 0.0), (0.28, 1.5), pink),
        oval("Head", (0.0, 0.01, 1.15), (0.8, 0.9), pink),
        oval("Body", (0.0, 0.0, 0.0), (1.1, 1.7), blue),
    ]
    for obj in doll:
        for other in doll:
            other.select_set(other == obj)
        bpy.context.view_layer.objects.active = obj
        bpy.context.view_layer.update()
        x, _, z = obj.location
        half = 0.4 * obj.dimensions.z * (-1.0 if obj.name in {"Head", "Body"} else 1.0)
        for place in (half, -half):
            bpy.ops.planar.add_pin(location=(x, obj.location.y, z + place))
        obj.planar.pins[0].select, obj.planar.pins[1].select = False, obj.name[:3] in {"Arm", "Hea"}
    for obj in doll:
        obj.select_set(True)
        obj.planar.pins[1].select = obj.name[:3] in {"Arm", "Hea"}
    yield from window.look("FRONT", 7.0)
    space = window.area.spaces.active
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "OBJECT"
    space.overlay.show_outline_selected = space.overlay.show_object_origins = False
    space.overlay.show_cursor = space.overlay.show_extras = False
    space.show_region_ui = True
    yield from window.use_tool()
    yield from window.wait(0.5)
    window.region("UI").active_panel_category = "Planar"
    window.region("UI").tag_redraw()
    yield from large_view(window)
    hand = bpy.data.objects["Arm.L"]
    x, y = window.pixel((hand.location.x, 0.0, hand.location.z - 0.6))
    yield from window.hover((x, y))
    yield from window.press()
    yield from window.move((x + 60, y + 40), steps=8)
    yield from window.settled()
    yield from window.wait(0.5)
    save("several", shot(window, "several", window.area))
    yield from window.key("ESC")


def test_pins(window: Any) -> Iterator[None]:
    """One that is off, and a weak one that does not reach its target."""
    yield from opened(window, "Lantern Fox", WAVE, (0.35, 2.0), 6.6)
    yield from large_view(window)
    switch_off("Tail Middle")
    hand = bpy.context.object.planar.pins["Near Hand"]
    hand.kind, hand.weight, bpy.context.object.planar.pin_weight = "POINT", 0.02, 0.1
    yield from pulled(window, "Near Hand", (-200, 110))
    yield from released(window)
    save("pins", shot(window, "pins", window.area))


def test_poses(window: Any) -> Iterator[None]:
    yield from opened(window, "Lantern Fox", WAVE, (0.35, 2.0), 7.6)
    pins = addon("ui.panels.pins_panel").PLANAR_PT_pins
    bpy.utils.unregister_class(pins)  # room for the panels below
    try:
        bpy.ops.planar.jump_to_pose(pose=2)
        yield from timeline_below(window)
        save("poses", shot(window, "poses"))
    finally:
        bpy.utils.register_class(pins)


def test_inbetweens(window: Any) -> Iterator[None]:
    """The curve below the drawing."""
    pins = addon("ui.panels.pins_panel").PLANAR_PT_pins
    yield from opened(window, "Lantern Fox", WAVE + 13, (0.35, 2.0), 7.6)
    bpy.utils.unregister_class(pins)
    try:
        bpy.context.object.planar.show_onion = True
        yield from graph_below(window)
        save("inbetweens", shot(window, "inbetweens"))
    finally:
        bpy.utils.register_class(pins)


def test_breakdown(window: Any) -> Iterator[None]:
    yield from opened(window, "River Dragon", WAVE + 36, (0.3, 2.0), 9.6)
    yield from large_view(window)
    bpy.context.object.planar.show_onion = True
    yield from window.hover((400, 300))
    with window.context():
        bpy.ops.planar.breakdown("INVOKE_DEFAULT")
    yield from window.move((480, 300), steps=4)
    yield from window.wait(0.5)
    save("breakdown", shot(window, "breakdown", window.area))
    yield from window.key("ESC")


def test_quality(window: Any) -> Iterator[None]:
    pins = addon("ui.panels.pins_panel").PLANAR_PT_pins
    yield from opened(window, "River Dragon", REST, (0.75, 1.9), 8.2)
    yield from large_view(window)
    bpy.utils.unregister_class(pins)  # room for the panels below
    try:
        switch_off("Neck", "Throat")
        bpy.context.object.planar.show_quality = "ANGLE"
        yield from pulled(window, "Head", (-90, 80))
        save("quality", shot(window, "quality", window.area))
        yield from window.key("ESC")
    finally:
        bpy.utils.register_class(pins)


def test_stiffness(window: Any) -> Iterator[None]:
    yield from opened(window, "Lantern Fox", REST, (-0.45, 2.1), 4.2)
    yield from large_view(window)
    obj = bpy.context.object
    switch_off("Near Elbow")
    next(pin for pin in obj.planar.pins if pin.group == "Near Hand").kind = "POINT"
    shots: list[Path] = []
    for name in ("even", "painted"):
        if name == "painted":
            bpy.ops.planar.reset_to_rest()
            bpy.ops.planar.paint_stiffness()
            paint_arm(obj)
            yield from window.wait(1.0)
            shots.insert(0, shot(window, "stiffness_paint", window.area))
            bpy.ops.object.mode_set(mode="OBJECT")
            yield from window.use_tool()
        yield from pulled(window, "Near Hand", (150, 110))
        yield from released(window)
        shots.append(shot(window, f"stiffness_{name}", window.area))
    save("stiffness", *shots, crop="420x500+360+110")


def paint_arm(obj: Any) -> None:
    """Stiff arm, neutral elbow."""
    group = obj.vertex_groups[obj.planar.stiffness_group]
    hand, elbow = (obj.vertex_groups[name].index for name in ("Near Hand", "Near Elbow"))
    depth = next(v.co.y for v in obj.data.vertices if any(g.group == hand for g in v.groups))
    joint = next(v.co for v in obj.data.vertices if any(g.group == elbow for g in v.groups))
    for vertex in obj.data.vertices:
        if abs(vertex.co.y - depth) < 1e-4 and (vertex.co - joint).length > 0.2:
            group.add([vertex.index], 0.8, "REPLACE")


def mark_place(window: Any, name: str) -> tuple[int, int]:
    """Where the Pose tool shows a pin of the active lattice on the screen."""
    mark = addon("scene.view.snapshot").of_active(bpy.context).pin(bpy.context.object.planar.pins.find(name))
    place: tuple[int, int] = window.pixel(mark.place)
    return place


def test_lattice(window: Any) -> Iterator[None]:
    """Pins on four objects and on points of their lattice; one is dragged beside the lattice's panel."""
    pins = addon("ui.panels.pins_panel").PLANAR_PT_pins
    yield from opened(window, "Lattice", WAVE, (0.9, 2.6), 10.0)
    yield from large_view(window)
    window.area.spaces.active.overlay.show_extras = True  # lattices are among them
    for obj in bpy.context.view_layer.objects:
        obj.hide_set(not obj.name.startswith("Paper") and obj.name != "Lattice")
    with window.context():
        bpy.ops.planar.settle_pose("EXEC_DEFAULT")
        for point in (13 * 14, 14 * 14 - 1):
            bpy.ops.planar.add_pin(lattice_point=point)
        bpy.ops.planar.generate_inbetweens("EXEC_DEFAULT")
    yield from window.click(mark_place(window, "Hand"))
    yield from window.hover(mark_place(window, "Head"))
    window.area.tag_redraw()  # the sidebar, too
    yield from window.wait(0.3)
    save("lattice_tool", shot(window, "lattice_tool", window.area))
    bpy.utils.unregister_class(pins)  # room for the lattice's panel
    try:
        with window.context():
            bpy.ops.planar.clear_poses()
            bpy.ops.planar.reset_to_rest()
        yield from window.wait(0.3)
        x, y = mark_place(window, "Lantern")
        yield from window.hover((x, y))
        yield from window.press()
        yield from window.move((x + 60, y + 70), steps=16)
        yield from window.settled()
        yield from window.wait(0.3)
        save("lattice_panel", shot(window, "lattice_panel", window.area))
        yield from window.key("ESC")
    finally:
        bpy.utils.register_class(pins)


def test_follow(window: Any) -> Iterator[None]:
    """Controls at some pins of the fox, of which the lantern's has been moved and the tail's raised."""
    panel = addon("ui.panels.follow_panel").PLANAR_PT_follow
    bpy.utils.unregister_class(panel)
    panel.bl_options = set()  # open from the first time that it is drawn
    bpy.utils.register_class(panel)
    try:
        yield from opened(window, "Lantern Fox", WAVE, (0.35, 2.0), 6.6)
        yield from large_view(window)
        window.area.spaces.active.overlay.show_extras = True  # Empties are among them
        obj = bpy.context.object
        for other in bpy.context.view_layer.objects:
            other.hide_set(other != obj)
        for pin in obj.planar.pins:
            pin.select = pin.name in {"Near Hand", "Lantern", "Head", "Tail Tip"}
        obj.planar.active_pin = obj.planar.pins.find("Lantern")
        with window.context():
            bpy.ops.planar.add_controls()
        for name, by in (("Lantern", (0.75, 0.3)), ("Tail Tip", (0.0, 0.4))):
            obj.planar.pins[name].follow.matrix_world.translation += Vector((by[0], 0.0, by[1]))
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
        yield from window.hover((700, 300))
        yield from window.wait(1.0)
        save("follow", shot(window, "follow", window.area))
    finally:
        bpy.utils.unregister_class(panel)
        panel.bl_options = {"DEFAULT_CLOSED"}
        bpy.utils.register_class(panel)


def test_record(window: Any) -> Iterator[None]:
    pins = addon("ui.panels.pins_panel").PLANAR_PT_pins
    yield from opened(window, "River Dragon", REST, (1.0, 1.6), 9.6)
    bpy.utils.unregister_class(pins)
    scene = bpy.context.scene
    scene.render.fps = 4  # a hand has time for each frame even where drawing is slow
    try:
        switch_off("Neck", "Throat")
        bpy.ops.planar.clear_poses()
        bpy.ops.planar.reset_to_rest()
        with window.context():
            bpy.ops.planar.record_pins("INVOKE_DEFAULT")
        yield from window.wait(0.3)
        x, y = pin_place(window, "Head")
        yield from window.hover((x, y))
        yield from window.press()
        shown = False
        while scene.frame_current < 40:
            angle = 0.16 * (scene.frame_current - 1)
            yield from window.move((x - round(50 * math.sin(angle)), y + round(50 - 50 * math.cos(angle))))
            if scene.frame_current > 16 and not shown:
                shown = True
                save("record", shot(window, "record"))
        yield from window.release()
        while window.busy:
            yield
        scene.frame_set(17)
        yield from timeline_below(window)
        options = window.region("HUD")
        yield from window.click((options.x + 14, options.y + options.height // 2))
        yield from window.wait(0.5)
        save("recorded", shot(window, "recorded"))
    finally:
        bpy.utils.register_class(pins)
