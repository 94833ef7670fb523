# SPDX-License-Identifier: GPL-3.0-or-later
"""What keys turn pins about: what Blender's Pivot Point says."""

import bpy
import numpy as np
import pytest
from figures import ARM, BODY, SHOULDER, drag, pin_at, pinned
from mathutils import Vector

from planar_deform.scene.view import pivot


@pytest.fixture
def figure():
    """A body and an arm that hang together by a shoulder, and a pin at the hand."""
    obj = pinned(BODY, ARM)
    pin_at(obj, (4.2, 3.2), "Hand")
    return obj


def said(kind):
    bpy.context.scene.tool_settings.transform_pivot_point = kind
    return pivot.chosen(bpy.context)


def test_it_is_the_centre_of_the_pins_unless_blender_says_otherwise(figure):
    assert said("MEDIAN_POINT") is None
    assert said("BOUNDING_BOX_CENTER") is None
    assert said("INDIVIDUAL_ORIGINS") is None


def test_it_is_the_cursor(figure):
    bpy.context.scene.cursor.location = (0.5, -2.0, 1.0)
    np.testing.assert_allclose(said("CURSOR"), (0.5, -2.0, 1.0))


def test_it_is_the_active_joint_where_it_is_shown(figure):
    joint = next(i for i, pin in enumerate(figure.planar.pins) if pin.kind == "HINGE")
    figure.planar.active_pin = joint
    before = np.array(said("ACTIVE_ELEMENT"))
    local = figure.matrix_world.inverted() @ Vector(before)
    np.testing.assert_allclose(local[:2], SHOULDER, atol=0.1)
    drag(figure, "Chest", (0.3, 0.0))
    figure.planar.active_pin = joint
    after = np.array(said("ACTIVE_ELEMENT"))
    assert np.linalg.norm(after - before) == pytest.approx(0.3, rel=0.2)


def test_it_is_the_centre_where_the_active_pin_has_no_place(figure):
    figure.planar.active_pin = len(figure.planar.pins)
    assert said("ACTIVE_ELEMENT") is None
