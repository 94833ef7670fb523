# SPDX-License-Identifier: GPL-3.0-or-later
"""What the demo and the benchmarks take from the add-on is there: they run in no other test."""

import ast
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = sorted(
    str(path.relative_to(ROOT)) for name in ("examples", "benchmarks") for path in (ROOT / name).glob("*.py")
)


@pytest.mark.parametrize("script", SCRIPTS)
def test_what_a_script_imports_of_the_add_on_is_there(script):
    for node in ast.walk(ast.parse((ROOT / script).read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("planar_deform"):
            module = importlib.import_module(node.module)
            for name in node.names:
                assert hasattr(module, name.name) or importlib.import_module(f"{node.module}.{name.name}")
