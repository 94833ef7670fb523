# SPDX-License-Identifier: GPL-3.0-or-later
"""Each test starts in an empty Blender in which the add-on is registered."""

import os
import sys
from pathlib import Path

import bpy
import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "addon"))


def pytest_configure(config):
    others = [path for path in config.args if not Path(path.split("::")[0]).resolve().is_relative_to(HERE)]
    if others:
        raise pytest.UsageError(
            f"Run the data tests in a call of their own, without {' '.join(others)}: other tests have files "
            "of the same names, and give threads stacks that are too small for Blender's NumPy."
        )


@pytest.fixture(scope="session", autouse=True)
def _add_on():
    import planar_deform

    bpy.ops.wm.read_factory_settings(use_empty=True)
    planar_deform.register()
    yield
    planar_deform.unregister()


@pytest.fixture(scope="session")
def _factory_edit(_add_on):
    """The preferences that tests change, as Blender comes with them."""
    edit = bpy.context.preferences.edit
    own = [entry.identifier for entry in edit.bl_rna.properties if entry.type in {"BOOLEAN", "ENUM"}]
    values = {name: getattr(edit, name) for name in own if not edit.is_property_readonly(name)}
    # Tests tell what a frame shows by its share of the way; those of ease choose their own.
    return values | {"keyframe_new_interpolation_type": "LINEAR"}


@pytest.fixture(autouse=True)
def _fresh_file(_factory_edit):
    # Factory settings at each test would enable all of Blender's own add-ons anew: half of a run's time.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    edit = bpy.context.preferences.edit
    for name, value in _factory_edit.items():
        if getattr(edit, name) != value:
            setattr(edit, name, value)


_code = None


def pytest_sessionfinish(exitstatus):
    global _code
    _code = exitstatus


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    """Leave at once: bpy crashes as Python ends where pytest still holds objects of it (parameters, say)."""
    if _code is None:  # no test was begun, and pytest says why after this
        return
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(int(_code))
