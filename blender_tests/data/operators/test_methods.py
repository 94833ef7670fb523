# SPDX-License-Identifier: GPL-3.0-or-later
"""What is the same with each method of posing, and what ARAP alone does."""

import base64
import math

import bpy
import numpy as np
import pytest
from support import PLANES, activate, add_end_pins, add_pins, bar, coordinates, evaluated, measured

import planar_native

METHODS = ("HOLD", "AKVF", "ARAP")


def bar_by(method, **shape):
    obj = bar(**shape)
    add_end_pins(obj)
    obj.planar.method = method
    return obj


def rest_of(obj):
    return coordinates(obj.data.vertices).astype(float)


def path(samples):
    return base64.b64encode(np.asarray(samples, "<f4").tobytes()).decode("ascii")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("plane", PLANES)
def test_all_pins_turned_turn_the_drawing_as_it_is(method, plane):
    obj = bar_by(method, plane=plane)
    bpy.ops.planar.select_pins(action="ALL")
    rest = rest_of(obj)
    assert bpy.ops.planar.rotate_pins(angle=math.radians(140)) == {"FINISHED"}
    posed = rest_of(obj)
    sides = np.array([edge.vertices[:] for edge in obj.data.edges])
    lengths = [np.linalg.norm(p[sides[:, 0]] - p[sides[:, 1]], axis=1) for p in (rest, posed)]
    assert lengths[1] == pytest.approx(lengths[0], abs=1e-5)
    assert np.linalg.norm(posed - rest, axis=1).max() > 1.0
    assert measured(obj).flipped == 0


def test_arap_is_its_two_steps():
    obj = bar_by("ARAP")
    rest = rest_of(obj)[:, :2]
    assert bpy.ops.planar.drag_pins(offset=(-0.6, 0.5)) == {"FINISHED"}
    obj.data.calc_loop_triangles()
    triangles = np.array([triangle.vertices[:] for triangle in obj.data.loop_triangles])
    middles = np.array([26, 38])  # of either end, where the pins are
    targets = rest[middles] + [[0.0, 0.0], [-0.6, 0.5]]
    _, expected = planar_native.arap_two_step(rest, triangles, middles, targets)
    assert rest_of(obj)[:, :2] == pytest.approx(expected, abs=1e-5)


def test_arap_depends_on_the_pins_and_not_on_their_way():
    by_way, at_once = bar_by("ARAP"), bar_by("ARAP")
    ways = [(0.8 * t, math.sin(5 * t), 2.0 * t) for t in np.linspace(0.1, 1.0, 10)]
    activate(by_way)
    ways.append((-0.5, 0.75, 0.0))
    assert bpy.ops.planar.drag_pins(offset=(-0.5, 0.75), path=path(ways)) == {"FINISHED"}
    activate(at_once)
    assert bpy.ops.planar.drag_pins(offset=(-0.5, 0.75)) == {"FINISHED"}
    assert coordinates(by_way.data.vertices) == pytest.approx(coordinates(at_once.data.vertices), abs=1e-5)


def test_arap_pins_that_come_back_bring_the_drawing_back():
    obj = bar_by("ARAP")
    rest = rest_of(obj)
    assert bpy.ops.planar.drag_pins(offset=(-0.5, 0.75)) == {"FINISHED"}
    assert np.abs(rest_of(obj) - rest).max() > 0.3
    assert bpy.ops.planar.drag_pins(offset=(0.5, -0.75)) == {"FINISHED"}
    assert rest_of(obj) == pytest.approx(rest, abs=1e-4)


def test_arap_takes_stiffness_and_settles_and_is_keyed():
    obj = bar_by("ARAP", nx=24, ny=4)
    group = obj.vertex_groups.new(name="Stiff")
    group.add(range(125), 0.5, "REPLACE")
    group.add([i for i in range(125) if i % 25 > 12], 1.0, "REPLACE")
    add_pins(obj, [62])
    assert bpy.ops.planar.drag_pins(offset=(0.0, 0.4)) == {"FINISHED"}
    plain = rest_of(obj)
    obj.planar.stiffness_group = "Stiff"
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}
    assert np.abs(rest_of(obj) - plain).max() > 1e-3, "what is stiff bends less"
    settled = rest_of(obj)
    assert bpy.ops.planar.settle_pose() == {"FINISHED"}
    assert rest_of(obj) == pytest.approx(settled, abs=1e-5)
    assert bpy.ops.planar.key_pose() == {"FINISHED"}
    assert evaluated(obj) == pytest.approx(settled, abs=1e-5)
