# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh of a drawing that hangs in a lattice, whose pins hold it."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix
from remeshed import coarse_bar, remesh
from support import activate, coordinates, world

TURNED = Matrix.LocRotScale((0.3, 1.0, 2.0), Euler((np.pi / 2, 0.0, 0.2)), (0.7, 0.7, 0.7))  # as imported


@pytest.fixture
def hung():
    """A bar in a lattice that has two points and a patch on it, and the bar's own pins."""
    sheet = coarse_bar()
    sheet.matrix_world = TURNED
    activate(sheet)
    assert bpy.ops.planar.fit_lattice() == {"FINISHED"}
    cage = bpy.context.object
    assert cage.type == "LATTICE"
    for row in (14, 49):
        at = world(sheet, coordinates(sheet.data.vertices)[[row]])[0] + (0.01, 0.0, 0.01)
        assert bpy.ops.planar.add_pin(location=at.tolist()) == {"FINISHED"}
    group = sheet.vertex_groups.new(name="Hand")
    group.add([3, 4, 16, 17], 1.0, "REPLACE")
    assert bpy.ops.planar.add_pin_from_group(object="Cutout", group="Hand", kind="PATCH") == {"FINISHED"}
    return cage, sheet


def places(cage):
    from planar_deform.scene.view import snapshot

    activate(cage)
    snapshot.forget()
    return np.array([pin.place for pin in snapshot.of_active(bpy.context).pins])


def test_pins_of_the_lattice_stay_in_place(hung):
    cage, sheet = hung
    before = places(cage)
    assert len(before) == 3
    for count in (900, 300):
        remesh(sheet, vertices=count)
        now = places(cage)
        assert np.abs(now[:2] - before[:2]).max() < 2e-6
        assert np.abs(now[2] - before[2]).max() < 0.05
    assert [modifier.type for modifier in sheet.modifiers] == ["LATTICE"]


def test_the_lattice_is_posed_after_it_as_before(hung):
    cage, sheet = hung
    remesh(sheet, vertices=900)
    activate(cage)
    before = places(cage)
    bpy.ops.planar.select_pins(action="NONE")
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.15)) == {"FINISHED"}
    now = places(cage)
    assert np.linalg.norm(now[1] - before[1]) == pytest.approx(np.hypot(0.1, 0.15), rel=0.05)
    assert np.linalg.norm(now[0] - before[0]) < 0.01


def test_a_posed_lattice_goes_on_showing_its_pose(hung):
    cage, sheet = hung
    bpy.ops.planar.select_pins(action="NONE")
    bpy.ops.planar.select_pins(action="SELECT", pin=1)
    assert bpy.ops.planar.drag_pins(offset=(0.1, 0.15)) == {"FINISHED"}
    before, points = places(cage), coordinates(cage.data.points, "co_deform").tobytes()
    remesh(sheet, vertices=900)
    assert coordinates(cage.data.points, "co_deform").tobytes() == points
    assert np.abs(places(cage) - before).max() < 0.02
