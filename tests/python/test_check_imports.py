# SPDX-License-Identifier: GPL-3.0-or-later
"""The lint of what imports what notices planted imports of each wrong kind, wherever they stand."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CHECK = Path("tools/check_imports.py")
PACKAGE = Path("addon/planar_deform")


@pytest.fixture
def checked(tmp_path):
    """Checks a copy of the add-on with text put behind some modules; the exit code and the lines printed."""
    shutil.copytree(ROOT / PACKAGE, tmp_path / PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "tools").mkdir()
    shutil.copy(ROOT / CHECK, tmp_path / CHECK)

    def check(planted):
        for module, text in planted.items():
            path = tmp_path / PACKAGE / f"{module.replace('.', '/')}.py"
            path.parent.mkdir(exist_ok=True)
            with path.open("a") as file:
                file.write(f"\n{text}\n")
        command = [sys.executable, str(tmp_path / CHECK)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        return done.returncode, done.stdout.splitlines()

    return check


def test_what_is_free_to_all(checked):
    assert checked({"model.work": "import json, numpy"}) == (0, [])


def test_imports_against_the_direction(checked):
    planted = {
        "model.plane.frame": ("import bpy", "bpy"),
        "model.work": ("from mathutils.kdtree import KDTree", "mathutils"),
        "model.posing.pins": ("from ...errors import Refusal", "errors"),
        "model.plane.cutout": ("from ..posing import pins", "model.posing.pins"),
        "model.input.drag": ("import planar_native", "planar_native"),
        "scene.pins.pin_list": ("from ...operators import pins", "operators.pins"),
        "scene.motion.bake": ("def later():\n    from ...ui.draw import marks", "ui.draw.marks"),
        "scene.storage.points": ("from ..sequence.pose_state import is_ours", "scene.sequence.pose_state"),
        "scene.sequence.playback": (
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ..objects import stiffness",
            "scene.objects.stiffness",
        ),
        "scene.objects.modifiers": ("from .. import properties", "scene.properties"),
        "scene.view.onion": ("from .. import inbetweens", "scene.inbetweens.__init__"),
        "operators.rest": ("from ..ui.panels import pins_panel", "ui.panels.pins_panel"),
        "ui.draw.marks": ("from ...operators.bake import PLANAR_OT_bake", "operators.bake"),
    }
    code, lines = checked({module: text for module, (text, _) in planted.items()})
    assert code == 1
    assert [line for line in lines if not line.startswith("circle")] == sorted(
        f"{module}: must not import {name}" for module, (_, name) in planted.items()
    )


@pytest.mark.parametrize("indent", ["", "def later():\n    "], ids=["at the top", "in a function"])
def test_a_circle_within_a_folder(checked, indent):
    code, lines = checked({"scene.storage.changes": f"{indent}from .shape_keys import POSE_KEY"})
    assert code == 1
    circles = [line.removeprefix("circle: ").split(" → ") for line in lines]
    assert all(circle[0] == circle[-1] for circle in circles)
    planted = {f"scene.storage.{name}" for name in ("changes", "points", "shape_keys")}
    assert planted in [set(circle) for circle in circles]


def test_modules_without_a_place(checked):
    modules = ["helpers", "model.misc.helpers", "scene.helpers"]
    code, lines = checked(dict.fromkeys(modules, ""))
    assert code == 1
    assert lines == [f"{name}: has no place in the tables of tools/check_imports.py" for name in modules]
