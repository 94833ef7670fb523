# SPDX-License-Identifier: GPL-3.0-or-later
"""The module among threads: solves run without the GIL, and side by side give the same bits as in turn."""

import os
import signal
import threading
import time

import native_reference as reference
import numpy as np
import pytest

import planar_native

METHODS = ["hold", "akvf", "arap"]


def drag(poser, rest, handles, turn):
    """The positions along a drag that moves the handles on an arc."""
    path = []
    for step in range(12):
        angle = turn * (step + 1)
        arc = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        path.append(poser.move(rest[handles] @ arc))
    path.append(poser.refine())
    path.append(poser.settle())
    return np.array(path)


def together(*functions):
    """Call each function in a thread of its own, all at once; their results, or the first exception."""
    results = [None] * len(functions)
    errors = []
    start = threading.Barrier(len(functions))

    def run(index):
        start.wait()
        try:
            results[index] = functions[index]()
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=run, args=(index,)) for index in range(len(functions))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return results


@pytest.fixture(scope="module")
def mesh():
    return reference.bar(columns=40, rows=20)


@pytest.mark.parametrize("method", METHODS)
def test_two_posers_in_two_threads_give_the_bits_of_one_after_the_other(mesh, method):
    rest, triangles = mesh
    drags = [(np.array([0, 40, 500]), 0.03), (np.array([7, 300, 820, 860]), -0.02)]

    def run(handles, turn):
        poser = planar_native.Poser(rest, triangles, method=method)
        poser.set_handles(handles)
        return drag(poser, rest, handles, turn)

    alone = [run(*each) for each in drags]
    for _ in range(3):
        beside = together(*(lambda each=each: run(*each) for each in drags))
        np.testing.assert_array_equal(beside, alone)


@pytest.mark.parametrize("method", METHODS)
def test_one_poser_in_two_threads_makes_calls_wait_for_each_other(mesh, method):
    """Every result is that of a call that ran alone: all ask for the same move, so there is one sequence."""
    rest, triangles = mesh
    handles = np.array([0, 40, 500])
    targets = rest[handles] + [[0.0, 0.0], [2.0, 3.0], [0.0, 1.0]]

    def fresh():
        poser = planar_native.Poser(rest, triangles, method=method)
        poser.set_handles(handles)
        return poser

    calls = 8
    poser = fresh()
    alone = [poser.move(targets) for _ in range(2 * calls)]
    poser = fresh()
    first, second = together(*([lambda: [poser.move(targets) for _ in range(calls)]] * 2))
    np.testing.assert_array_equal(poser.positions, alone[-1])
    known = {shape.tobytes() for shape in alone}
    assert all(shape.tobytes() in known for shape in first + second)


@pytest.mark.parametrize("method", METHODS)
def test_other_threads_run_during_a_solve(method):
    """With the GIL held, the main thread could not wake between the solve's start and its end."""
    rest, triangles = reference.bar(columns=150, rows=100)
    poser = planar_native.Poser(rest, triangles, method=method)
    poser.set_handles([0, 150, 15000])
    targets = rest[[0, 150, 15000]] + [[0.0, 0.0], [5.0, 9.0], [0.0, 1.0]]
    span = []

    def solve():
        begin = time.perf_counter()
        poser.move(targets)
        span.extend([begin, time.perf_counter()])

    wakes = []
    thread = threading.Thread(target=solve)
    thread.start()
    while thread.is_alive():
        wakes.append(time.perf_counter())
        time.sleep(1e-3)
    begin, end = span
    middle = [wake for wake in wakes if begin + 0.1 * (end - begin) < wake < end - 0.1 * (end - begin)]
    assert len(middle) >= 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no process forks here (Windows)")
def test_a_forked_process_uses_and_drops_objects_of_its_parent():
    """It has no threads but its own; large enough that the parent's objects have some."""
    rest, triangles = reference.bar(columns=60, rows=30)
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles([0, len(rest) - 1])
    targets = rest[[0, -1]] + 0.1
    poser.move(targets)
    motion = planar_native.Inbetweens([rest, poser.positions], triangles=triangles, threads=2)
    child = os.fork()
    if child == 0:
        signal.alarm(60)  # ends it if it waits for a thread that is not there
        poser.move(targets)
        motion.at([0.2, 0.4, 0.6, 0.8, 0.9])
        del poser, motion
        os._exit(7)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    poser.move(targets)
