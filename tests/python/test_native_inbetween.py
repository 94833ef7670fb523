# SPDX-License-Identifier: GPL-3.0-or-later
"""In-betweening, transfer of motions and editing of sequences through the module."""

from __future__ import annotations

import numpy as np
import pytest

import planar_native


def bar(columns: int = 20) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.linspace(0, 1, columns + 1), [-0.05, 0.05])
    rest = np.column_stack([x.ravel(), y.ravel()])
    a = np.arange(columns)
    above = a + columns + 1
    triangles = np.concatenate(
        [np.column_stack([a, a + 1, above]), np.column_stack([a + 1, above + 1, above])]
    )
    return rest, triangles


def rolled(rest: np.ndarray, angle: float) -> np.ndarray:
    radius = 1 / angle - rest[:, 1]
    turn = rest[:, 0] * angle
    return np.column_stack([radius * np.sin(turn), 1 / angle - radius * np.cos(turn)])


REST, TRIANGLES = bar()
KEYS = np.array([REST, rolled(REST, np.radians(300))])
SIDES = np.column_stack([np.arange(20), np.arange(1, 21)])


def test_a_rolled_bar_keeps_its_shape():
    frames = planar_native.inbetween(KEYS, np.linspace(0, 1, 9), triangles=TRIANGLES)
    assert frames.shape == (9, len(REST), 2)
    assert frames.dtype == np.float64
    assert np.array_equal(frames[0], KEYS[0])
    assert np.array_equal(frames[-1], KEYS[1])
    worst = planar_native.distortion(REST, KEYS[1], TRIANGLES)
    for frame in frames:
        distortion = planar_native.distortion(REST, frame, TRIANGLES)
        assert distortion.flipped == 0
        assert distortion.area <= 1.001 * worst.area
        assert distortion.angle <= 1.001 * worst.angle


def test_the_solved_motion_gives_the_same_frames():
    motion = planar_native.Inbetweens(list(KEYS), triangles=TRIANGLES, key_times=[1, 25])
    frames = planar_native.inbetween(KEYS, np.arange(1, 26), triangles=TRIANGLES, key_times=[1, 25])
    assert np.abs(motion.at(np.arange(25, 0, -1))[::-1] - frames).max() < 1e-12


def test_the_report_says_what_converged_and_what_flips():
    bent = rolled(REST, 1.0)
    good = planar_native.Inbetweens([REST, bent, REST], triangles=TRIANGLES).report
    assert [(report.converged, report.unrepaired) for report in good] == [(True, []), (True, [])]
    (stopped,) = planar_native.Inbetweens(
        [REST, rolled(REST, 3.0)], triangles=TRIANGLES, tolerance=1e-9, max_iterations=1
    ).report
    assert (stopped.converged, stopped.iterations) == (False, 1)
    (mirrored,) = planar_native.Inbetweens([REST, REST * [1, -1]], triangles=TRIANGLES).report
    assert mirrored.unrepaired == [0]


@pytest.mark.parametrize("method", ["paper", "global"])
def test_the_papers_methods(method):
    keys = [REST, rolled(REST, np.radians(60))]
    frames = planar_native.inbetween(keys, np.linspace(0, 1, 13), triangles=TRIANGLES, method=method)
    default = planar_native.inbetween(keys, np.linspace(0, 1, 13), triangles=TRIANGLES)
    assert np.abs(frames - default).max() < 0.02  # of the bar's length


def test_turns_anchors_and_edges():
    turned = [REST, REST + np.array([1, 0])]
    for turns in (1, [1], [[1]]):
        half = planar_native.inbetween(turned, [0.5], triangles=TRIANGLES, turns=turns)[0]
        assert np.allclose(half, [2 * REST.mean(axis=0) - REST + [0.5, 0]], atol=1e-12)
    anchored = planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, anchor=[0], anchor_path="arc")[0]
    assert anchored.shape == REST.shape
    line = planar_native.inbetween(KEYS[:, :21], [0.5], edges=SIDES, rest=REST[:21])[0]
    length = np.linalg.norm(np.diff(line, axis=0), axis=1)
    assert length.min() > 0.98 * 0.05  # the sides' length at rest is 0.05
    assert length.max() < 1.3 * 0.05


def test_smooth_motions_have_one_velocity_at_a_key():
    keys = [REST, rolled(REST, 1.0), rolled(REST, 4.0)]
    jumps = []
    for smooth in (True, False):
        motion = planar_native.Inbetweens(keys, triangles=TRIANGLES, key_times=[0, 1, 5], smooth=smooth)
        before, key, after = motion.at([1 - 1e-5, 1, 1 + 1e-5])
        assert np.array_equal(key, keys[1])
        jumps.append(np.abs((after - key) - (key - before)).max() / np.abs(after - before).max())
    assert jumps[0] < 1e-3 < 0.1 < jumps[1]


