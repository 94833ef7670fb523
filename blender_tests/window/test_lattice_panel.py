# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of lattices: fitted by its button, told what they deform and what their points cannot reach."""

from collections.abc import Iterator

import bpy
import numpy as np
from cutouts import activate, active, sheet
from harness import Window, addon
from poses import shown


def drawings() -> list[bpy.types.Object]:
    """Two sheets one behind the other, selected, and a third one beside them."""
    objects = [sheet("Back"), sheet("Front"), sheet("Beside")]
    objects[1].location.y = -0.3
    objects[2].location = (0.3, -0.6, 0.2)
    activate(objects[0])
    objects[1].select_set(True)
    bpy.ops.ed.undo_push(message="Test Scene")
    return objects


def test_a_lattice_is_fitted_given_a_third_object_and_applied_by_buttons(window: Window) -> Iterator[None]:
    names = [obj.name for obj in drawings()]
    yield from window.look("FRONT")
    yield from window.use_tool()
    yield from window.sidebar()
    yield from window.push("planar.fit_lattice")
    assert active().type == "LATTICE", window.reports()
    lattice = active().name
    yield from window.wait(0.3)
    window.picture("fitted")
    bpy.data.objects[names[2]].select_set(True)
    yield from window.push("planar.add_to_lattice")
    users = [name for name in names if bpy.data.objects[name].modifiers]
    assert users == names, window.reports()
    for spot in ((-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)):
        yield from window.click(window.pixel(spot), ctrl=True)
    yield from window.drag(window.pixel((1.5, -0.6, 0.0)), window.pixel((1.6, -0.6, 0.7)))
    far = addon("ui.panels.pins_panel").unreached(addon("scene.view.snapshot").of_active(bpy.context))
    assert not far, "what is a hair's breadth away has arrived"
    yield from window.push("planar.apply_lattice")
    for name in names:
        obj = bpy.data.objects[name]
        assert not obj.modifiers, window.reports()
        assert obj.data.shape_keys.key_blocks[-1].name == lattice
    yield from window.undo()
    assert all(bpy.data.objects[name].modifiers for name in names)


def fit(window: Window) -> Iterator[None]:
    with window.context():
        bpy.ops.planar.fit_lattice("INVOKE_DEFAULT")
    yield from window.wait(0.3)


def test_layers_lead_to_their_lattice_and_are_not_given_another_one_unasked(window: Window) -> Iterator[None]:
    names = [obj.name for obj in drawings()]
    yield from window.look("FRONT")
    yield from window.use_tool()
    yield from window.sidebar()
    yield from window.push("planar.fit_lattice")
    lattice = active().name
    activate(bpy.data.objects[names[1]])
    yield from window.wait(0.3)
    window.picture("layer_of_a_lattice")
    assert f"hangs in '{lattice}'" in addon("ui.tool.hint")._text(bpy.context)
    yield from window.hover(window.pixel((-2.5, 0.0, 0.0)))
    yield from fit(window)
    window.picture("another_lattice")
    yield from window.key("ESC")
    assert active().name == names[1]
    assert [modifier.object.name for modifier in active().modifiers] == [lattice]
    yield from fit(window)
    yield from window.key("UP_ARROW")  # the last entry: another one is added
    yield from window.key("UP_ARROW")
    yield from window.key("RET")
    yield from window.wait(0.3)
    assert active().type == "LATTICE", window.reports()
    assert active().name != lattice
    added = [modifier.object.name for modifier in bpy.data.objects[names[1]].modifiers]
    assert added == [active().name], "in its place"
    yield from window.undo()
    activate(bpy.data.objects[names[1]])
    yield from window.wait(0.3)
    yield from window.push("planar.select_lattice")
    assert active().name == lattice, window.reports()


def test_applied_transforms_and_moved_origins_of_a_lattice_change_nothing(window: Window) -> Iterator[None]:
    objects = drawings()
    yield from window.look("FRONT")
    with window.context():
        bpy.ops.planar.fit_lattice()
    bpy.ops.planar.add_pin(location=(-1.0, 0.0, 0.0))
    bpy.ops.planar.add_pin(location=(1.0, 0.0, 0.0))
    bpy.ops.planar.drag_pins(offset=(0.3, 0.6))
    bpy.ops.ed.undo_push(message="Dragged")
    name, back = active().name, objects[0].name
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    yield from window.key("G")
    yield from window.type("0.5")
    yield from window.key("RET")
    yield from window.wait(0.2)
    before, scale = shown(bpy.data.objects[back]), tuple(active().scale)
    yield from window.key("A", ctrl=True)
    yield from window.wait(0.2)
    yield from window.key("A")  # All Transforms
    yield from window.wait(0.3)
    window.picture("transform_kept")
    yield from window.key("ESC")
    assert np.allclose(shown(bpy.data.objects[back]), before, atol=1e-5)
    assert np.allclose(active().scale, scale)
    bpy.context.scene.tool_settings.use_transform_data_origin = True
    yield from window.hover(window.pixel((0.0, 0.0, 0.0)))
    yield from window.key("G")
    yield from window.type("1")
    yield from window.key("RET")
    yield from window.wait(0.3)
    yield from window.key("ESC")
    assert np.allclose(shown(bpy.data.objects[back]), before, atol=1e-5)
    yield from window.undo()
    yield from window.undo()
    yield from window.redo()
    yield from window.wait(0.2)
    assert active().name == name
    assert np.allclose(shown(bpy.data.objects[back]), before, atol=1e-5)


def test_pins_out_of_reach_and_modifiers_below_are_told(window: Window) -> Iterator[None]:
    objects = drawings()
    yield from window.look("FRONT")
    yield from window.use_tool()
    with window.context():
        bpy.ops.planar.fit_lattice(resolution=(2, 2), basis="KEY_LINEAR", free=0)
    objects[1].modifiers.new("Bend", "SIMPLE_DEFORM").angle = 0.1
    for spot in ((-1.0, 0.0), (0.0, 0.0), (1.0, 0.0)):
        bpy.ops.planar.add_pin(location=(spot[0], -0.3, spot[1]))
    assert len(active().planar.pins) == 3, window.reports()
    bpy.ops.planar.drag_pins(pin=1, offset=(0.0, 0.6))
    bpy.ops.ed.undo_push(message="Dragged")
    yield from window.wait(0.3)
    yield from window.sidebar()
    window.picture("out_of_reach")
    panel, snapshot = addon("ui.panels.pins_panel"), addon("scene.view.snapshot")
    far = panel.unreached(snapshot.of_active(bpy.context))
    assert 0.05 < far.get(1, 0.0) < 0.6, far
    assert all(np.isfinite(gap) for gap in far.values())
    shifting = addon("scene.objects.modifiers").shifting
    front = active().planar.pins[0].object
    assert front.name == "Front"
    assert shifting(front, front.modifiers[0]) == ["Bend"]
