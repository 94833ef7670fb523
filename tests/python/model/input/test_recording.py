# SPDX-License-Identifier: GPL-3.0-or-later
"""Recorded motion: samples by frame, smoothing, and which poses are kept."""

from functools import partial

import numpy as np
import pytest
from cutouts import grid_cutout, pin

from planar_deform.model.input.recording import Layer, Poses, Recording, smoothed
from planar_deform.model.posing import solver_cache
from planar_deform.model.posing.posing import Posing


def test_frames_lie_between_samples_in_proportion_to_time():
    recording = Recording()
    recording.add(2.0, (1.0, 0.0, 0.0))
    recording.add(2.5, (1.0, 4.0, 0.0))
    recording.add(4.5, (3.0, 4.0, 0.0))
    path = recording.by_frame(4)
    assert path == [(0, 0, 0), (0.5, 0, 0), (1, 0, 0), (1.5, 4, 0), (2.5, 4, 0)]


def test_the_last_sample_holds_beyond_its_time():
    recording = Recording()
    recording.add(1.0, (1.0, 2.0, 0.0))
    assert recording.by_frame(3)[1:] == [(1.0, 2.0, 0.0)] * 3


def test_smoothing_takes_the_jitter_and_leaves_ends_and_straight_motion():
    rng = np.random.default_rng(3)
    straight = [(float(np.float32(0.1 * k)), 0.0, 0.0) for k in range(40)]
    assert np.array(smoothed(straight, 2.0)) == pytest.approx(np.array(straight), abs=1e-6)
    jitter = [(du, float(np.float32(0.05 * rng.standard_normal())), 0.0) for du, _, _ in straight]
    smooth = smoothed(jitter, 2.0)
    assert smooth[0] == pytest.approx(jitter[0])
    assert smooth[-1] == pytest.approx(jitter[-1])
    rough = np.abs(np.diff(np.array(jitter)[:, 1], 2)).max()
    assert np.abs(np.diff(np.array(smooth)[:, 1], 2)).max() < 0.25 * rough


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("frames", [0.0, 0.5, 30.0])
def test_short_paths_and_any_smoothing_are_fine(count, frames):
    path = [(float(k), 0.0, 0.0) for k in range(count)]
    smooth = smoothed(path, frames)
    assert len(smooth) == count
    assert smooth[0] == pytest.approx(path[0])
    assert smooth[-1] == pytest.approx(path[-1])
    assert np.isfinite(smooth).all()


@pytest.mark.parametrize(
    ("frame_step", "kept"), [(1, [0, 1, 2, 3, 4, 5]), (2, [0, 2, 4, 5]), (5, [0, 5]), (9, [0, 5])]
)
def test_kept_poses_are_every_step_and_the_last(frame_step, kept):
    cutout = grid_cutout(8, 3)
    posing = Posing(
        cutout,
        cutout.rest,
        [pin([9], key=0), pin([17], key=1)],
        {1},
        lambda **_options: solver_cache.poser_for(1, cutout, "hold", cutout.rest),
    )
    path = [(0.0, float(np.float32(0.2 * frame)), 0.0) for frame in range(6)]
    poses = Poses(path, frame_step)
    assert poses.share == 0.0
    for sample in poses.samples:
        posing.move(*sample)
        poses.seen(posing.solved())
    assert poses.share == 1.0
    assert list(poses.by_frame) == kept
    for frame, positions in poses.by_frame.items():
        assert positions[17] == pytest.approx([8.0, 1.0 + 0.2 * frame], abs=5e-3)
    assert np.array_equal(poses.last.positions, poses.by_frame[5])


def test_at_the_end_of_the_range_it_is_over():
    recording = Recording(10)
    assert not recording.over(8.9)
    assert recording.over(9.0)
    assert [recording.frame_at(time) for time in (0.5, 8.9, 9.0, 30.0)] == [0, 8, 9, 9]
    recording.add(30.0, (30.0, 0.0, 0.0))
    assert [du for du, *_ in recording.by_frame(30.0)] == list(range(10))
    assert not Recording().over(1e6)


def test_in_a_loop_each_frame_has_what_was_recorded_there_last():
    recording = Recording(10, loop=True)
    recording.add(100.0, (100.0, 0.0, 0.0))
    assert not recording.over(100.0)
    assert [recording.frame_at(time) for time in (9.9, 10.0, 23.5)] == [9, 0, 3]
    assert [du for du, *_ in recording.by_frame(5.5)] == list(range(6))
    assert [du for du, *_ in recording.by_frame(23.5)] == [20, 21, 22, 23, 14, 15, 16, 17, 18, 19]


def test_pins_that_are_not_dragged_play_what_they_had():
    cutout = grid_cutout(8, 3)
    pins = [pin([0], key=0), pin([8], key=1)]
    shapes = [cutout.rest + np.array([0.0, 0.1 * frame]) for frame in range(5)]
    layer = Layer(lambda frame: shapes[frame])
    make_poser = partial(solver_cache.poser_for, 1, cutout, "hold", cutout.rest)
    posing = Posing(cutout, cutout.rest, pins, {1}, make_poser)
    posing.played = layer
    layer.show(0)
    posing.move(0.0, 0.0, 0.0)
    layer.show(3)
    posing.move(0.0, 0.0, 0.0)  # the mouse rests, the other pin does not
    assert posing.results()[0].target == pytest.approx(shapes[3][0])
    assert posing.results()[1].target == pytest.approx(cutout.rest[8])
    poses = Poses([(0.1 * frame, 0.0, 0.0) for frame in range(5)], 2)
    layer.follow(poses)
    posing.restart()
    places = {}
    for sample in poses.samples:
        posing.move(*sample)
        poses.seen(posing.solved())
        places[len(posing.path)] = [result.target for result in posing.results()]
    assert sorted(poses.by_frame) == [0, 2, 4]
    assert places[len(poses.samples)][0] == pytest.approx(shapes[4][0])
    assert places[len(poses.samples)][1] == pytest.approx(cutout.rest[8] + np.array([0.4, 0.0]))
    assert poses.by_frame[2][0] == pytest.approx(shapes[2][0], abs=0.02)