def test_each_transition_can_have_its_own_anchor():
    keys = [REST, rolled(REST, 1.0) + np.array([1, 0]), rolled(REST, 4.0)]
    for anchor in ([[3, 5], None], [np.array([3, 5]), np.empty(0, int)]):
        frames = planar_native.inbetween(keys, [0.5, 1.5], triangles=TRIANGLES, anchor=anchor)
        middle = (keys[0] + keys[1]) / 2
        assert np.allclose(frames[0][[3, 5]].mean(axis=0), middle[[3, 5]].mean(axis=0), atol=1e-12)
        centre = (keys[1] + keys[2]).mean(axis=0) / 2
        assert np.allclose(frames[1].mean(axis=0), centre, atol=1e-12)


def test_pins_stand_or_go_on_their_paths():
    keys = [REST, rolled(REST, 1.0) + np.array([0.3, 0.1])]
    inside = ([3, 30], [[0.2, 0.3, 0.5], [1.0, 0.0, 0.0]])

    def places(shape: np.ndarray) -> np.ndarray:
        return np.einsum("kc,kcx->kx", inside[1], shape[TRIANGLES[inside[0]]])

    ways = places(keys[0]) + np.linspace(0, 1, 5)[:, None, None] * (places(keys[1]) - places(keys[0]))
    frames = planar_native.inbetween(keys, np.linspace(0, 1, 5), triangles=TRIANGLES, pins=inside)
    assert max(np.abs(places(frame) - way).max() for frame, way in zip(frames, ways, strict=True)) < 1e-4
    assert np.array_equal(frames[0], keys[0])
    assert np.array_equal(frames[-1], keys[1])

    motion = planar_native.Inbetweens(keys, triangles=TRIANGLES, pins=inside)
    paths = ways + np.array([0.0, 0.02])
    paths[:, 1] = np.nan
    moved = motion.at(np.linspace(0, 1, 5), pin_paths=paths)
    for frame, way in zip(moved[1:-1], ways[1:-1], strict=True):
        assert np.abs(places(frame) - way - np.array([[0.0, 0.02], [0.0, 0.0]])).max() < 1e-4
    assert np.array_equal(moved[-1], keys[1])
    again = planar_native.inbetween(
        keys, np.linspace(0, 1, 5), triangles=TRIANGLES, pins=inside, pin_paths=list(paths)
    )
    assert np.array_equal(again, moved)


def test_pins_are_patches_and_held_where_it_is_said():
    keys = [REST, rolled(REST, 2.0), REST]
    pins = [0, 1, 21, 22]
    frames = planar_native.inbetween(
        keys, [0.5, 1.5], triangles=TRIANGLES, pins=pins, pin_groups=[7] * 4, pinned=[[True] * 4, [False] * 4]
    )
    free = planar_native.inbetween(keys, [0.5, 1.5], triangles=TRIANGLES)
    assert np.array_equal(frames[1], free[1])
    assert not np.array_equal(frames[0], free[0])
    middle = (REST[pins].mean(axis=0) + keys[1][pins].mean(axis=0)) / 2
    assert np.allclose(frames[0][pins].mean(axis=0), middle, atol=1e-4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pins": [99]}, "handles, row 0: vertex 99"),
        ({"pins": [0], "pin_groups": [0, 1]}, "pin_groups: shape"),
        ({"pins": [0], "pinned": [[1]]}, "pinned: shape"),
        ({"pins": [0], "pinned": [True]}, "pinned: shape"),
        ({"pins": [0], "pinned": [[True, True]]}, "pinned has 2 columns"),
        ({"pins": [0], "pin_paths": [[[0, 0]] * 2]}, "has 2 rows"),
        ({"pins": [0], "pin_paths": [[[0, np.inf]]]}, "not a finite number"),
        ({"pins": [0], "pin_paths": 3}, "pin_paths: expected an array"),
        ({"pin_paths": [[[0, 0]]]}, "there are no pins"),
        ({"pins": [0], "method": "paper"}, "pins: the paper's methods"),
    ],
)
def test_pins_that_cannot_be(options, message):
    with pytest.raises(ValueError, match=message.replace("[", "\\[")):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, **options)
    with pytest.raises(ValueError, match="pins: edges without faces"):
        planar_native.inbetween(KEYS[:, :21], [0.5], edges=SIDES, pins=[0])


def test_joints_keep_layers_together():
    count = len(REST)
    rest = np.concatenate([REST, REST + np.array([1, 0])])
    posed = np.concatenate([KEYS[1], REST[:, ::-1] * np.array([-1, 1])])
    posed[count:] += posed[20] - posed[count]
    triangles = np.concatenate([TRIANGLES, TRIANGLES + count])
    for joints in ([[[20, count]]], [np.array([[20, count]])]):
        frames = planar_native.inbetween(
            [rest, posed], np.linspace(0, 1, 5), triangles=triangles, joints=joints
        )
        assert np.abs(frames[:, 20] - frames[:, count]).max() < 1e-12


