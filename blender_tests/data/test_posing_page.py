# SPDX-License-Identifier: GPL-3.0-or-later
"""The script in docs/posing.md does what the page says."""

import re
from pathlib import Path

import bpy
import numpy as np
from support import PLANES, coordinates, grid, make_object

PAGE = Path(__file__).parents[2] / "docs" / "posing.md"


def test_script_of_the_posing_page():
    (script,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    vertices, faces = grid(8, 8, width=1.0, height=1.0, origin=(-0.5, 0.0))
    obj = make_object(vertices @ PLANES["XZ"].T, faces.tolist())
    obj.vertex_groups.new(name="Hand").add([79, 80, 71, 70], 1.0, "REPLACE")
    rest = coordinates(obj.data.vertices)

    *posing, reset = script.strip().splitlines()
    exec("\n".join(posing), {})
    hand = obj.planar.pins["Hand"]
    moved = (coordinates(obj.data.vertices) - rest)[[79, 80, 71, 70]].mean(axis=0)
    assert np.allclose(moved, (0.4, 0.0, 1.1), atol=0.02)  # pins are soft: near their targets
    assert np.isclose(hand.angle, 0.5)
    exec(f"import bpy\n{reset}", {})
    assert np.array_equal(coordinates(obj.data.vertices), rest)
    assert bpy.context.object == obj
