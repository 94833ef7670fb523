# SPDX-License-Identifier: GPL-3.0-or-later
"""Not a test of the add-on: run.py runs this file to see that it notices failures.

The second test fails; the third passes, but Blender prints a Python error during it: a failure of the file.
"""

from collections.abc import Iterator

import bpy
from harness import Window


def test_passes(window: Window) -> Iterator[None]:
    yield


def test_fails(window: Window) -> Iterator[None]:
    yield
    raise AssertionError("this test fails on purpose")


def test_prints_an_error(window: Window) -> Iterator[None]:
    def broken_timer() -> None:
        raise RuntimeError("this error is printed on purpose")

    bpy.app.timers.register(broken_timer)
    for _ in range(10):
        yield
