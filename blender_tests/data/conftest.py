# SPDX-License-Identifier: GPL-3.0-or-later
"""Each test starts in an empty Blender in which the add-on is registered."""

import os
import sys
from pathlib import Path

import bpy
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "addon"))


@pytest.fixture(scope="session", autouse=True)
def _add_on():
    import planar_deform

    planar_deform.register()
    yield
    planar_deform.unregister()


@pytest.fixture(autouse=True)
def _fresh_file(_add_on):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # Tests tell what a frame shows by its share of the way; those of ease choose their own.
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"


_code = pytest.ExitCode.INTERNAL_ERROR


def pytest_sessionfinish(exitstatus):
    global _code
    _code = exitstatus


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    """Leave at once: bpy crashes as Python ends where pytest still holds objects of it (parameters, say)."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(int(_code))
