# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns of flat meshes."""

from xml.etree import ElementTree

import bpy
import pytest
from surfaces import all_of, cube, flatten

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_a_pattern_has_the_size_that_the_scene_s_units_tell(unit, tmp_path):
    bpy.context.scene.unit_settings.scale_length = unit
    obj = cube()
    flatten(obj, numbered_edges=True)
    path = tmp_path / "cube.svg"
    assert bpy.ops.planar.export_pattern(filepath=str(path)) == {"FINISHED"}
    root = ElementTree.parse(path).getroot()
    groups = root.findall(f"{SVG}g")
    assert len(groups) == 6
    numbers = []
    for group in groups:
        for line in group.findall(f"{SVG}line"):
            x1, y1, x2, y2 = (float(line.get(name)) for name in ("x1", "y1", "x2", "y2"))
            assert ((x1 - x2) ** 2 + (y1 - y2) ** 2) ** 0.5 == pytest.approx(2000.0 * unit, abs=2e-3)
        numbers += [int(text.text) for text in group.findall(f"{SVG}text")]
    assert sorted(numbers) == sorted([*range(1, 13)] * 2)


def test_without_numbers_there_are_outlines_alone(tmp_path):
    flatten(cube())
    path = tmp_path / "cube.svg"
    assert bpy.ops.planar.export_pattern(filepath=str(path)) == {"FINISHED"}
    assert len(ElementTree.parse(path).getroot().findall(f".//{SVG}path")) == 6
    assert "<line" not in path.read_text()


def test_refusals(tmp_path):
    obj = cube()
    with pytest.raises(RuntimeError, match="no flat mesh"):
        bpy.ops.planar.export_pattern(filepath=str(tmp_path / "a.svg"))
    flat = flatten(obj)
    before = all_of(obj, flat)
    with pytest.raises(RuntimeError, match="Give a path"):
        bpy.ops.planar.export_pattern()
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.planar.export_pattern(filepath=str(tmp_path / "missing" / "a.svg"))
    assert all_of(obj, flat) == before
