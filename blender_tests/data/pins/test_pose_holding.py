# SPDX-License-Identifier: GPL-3.0-or-later
"""A pose that its pins have not made: it is told what a drag does to it, and how it stays."""

import bpy
import numpy as np
import pytest
from support import activate, add_end_pins, add_pins, bar, coordinates, measured, pose

MIDDLE = [6, 19, 32, 45, 58]  # a column of the bar


def told(obj):
    from planar_deform.scene.pins.pose_holding import unheld

    return unheld(obj, lambda: measured(obj))


def bent(plane="XZ"):
    """A bar that its pins have bent."""
    obj = bar(plane=plane)
    add_end_pins(obj)
    pose(obj, offset=(-0.4, 0.9))
    return obj


def pins_anew(obj, *rows):
    activate(obj)
    bpy.ops.planar.select_pins(action="ALL")
    assert bpy.ops.planar.remove_pins() == {"FINISHED"}
    add_pins(obj, *rows)


def test_nothing_is_told_of_what_the_pins_have_made():
    obj = bar()
    add_end_pins(obj)
    assert told(obj) is None, "the drawing is at rest"
    pose(obj, offset=(-0.4, 0.9))
    assert told(obj) is None
    add_pins(obj, MIDDLE)
    assert told(obj) is None, "the others hold their part"


def test_nothing_is_told_of_a_keyed_pose_after_a_reset_at_another_frame():
    obj = bent()
    bpy.ops.planar.key_pose()
    bpy.context.scene.frame_set(25)
    bpy.ops.planar.reset_to_rest()
    bpy.ops.planar.key_pose()
    bpy.context.scene.frame_set(1)
    assert told(obj) is None
    pins_anew(obj, [0])
    assert told(obj) is not None


@pytest.mark.parametrize("plane", ["XY", "XZ"])
def test_a_drag_with_other_pins_tells_that_the_pose_goes(plane, capfd):
    obj = bent(plane)
    before = coordinates(obj.data.vertices)
    pins_anew(obj, [0])
    assert np.array_equal(coordinates(obj.data.vertices), before)
    assert "Set as Rest" in told(obj)
    assert bpy.ops.planar.drag_pins(offset=(0.01, 0.0)) == {"FINISHED"}
    assert "These pins have not made the pose" in capfd.readouterr().out
    assert told(obj) is None
    assert measured(obj).angle == pytest.approx(2.0, abs=1e-4), "one pin holds nothing of a bend"


def test_what_is_told_keeps_the_pose():
    obj = bent()
    before = coordinates(obj.data.vertices)
    pins_anew(obj, [0])
    assert bpy.ops.planar.set_rest_to_current() == {"FINISHED"}
    assert told(obj) is None
    assert bpy.ops.planar.drag_pins(offset=(0.01, 0.0)) == {"FINISHED"}
    after = coordinates(obj.data.vertices)
    assert np.abs(after - before).max() < 0.02, "all of the bend goes along"
    obj = bent()
    before = coordinates(obj.data.vertices)
    pins_anew(obj, *(list(range(column, 65, 13)) for column in range(0, 13, 2)))
    assert bpy.ops.planar.drag_pins(offset=(0.01, 0.0)) == {"FINISHED"}
    assert np.abs(coordinates(obj.data.vertices) - before).max() < 0.05, "where pins are, it stays"


def test_akvf_forgets_the_rest_shape_and_keeps_what_is_there():
    obj = bent()
    obj.planar.method = "AKVF"
    pins_anew(obj, [0])
    assert told(obj) is None
