# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that solve in a thread and write step by step, as scripts and background run them."""

import threading

import bpy
import pytest
from support import bar

done: list[str] = []
job = None


@pytest.fixture(autouse=True)
def _operator():
    """An operator that does the job which a test gives it."""
    from planar_deform.operators.modal.long_job import LongOperator

    class Tested(LongOperator, bpy.types.Operator):
        bl_idname = "planar.test_job"
        bl_label = "Test"

        def job(self, context):
            return job()

    done.clear()
    bpy.utils.register_class(Tested)
    yield
    bpy.utils.unregister_class(Tested)


def run(solve, write, summary=None, how="EXEC_DEFAULT"):
    global job
    from planar_deform.operators.modal.long_job import Job

    def make():
        return Job(write, solve, summary)

    job = make
    bar()
    return bpy.ops.planar.test_job(how)


def three_steps(solved):
    try:
        for step in range(3):
            done.append(f"{solved} {step}")
            yield step / 3
    except GeneratorExit:
        done.append("put back")
        raise


@pytest.mark.parametrize("how", ["EXEC_DEFAULT", "INVOKE_DEFAULT"])
def test_it_solves_beside_blender_s_thread_and_writes_in_it(how, capfd):
    threads = []

    def solve(progress):
        threads.append(threading.current_thread())
        assert progress(0.5)
        return "shape"

    def write(solved):
        threads.append(threading.current_thread())
        yield from three_steps(solved)

    assert run(solve, write, lambda solved: f"Made a {solved}", how) == {"FINISHED"}
    assert done == ["shape 0", "shape 1", "shape 2"]
    assert threads[0] != threads[1] == threading.current_thread()
    assert "Made a shape" in capfd.readouterr().out


def test_without_anything_to_solve():
    global job
    from planar_deform.operators.modal.long_job import Job

    def make():
        return Job(three_steps)

    job = make
    bar()
    assert bpy.ops.planar.test_job() == {"FINISHED"}
    assert len(done) == 3


def test_what_goes_wrong_is_reported():
    from planar_deform import native
    from planar_deform.errors import ObjectGone, Refusal

    def fail(error):
        def solve(progress):
            raise error

        return solve

    for error in (
        native.SolveError("it cannot be solved"),
        Refusal("not like this"),
        ObjectGone("it is gone"),
    ):
        with pytest.raises(RuntimeError, match=str(error)):
            run(fail(error), three_steps)
    assert done == []

    def refuse(solved):
        yield 0.1
        raise Refusal("too far")

    with pytest.raises(RuntimeError, match="too far"):
        run(lambda progress: None, refuse)


def test_stopped_while_it_is_solved_nothing_is_written():
    from planar_deform.operators.modal.long_job import Job, LongRun

    answers, go = [], threading.Event()

    def solve(progress):
        go.wait(10.0)
        answers.append(progress(0.5))

    run = LongRun(Job(three_steps, solve))
    assert not run.advance(0.01, 0.01)
    run.stop()
    go.set()
    assert run._work.wait(10.0)
    assert answers == [False]
    assert done == []


def test_stopped_while_it_is_written_what_was_written_is_put_back():
    from planar_deform.operators.modal.long_job import Job, LongRun

    run = LongRun(Job(three_steps, lambda progress: "shape"))
    shares = [run.share]
    while len(done) < 2:
        assert not run.advance(1.0, 0.0)
        shares.append(run.share)
    assert shares == sorted(shares)
    assert 0.5 <= shares[-1] < 1.0
    run.stop()
    assert done == ["shape 0", "shape 1", "put back"]
    run.stop()
    assert done[-1] == "put back"
    assert done.count("put back") == 1
