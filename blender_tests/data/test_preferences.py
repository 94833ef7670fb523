# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: what they hold, and what holds without them."""

import bpy
import pytest


@pytest.fixture
def enabled():
    """The add-on as Blender's preferences have it once it is enabled."""
    add_on = bpy.context.preferences.addons.new()
    add_on.module = "planar_deform"
    yield add_on.preferences
    bpy.context.preferences.addons.remove(add_on)


def test_pins_look_as_ever_until_something_else_is_chosen(enabled):
    from planar_deform import preferences

    found = preferences.looks()
    assert found.size == preferences.DEFAULT.size
    assert found.pin == pytest.approx(preferences.DEFAULT.pin)
    assert found.selected == pytest.approx(preferences.DEFAULT.selected)
    enabled.pin_size = 9.0
    enabled.selected_colour = (0.0, 1.0, 0.0, 1.0)
    assert preferences.looks().size == 9.0
    assert preferences.looks().selected == (0.0, 1.0, 0.0, 1.0)


def test_a_pin_is_never_larger_than_what_the_mouse_reaches(enabled):
    from planar_deform import preferences
    from planar_deform.scene.view import mouse

    enabled.pin_size = 100.0
    assert preferences.looks().size == mouse.REACH


def test_without_being_enabled_the_defaults_hold():
    from planar_deform import preferences

    assert preferences.looks() == preferences.DEFAULT


def test_new_poses_are_eased_as_blender_s_preferences_say(enabled):
    from planar_deform.model.timing.ease import EASES, PREFERENCES

    assert enabled.ease == PREFERENCES
    assert [item.identifier for item in enabled.bl_rna.properties["ease"].enum_items] == [
        name for name, _, _ in EASES
    ]
