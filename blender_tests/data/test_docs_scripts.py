# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts in docs/ do what their pages say."""

import re
from pathlib import Path

import bpy
import numpy as np
from support import PLANES, coordinates, evaluated, grid, make_object

DOCS = Path(__file__).parents[2] / "docs"


def script_of(page: str) -> str:
    (script,) = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    return script.strip()


def standing_sheet():
    vertices, faces = grid(8, 8, width=1.0, height=1.0, origin=(-0.5, 0.0))
    return make_object(vertices @ PLANES["XZ"].T, faces.tolist())


def test_script_of_the_posing_page():
    obj = standing_sheet()
    obj.vertex_groups.new(name="Hand").add([79, 80, 71, 70], 1.0, "REPLACE")
    rest = coordinates(obj.data.vertices)

    *posing, reset = script_of("posing.md").splitlines()
    exec("\n".join(posing), {})
    hand = obj.planar.pins["Hand"]
    moved = (coordinates(obj.data.vertices) - rest)[[79, 80, 71, 70]].mean(axis=0)
    assert np.allclose(moved, (0.4, 0.0, 1.1), atol=0.02)  # pins are soft: near their targets
    assert np.isclose(hand.angle, 0.5)
    exec(f"import bpy\n{reset}", {})
    assert np.array_equal(coordinates(obj.data.vertices), rest)
    assert bpy.context.object == obj


def test_script_of_the_poses_page():
    obj = standing_sheet()
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))  # the new pin is the selected one
    exec(script_of("poses.md"), {})

    def shown(frame):
        bpy.context.scene.frame_set(frame)
        return evaluated(obj)

    rest, stretched, mirrored = shown(1), shown(25), shown(49)
    assert np.isclose(stretched[:, 0].max(), rest[:, 0].max() + 0.4, atol=0.05)
    assert np.isclose(mirrored[:, 0].min(), rest[:, 0].min() - 0.4, atol=0.05)
    assert len(obj.planar.poses) == 3


def test_script_of_the_in_betweens_page():
    obj = standing_sheet()
    bpy.ops.planar.add_pin(location=(-0.5, 0.0, 0.5))
    bpy.ops.planar.add_pin(location=(0.5, 0.0, 0.5))  # the new pin is the selected one
    before, after = script_of("inbetweens.md").split("bpy.ops.planar.retime_pose")

    def shown(frame):
        bpy.context.scene.frame_set(frame)
        return evaluated(obj)

    names = {}
    exec(before, names)
    pulled = 4 * 9 + 8  # the vertex of the second pin
    assert np.allclose((shown(25) - shown(1))[pulled], (-0.3, 0.0, 0.9), atol=0.01)
    assert obj.planar.poses[0].generated == 23
    halfway, posed = shown(13), shown(49)
    assert not np.allclose(halfway, (shown(1) + shown(25)) / 2, atol=0.01)  # an arc

    exec("bpy.ops.planar.retime_pose" + after, names)
    assert np.array_equal(shown(61), posed)
    sides = shown(43) - shown(43).mean(axis=0), shown(25) - shown(25).mean(axis=0)
    assert np.vdot(*sides) < 0  # halfway through an extra turn it is upside down
    assert len(obj.planar.poses) == 4  # with the breakdown
    assert obj.planar.show_onion