def test_overshoot_goes_beyond_the_keys():
    motion = planar_native.Inbetweens(KEYS, triangles=TRIANGLES)
    before, at, after = motion.at([1 - 1e-5, 1, 1 + 1e-5], overshoot=True)
    assert np.abs((after - at) - (at - before)).max() < 1e-8
    assert np.isfinite(motion.at([-1, 2], overshoot=True)).all()
    with pytest.raises(ValueError, match="times, row 0"):
        motion.at([1.1])
    with pytest.raises(ValueError, match="times, row 1"):
        motion.at([1.1, 2.1], overshoot=True)


def test_transfer_and_editing():
    frames = planar_native.inbetween(KEYS, np.linspace(0, 1, 7), triangles=TRIANGLES)
    assert np.abs(planar_native.transfer_motion(frames, REST, triangles=TRIANGLES) - frames).max() < 1e-9
    edited = planar_native.edit_sequence(frames, {3: frames[3] * 1.5}, triangles=TRIANGLES)
    assert np.array_equal(edited[3], frames[3] * 1.5)
    assert np.abs(np.ptp(edited, axis=1) - 1.5 * np.ptp(frames, axis=1)).max() < 1e-9


def test_progress_can_cancel_and_fail():
    shares = []
    planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=shares.append)
    assert shares == sorted(shares)
    assert shares
    with pytest.raises(planar_native.Cancelled):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=lambda share: False)
    with pytest.raises(ZeroDivisionError):
        planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, progress=lambda share: 1 / 0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"keys": KEYS[:1]}, "keys"),
        ({"keys": REST}, r"keys\[0\]"),
        ({"keys": 3}, "keys"),
        ({"keys": [REST, REST[:5]]}, r"keys\[1\]"),
        ({"keys": [REST, REST * np.nan]}, r"keys\[1\], row 0"),
        ({"times": [0.5, 2]}, "times, row 1"),
        ({"times": [[0.5]]}, "times"),
        ({"triangles": None}, "triangles, edges"),
        ({"edges": SIDES}, "triangles, edges"),
        ({"triangles": TRIANGLES + 30}, "triangles, row"),
        ({"key_times": [0, 1, 2]}, "key_times"),
        ({"key_times": [1, 0]}, "key_times, row 1"),
        ({"rest": REST[:4]}, "rest"),
        ({"turns": [[[1]]]}, "turns"),
        ({"turns": [1, 2]}, "turns"),
        ({"turns": 1000}, "turns"),
        ({"turns": 10**12}, "turns"),
        ({"turns": -(2**31)}, "turns"),
        ({"turns": 1, "keys": []}, "keys"),
        ({"method": "paper", "smooth": True}, "smooth"),
        ({"method": "best"}, "method: 'best'"),
        ({"anchor": [100]}, "anchor, row 0"),
        ({"anchor": [[1], [100]]}, "anchor: 2 sets"),
        ({"anchor": [[100]]}, "anchor, row 0"),
        ({"anchor": [0.5]}, "anchor"),
        ({"anchor": 3}, "anchor"),
        ({"joints": 3}, "joints"),
        ({"joints": [[[0, 1]]]}, "joints, row 0: the part would carry itself"),
        ({"joints": [None, None]}, "joints: 2 sets"),
        ({"joints": [[1, 2]]}, r"joints\[0\]"),
        ({"anchor_path": "spiral"}, "anchor_path"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"max_iterations": 0}, "max_iterations"),
        ({"threads": -1}, "threads"),
        ({"method": "paper", "times": [0, 0.4, 1]}, "times, row 1"),
    ],
)
def test_refusals_name_the_argument(changes, words):
    arguments = {"keys": KEYS, "times": [0.5], "triangles": TRIANGLES} | changes
    with pytest.raises(ValueError, match=words):
        planar_native.inbetween(arguments.pop("keys"), arguments.pop("times"), **arguments)


def test_edits_are_checked():
    with pytest.raises(ValueError, match="edits"):
        planar_native.edit_sequence(KEYS, {"first": REST}, triangles=TRIANGLES)
    with pytest.raises(ValueError, match="out of range"):
        planar_native.edit_sequence(KEYS, {2: REST}, triangles=TRIANGLES)
    with pytest.raises(ValueError, match="edits"):
        planar_native.edit_sequence(KEYS, {2**40: REST}, triangles=TRIANGLES)
    with pytest.raises(ValueError, match=r"edits\[1\]"):
        planar_native.edit_sequence(KEYS, {1: REST[:3]}, triangles=TRIANGLES)


def test_more_threads_than_there_may_be_are_not_started():
    frames = planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES, threads=2_000_000_000)
    np.testing.assert_array_equal(frames, planar_native.inbetween(KEYS, [0.5], triangles=TRIANGLES))
