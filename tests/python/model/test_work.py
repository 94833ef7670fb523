# SPDX-License-Identifier: GPL-3.0-or-later
"""A calculation in a thread: its result, its error, its progress, and stopping it."""

import threading

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
