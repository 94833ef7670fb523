# SPDX-License-Identifier: GPL-3.0-or-later
"""A calculation in a thread: its result, its error, its progress, and stopping it."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from planar_deform.model.work import Work


def test_result_and_share() -> None:
    go = threading.Event()

    def solve(progress):
        assert progress(0.25)
        go.wait(10.0)
        return "done"

    work = Work(solve)
    assert not work.wait(0.05)
    assert work.share == 0.25
    go.set()
    assert work.wait(10.0)
    assert work.result() == "done"


def test_it_raises_what_was_raised() -> None:
    def solve(progress):
        raise ValueError("no such thing")

    work = Work(solve)
    assert work.wait(10.0)
    with pytest.raises(ValueError, match="no such thing"):
        work.result()


def test_stopped_it_hears_so_at_the_next_progress() -> None:
    go, answers = threading.Event(), []

    def solve(progress):
        go.wait(10.0)
        answers.append(progress(0.5))

    work = Work(solve)
    work.stop()
    go.set()
    assert work.wait(10.0)
    assert answers == [False]


def test_python_exits_cleanly_with_a_stopped_one_in_native_code() -> None:
    script = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
import planar_native
from planar_deform.model.work import Work

x, y = np.meshgrid(np.linspace(-1.0, 1.0, 61), np.linspace(-1.0, 1.0, 61))
rest = np.stack([x.ravel(), y.ravel()], axis=1)
first = (np.arange(60)[:, None] * 61 + np.arange(60)).ravel()
triangles = np.stack([first, first + 1, first + 62], axis=1)
keys = [rest * (1.0 + 0.01 * (k % 2)) for k in range(400)]
work = Work(lambda progress: planar_native.Inbetweens(keys, triangles=triangles, progress=progress))
assert not work.wait(0.2)
work.stop()
"""
    addon = Path(__file__).parents[3] / "addon"
    done = subprocess.run([sys.executable, "-c", script, str(addon)], check=False, capture_output=True)
    assert done.returncode == 0, done.stderr
