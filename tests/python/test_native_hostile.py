# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that lie, change under the module's hands or were never made: an answer or a ValueError, never
memory that is not theirs. What broke memory once runs in a process of its own, in which Python watches it."""

import copy
import os
import subprocess
import sys
import textwrap

import native_reference as reference
import numpy as np
import pytest

import planar_native

REST, TRIANGLES = reference.bar(columns=6, rows=2)
KEYS = np.array([REST, REST @ [[0.8, 0.6], [-0.6, 0.8]] + 1.0])
HANDLES = np.array([0, 6, 14])

PREAMBLE = """
import numpy as np, planar_native
x, y = np.meshgrid(np.arange(7.0), np.arange(3.0))
rest = np.column_stack([x.ravel(), y.ravel()])
triangles = np.array([[i, i + 1, i + 7] for i in range(13) if i % 7 < 6])
keys = np.array([rest, rest[:, ::-1] * [-1, 1] + 1.0])
def frames(**options):
    return planar_native.inbetween(keys, [0.25, 0.5], triangles=triangles, **options)
"""


def watched(code):
    """Run the code in a Python that fills freed memory and checks the ends of blocks."""
    result = subprocess.run(
        [sys.executable, "-c", PREAMBLE + textwrap.dedent(code)],
        env={**os.environ, "PYTHONMALLOC": "debug"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert result.returncode == 0, result.stderr[-2000:]


def test_anchors_of_any_kind_outlive_the_conversion():
    watched("""
    expected = frames(anchor=[0, 1])
    for anchor in (np.array([0, 1]), (0, 1), [[0, 1]], np.array([[0, 1]]), [np.array([0, 1])], range(2)):
        np.testing.assert_array_equal(frames(anchor=anchor), expected)

    class Made:  # makes what it holds when it is asked
        def __len__(self): return 1
        def __getitem__(self, i):
            if i: raise IndexError(i)
            return np.array([0, 1])
    np.testing.assert_array_equal(frames(anchor=Made()), expected)
    np.testing.assert_array_equal(frames(anchor=[None]), frames())
    """)


def test_turns_whose_rows_lie_are_taken_as_the_array_they_say():
    watched("""
    class Liar:
        def __array__(self, *args, **kwargs): return np.array([[1]])
        def __iter__(self): return iter([np.array([k]) for k in range(5000)])
        def __len__(self): return 5000
    np.testing.assert_array_equal(frames(turns=Liar()), frames(turns=[[1]]))

    class Fickle:
        asked = 0
        def __array__(self, *args, **kwargs):
            Fickle.asked += 1
            return np.ones((1, 1), int) if Fickle.asked == 1 else np.ones((1000, 1000), int)
    np.testing.assert_array_equal(frames(turns=Fickle()), frames(turns=[[1]]))
    """)


def test_containers_that_change_while_they_are_read():
    watched("""
    class Shape:  # empties what it is in
        def __init__(self, inside): self.inside = inside
        def __array__(self, *args, **kwargs):
            self.inside.clear()
            return rest
    shapes = []
    shapes += [Shape(shapes), rest + 1.0]
    assert planar_native.inbetween(shapes, [0.5], triangles=triangles).shape == (1, 21, 2)
    edits = {}
    edits.update({0: Shape(edits), 1: rest + 2.0})
    result = planar_native.edit_sequence([rest, rest, rest], edits, triangles=triangles)
    np.testing.assert_array_equal(result[1], rest + 2.0)
    joints = []
    class Joint:
        def __array__(self, *args, **kwargs):
            joints.clear()
            return np.zeros((0, 2), int)
    joints += [Joint()]
    frames(joints=joints)
    """)


def test_a_callback_may_drop_everything():
    watched("""
    import gc
    class Callback:
        def __call__(self, share): gc.collect()
    motion = planar_native.Inbetweens(keys, triangles=triangles, progress=Callback())
    gc.collect()
    assert motion.at([0.5]).shape == (1, 21, 2)
    """)


@pytest.mark.parametrize("kind", [planar_native.Report, planar_native.Distortion])
def test_results_cannot_be_made_by_hand(kind):
    for make in (lambda: kind(), lambda: kind.__new__(kind), lambda: object.__new__(kind)):
        with pytest.raises(TypeError):
            make()


def test_results_cannot_be_copied_without_their_numbers():
    poser = planar_native.Poser(REST, TRIANGLES)
    for result in (poser.report, planar_native.distortion(REST, REST, TRIANGLES)):
        with pytest.raises(TypeError):
            copy.copy(result)


@pytest.mark.parametrize("use", [lambda motion: motion.at([0.5])])
def test_inbetweens_that_were_not_initialised_refuse(use):
    with pytest.raises(RuntimeError):
        use(planar_native.Inbetweens.__new__(planar_native.Inbetweens))


def test_empty_handles_and_anchors_are_named_as_empty():
    poser = planar_native.Poser(REST, TRIANGLES)
    with pytest.raises(ValueError, match="^handles: empty"):
        poser.set_handles([])
    with pytest.raises(ValueError, match="^handles: empty"):
        planar_native.killing_field(REST, TRIANGLES, [], np.zeros((0, 2)))
    for anchor in ([], (), np.zeros(0), np.zeros(0, int)):
        with pytest.raises(ValueError, match="^anchor: empty"):
            planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, anchor=anchor)
    with pytest.raises(ValueError, match=r"^anchor\[1\]: empty"):
        planar_native.inbetween([*KEYS, REST], [0.5], triangles=TRIANGLES, anchor=[[0], []])


@pytest.mark.parametrize("kind", [np.int8, np.int32, np.int64, np.uint64])
def test_numpy_integers_are_whole_numbers(kind):
    plain = planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, turns=1, threads=1, max_iterations=50)
    for one in (kind(1), np.array(1, kind)):
        options = {"turns": one, "threads": kind(1), "max_iterations": kind(50)}
        frames = planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, **options)
        np.testing.assert_array_equal(frames, plain)
    edited = planar_native.edit_sequence(KEYS, {1: REST}, triangles=TRIANGLES)
    np.testing.assert_array_equal(
        planar_native.edit_sequence(KEYS, {kind(1): REST}, triangles=TRIANGLES), edited
    )


@pytest.mark.parametrize("frame", ["first", 1.0, None, 2**31, 2**40, -(2**70), np.uint64(2**63), (1,)])
def test_edits_name_frames_by_whole_numbers(frame):
    with pytest.raises(ValueError, match="^edits"):
        planar_native.edit_sequence(KEYS, {frame: REST}, triangles=TRIANGLES)


@pytest.mark.parametrize(
    "turns", [1.5, True, "1", [True], 2**31, 2**70, [[]], [[1.0]], np.zeros((0, 1), int)]
)
def test_turns_are_whole_numbers(turns):
    with pytest.raises(ValueError, match="^turns"):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, turns=turns)


@pytest.mark.parametrize("answer", ["yes", 3, 0.0, [], np.zeros(2), object()])
def test_a_progress_callback_answers_true_false_or_none(answer):
    with pytest.raises(ValueError, match="^progress: returned"):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=lambda share: answer)
    with pytest.raises(ValueError, match="^progress: returned"):
        planar_native.Inbetweens(KEYS, triangles=TRIANGLES, progress=lambda share: answer)


def test_a_progress_callback_may_answer_in_numpys_truth():
    planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=lambda share: np.True_)
    with pytest.raises(planar_native.Cancelled):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=lambda share: np.False_)


@pytest.mark.parametrize("keys", [3, 3.0, np.array(3.0), np.float64(3), None, "shapes", [], {}, (), object()])
def test_keys_that_are_no_shapes(keys):
    with pytest.raises(ValueError, match="^keys"):
        planar_native.inbetween(keys, [0.5], triangles=TRIANGLES)
    with pytest.raises(ValueError, match="^keys"):
        planar_native.inbetween(keys, [], triangles=TRIANGLES, turns=1)
    with pytest.raises(ValueError, match="^frames"):
        planar_native.transfer_motion(keys, REST, triangles=TRIANGLES)


@pytest.mark.skipif(sys.platform == "win32", reason="nothing tells a process' peak of memory here")
def test_hard_handles_take_memory_for_each_other_and_not_for_each_vertex():
    """A table of a column a constraint would be 2n x 2k numbers, 125 MB here; k x k ones are 1 MB."""
    code = """
    import resource, sys
    side = 100
    x, y = np.meshgrid(np.arange(float(side)), np.arange(float(side)))
    rest = np.column_stack([x.ravel(), y.ravel()])
    a = (np.arange(side - 1) + side * np.arange(side - 1)[:, None]).ravel()
    triangles = np.concatenate([np.column_stack([a, a + 1, a + side]),
                                np.column_stack([a + 1, a + side + 1, a + side])])
    unit = 2**20 if sys.platform == "darwin" else 2**10  # macOS counts bytes, Linux KiB
    def peak(): return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit
    few, many = [0, 9999], np.arange(0, 9984, 26)
    planar_native.killing_field(rest, triangles, few, rest[few], hard=True, dirichlet=False)
    before = peak()
    field = planar_native.killing_field(rest, triangles, many, rest[many, ::-1], hard=True, dirichlet=False)
    np.testing.assert_allclose(field[many], rest[many, ::-1], atol=1e-6)
    assert peak() - before < 40, peak() - before
    """
    watched(code)
