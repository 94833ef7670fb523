# SPDX-License-Identifier: GPL-3.0-or-later
"""Posing and in-betweening dense meshes through a cage, as the module offers it."""

import numpy as np
import pytest

import planar_native

SIDE = 60
PINS = np.array([0, SIDE - 1, SIDE * SIDE - 1])


def dense_square():
    x, y = np.meshgrid(np.linspace(0, 1, SIDE), np.linspace(0, 1, SIDE))
    corner = (np.arange(SIDE - 1) + SIDE * np.arange(SIDE - 1)[:, None]).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + SIDE]),
            np.column_stack([corner + 1, corner + SIDE + 1, corner + SIDE]),
        ]
    )
    return np.column_stack([x.ravel(), y.ravel()]), triangles


@pytest.mark.parametrize("method", ["hold", "akvf", "arap"])
def test_handles_and_positions_are_those_of_the_dense_mesh(method):
    rest, triangles = dense_square()
    poser = planar_native.Poser(rest, triangles, method=method, cage=200)
    poser.set_handles(PINS)
    targets = rest[PINS] + [[0.0, 0.0], [0.1, 0.2], [0.0, 0.1]]
    poser.move(targets)
    posed = poser.settle()
    assert posed.shape == rest.shape
    assert np.abs(posed[PINS] - targets).max() < 2e-3
    assert poser.report.furthest_handle == pytest.approx(np.linalg.norm(posed[PINS] - targets, axis=1).max())


def test_a_pose_stored_as_float32_is_gone_on_from():
    rest, triangles = dense_square()
    poser = planar_native.Poser(rest, triangles, cage=200)
    poser.set_handles(PINS)
    targets = rest[PINS] + [[0.0, 0.0], [0.1, 0.2], [0.0, 0.1]]
    poser.move(targets)
    stored = poser.settle().astype(np.float32)
    poser.reset(stored)
    assert (poser.positions == stored).all()
    assert np.abs(poser.move(targets) - stored).max() < 1e-5


def test_a_settled_mesh_is_at_its_own_minimum_and_is_gone_on_from_without_a_jump():
    rest, triangles = dense_square()
    targets = rest[PINS] + [[0.0, 0.0], [0.1, 0.3], [-0.2, 0.2]]
    posed = []
    for cage in (None, 200):
        poser = planar_native.Poser(rest, triangles, cage=cage)
        poser.set_handles(PINS)
        poser.move(targets)
        while not poser.report.converged and not poser.report.coarse_settled:
            poser.refine()
        assert poser.report.coarse_settled == (cage is not None)
        coarse = poser.positions
        posed.append(poser.settle())
    assert np.abs(coarse - posed[0]).max() > 1e-3
    assert np.abs(posed[1] - posed[0]).max() < 5e-5
    poser.reset(posed[1].astype(np.float32))
    assert np.abs(poser.move(targets) - posed[1]).max() < 1e-4
    targets[1] += 1e-3
    assert np.abs(poser.move(targets) - posed[1]).max() < 1.2e-3


def test_what_takes_long_asks_whether_to_go_on():
    rest, triangles = dense_square()
    poser = planar_native.Poser(rest, triangles, cage=200)
    poser.set_handles(PINS)
    before = poser.move(rest[PINS] + [[0.0, 0.0], [0.1, 0.3], [-0.2, 0.2]])
    with pytest.raises(planar_native.Cancelled):
        poser.settle(progress=lambda share: False)
    with pytest.raises(ValueError, match="progress: returned 'yes'"):
        poser.settle(progress=lambda share: "yes")
    assert (poser.positions == before).all()
    shares = []
    poser.settle(progress=shares.append)
    assert poser.report.converged
    assert 0.0 <= min(shares) <= max(shares) <= 1.0
    with pytest.raises(planar_native.Cancelled):
        planar_native.Poser(rest, triangles, cage=200, progress=lambda share: False)


def test_a_mesh_that_is_small_enough_is_solved_as_it_is():
    rest, triangles = dense_square()
    posed = []
    for cage in (None, len(rest)):
        poser = planar_native.Poser(rest, triangles, cage=cage)
        poser.set_handles(PINS)
        posed.append(poser.move(rest[PINS] + [[0.0, 0.0], [0.1, 0.2], [0.0, 0.1]]))
    assert (posed[0] == posed[1]).all()


def test_inbetweens_give_the_keys_to_the_bit():
    rest, triangles = dense_square()
    bent = np.column_stack([rest[:, 0] + 0.2 * rest[:, 1] ** 2, rest[:, 1]])
    motion = planar_native.Inbetweens([rest, bent], triangles=triangles, cage=200)
    frames = motion.at([0.0, 0.5, 1.0])
    assert (frames[0] == rest).all()
    assert (frames[2] == bent).all()
    dense = planar_native.inbetween([rest, bent], [0.5], triangles=triangles)
    assert np.abs(frames[1] - dense[0]).max() < 5e-3
    assert (planar_native.inbetween([rest, bent], [0.5], triangles=triangles, cage=200) == frames[1]).all()


@pytest.mark.parametrize("cage", [0, 11, -4])
def test_a_cage_of_too_few_vertices_is_refused(cage):
    rest, triangles = dense_square()
    with pytest.raises(ValueError, match="cage: "):
        planar_native.Poser(rest, triangles, cage=cage)
    with pytest.raises(ValueError, match="cage: "):
        planar_native.Inbetweens([rest, rest], triangles=triangles, cage=cage)


def test_edges_and_the_papers_methods_have_no_cage():
    rest, triangles = dense_square()
    with pytest.raises(ValueError, match="cage: edges"):
        planar_native.Inbetweens([rest, rest], edges=triangles[:, :2], cage=200)
    with pytest.raises(ValueError, match="cage: the paper's"):
        planar_native.inbetween([rest, rest], [0.0, 1.0], triangles=triangles, method="paper", cage=200)
