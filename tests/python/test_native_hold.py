# SPDX-License-Identifier: GPL-3.0-or-later
"""Method "hold" of the Poser: its minimum against dense algebra, and that no mesh or target makes it flip."""

import contextlib

import native_reference as reference
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import planar_native

HANDLES = np.array([0, 8, 49])
BARYCENTRIC = (np.array([3, 40, 70]), np.array([[0.2, 0.3, 0.5], [1 / 3, 1 / 3, 1 / 3], [0.0, 0.25, 0.75]]))
OFFSETS = np.array([[0.0, 0.0], [0.8, 1.2], [-0.2, -0.5]])
PIN_WEIGHT = 1000.0


def diagonal(points):
    return np.linalg.norm(np.ptp(points, axis=0))


def settled(poser, targets):
    poser.move(targets)
    posed = poser.settle()
    assert poser.report.converged
    return posed


@pytest.mark.parametrize("groups", [None, [0, 1, 1]], ids=["points", "patch"])
@pytest.mark.parametrize("painted", [False, True], ids=["uniform", "painted"])
@pytest.mark.parametrize("handles", [HANDLES, BARYCENTRIC], ids=["vertices", "barycentric"])
def test_settle_finds_the_minimum_of_the_energy(handles, painted, groups):
    rest, triangles = reference.bar()
    pick = reference.picked(handles, triangles, len(rest))
    targets = pick @ rest + OFFSETS
    stiffness = np.geomspace(0.01, 100, len(triangles)) if painted else None
    weights = np.array([1.0, 3.0, 0.5])
    # Handles of one group are one pin: they share its weight.
    strength = PIN_WEIGHT * weights / (1 if groups is None else np.array([1, 2, 2]))
    energy = reference.HoldEnergy(rest, triangles, pick, targets, strength, stiffness)
    minimum = energy.minimum(rest)

    poser = planar_native.Poser(rest, triangles, pin_weight=PIN_WEIGHT, stiffness=stiffness)
    poser.set_handles(handles, weights=weights, groups=groups)
    posed = settled(poser, targets)
    assert energy.value(posed) == pytest.approx(energy.value(minimum), rel=1e-6)
    # settle() ends with a full Newton step below 1e-5 of the diagonal, by a factor up to a few steps old.
    np.testing.assert_allclose(posed, minimum, rtol=0, atol=1e-4 * diagonal(rest))
    # The gradient vanishes beside that of the rest shape with the handles at their targets.
    start = np.linalg.norm(energy.gradient(rest))
    assert np.linalg.norm(energy.gradient(posed)) < 1e-4 * start


def test_the_reference_has_the_gradient_of_its_energy():
    rest, triangles = reference.bar()
    pick = reference.picked(BARYCENTRIC, triangles, len(rest))
    energy = reference.HoldEnergy(rest, triangles, pick, pick @ rest + OFFSETS, PIN_WEIGHT * np.ones(3))
    generator = np.random.default_rng(2)
    posed = rest + generator.normal(0, 0.03, rest.shape)
    way = generator.normal(0, 1e-6, rest.shape)
    change = (energy.value(posed + way) - energy.value(posed - way)) / 2
    assert change == pytest.approx((energy.gradient(posed) * way).sum(), rel=1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.5, 2.0, np.pi])
def test_rigid_targets_give_a_rigid_motion(turn):
    rest, triangles = reference.bar()
    moved = rest @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]] + [3.0, -1.0]
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles(HANDLES)
    path = np.linspace(0, turn, 13)[1:]
    for angle in path:
        turned = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
        poser.move(rest[HANDLES] @ turned + [3.0, -1.0])
    np.testing.assert_allclose(poser.settle(), moved, rtol=0, atol=1e-5 * diagonal(rest))


def test_one_handle_carries_the_rest_shape():
    rest, triangles = reference.bar()
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles([5])
    posed = settled(poser, rest[[5]] + [[20.0, -3.0]])
    np.testing.assert_allclose(posed, rest + np.array([20.0, -3.0]), rtol=0, atol=1e-5 * diagonal(rest))


def test_handles_brought_back_bring_the_rest_shape_back():
    rest, triangles = reference.bar()
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles(HANDLES)
    for angle in np.linspace(0, 2 * np.pi, 25)[1:]:
        poser.move(rest[HANDLES] + [[0, 0], [3 * np.cos(angle) - 3, 3 * np.sin(angle)], [0, 0]])
    np.testing.assert_allclose(poser.settle(), rest, rtol=0, atol=1e-4 * diagonal(rest))


def test_parts_without_a_handle_and_lone_vertices_stay():
    bar, triangles = reference.bar()
    n = len(bar)
    rest = np.concatenate([bar, bar + np.array([30.0, 0.0]), [[-5.0, 2.0]]])
    poser = planar_native.Poser(rest, np.concatenate([triangles, triangles + n]))
    poser.set_handles(HANDLES)
    posed = settled(poser, rest[HANDLES] + OFFSETS)
    np.testing.assert_allclose(posed[n:], rest[n:], rtol=0, atol=1e-9 * diagonal(rest))
    assert np.abs(posed[:n] - rest[:n]).max() > 1.0


def test_orientation_of_triangles_does_not_matter():
    rest, triangles = reference.bar()
    mixed = triangles.copy()
    mixed[::3] = mixed[::3, ::-1]
    poses = []
    for each in (triangles, mixed):
        poser = planar_native.Poser(rest, each)
        poser.set_handles(HANDLES)
        poses.append(settled(poser, rest[HANDLES] + OFFSETS))
        assert poser.report.flipped == 0
    np.testing.assert_allclose(*poses, rtol=0, atol=1e-5 * diagonal(rest))


def test_refine_moves_little_at_a_time_and_ends_where_settle_does():
    rest, triangles = reference.bar()
    targets = rest[HANDLES] + 3 * OFFSETS
    posers = [planar_native.Poser(rest, triangles) for _ in range(2)]
    for poser in posers:
        poser.set_handles(HANDLES)
        poser.move(targets)
    expected = posers[0].settle()
    shape = posers[1].positions
    for _ in range(200):
        refined = posers[1].refine()
        assert np.linalg.norm(refined - shape, axis=1).max() <= 0.02 * diagonal(rest) * (1 + 1e-9)
        shape = refined
        if posers[1].report.converged:
            break
    assert posers[1].report.converged
    np.testing.assert_allclose(shape, expected, rtol=0, atol=1e-4 * diagonal(rest))


@pytest.mark.parametrize("action", ["refine", "settle"])
def test_without_targets_nothing_happens(action):
    rest, triangles = reference.bar()
    shape = rest * [1.1, 0.9]
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles(HANDLES)
    poser.reset(shape)
    np.testing.assert_array_equal(getattr(poser, action)(), shape)


def test_the_report_tells_the_furthest_handle():
    rest, triangles = reference.bar()
    poser = planar_native.Poser(rest, triangles)
    poser.set_handles(HANDLES)
    targets = rest[HANDLES] + [[0, 0], [90.0, 0], [0, 0]]  # out of reach
    for act in (lambda: poser.move(targets), poser.refine, poser.settle):
        posed = act()
        away = np.linalg.norm(posed[HANDLES] - targets, axis=1).max()
        assert poser.report.furthest_handle == pytest.approx(away, rel=1e-12)
        assert poser.report.flipped == 0


def parts_of(triangles):
    """The rows of triangles that hang together by their vertices, part by part."""
    label = np.arange(triangles.max() + 1)
    while True:
        lowest = label[triangles].min(axis=1)
        before = label.copy()
        np.minimum.at(label, triangles, lowest[:, None].repeat(3, axis=1))
        if np.array_equal(label, before):
            return [np.flatnonzero(label[triangles[:, 0]] == part) for part in np.unique(label[triangles])]


def flipped(rest, posed, triangles):
    """Triangles that can be seen at rest and lie the other way round, all rounded to float32.

    Those that cannot are small or thin beside the median one of their part, or in float32.
    """

    def doubled_areas(points):
        a, b, c = (points[triangles[:, i]] for i in range(3))
        return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]

    def rounded(points):
        return points.astype(np.float32).astype(float)

    sides = np.linalg.norm(rest[triangles] - rest[np.roll(triangles, 1, axis=1)], axis=2).max(axis=1)
    area = np.abs(doubled_areas(rest))
    altitude = area / sides
    clear = area > 1e-6 * np.abs(rest[triangles]).max(axis=(1, 2)) * sides
    for part in parts_of(triangles):
        some = part[altitude[part] > np.finfo(np.float32).eps * sides[part]]  # more than rounding errors
        if len(some):
            least = 1.01e-6 * np.sort(area[some])[len(some) // 2]  # a hundredth above the library's
            thinnest = 1.01e-3 * np.sort(altitude[some])[len(some) // 2]
            clear[part] &= (area[part] > least) & (altitude[part] > thinnest)
    before, after = doubled_areas(rounded(rest)), doubled_areas(rounded(posed))
    return int((clear & (np.sign(before) * after < 0)).sum())


@st.composite
def meshes(draw):
    """One to three grids, jittered, squeezed to slivers, with mixed orientations, triangles without area and
    vertices without triangles, in any order and at any scale."""
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    squeeze = draw(st.sampled_from([1.0, 1e-2, 1e-4]))
    vertices, triangles = [], []
    count = 0
    for part in range(draw(st.integers(1, 3))):
        columns, rows = draw(st.integers(1, 6)), draw(st.integers(1, 4))
        points, faces = reference.bar(columns, rows, hole=False)
        jitter = draw(st.sampled_from([0.0, 0.1]))
        points += generator.uniform(-jitter, jitter, points.shape)
        if columns > 1:  # one thin column: slivers
            points[:, 0] -= (1 - squeeze) * (points[:, 0] - points[1, 0]).clip(0, 1)
        vertices.append(points + np.array([10.0 * part, 0.0]))
        triangles.append(faces + count)
        count += len(points)
    vertices.append(generator.uniform(0, 10, (draw(st.integers(0, 2)), 2)))
    vertices, triangles = np.concatenate(vertices), np.concatenate(triangles)
    turned = generator.random(len(triangles)) < draw(st.sampled_from([0.0, 0.5]))
    triangles[turned] = triangles[turned, ::-1]
    if draw(st.booleans()):  # three corners on a line
        vertices[triangles[-1, 0]] = vertices[triangles[-1, 1:]].mean(axis=0)
    if draw(st.booleans()):  # two corners in one place
        vertices[triangles[0, 0]] = vertices[triangles[0, 1]]
    shuffled = generator.permutation(len(vertices))
    place = np.argsort(shuffled)
    scale = draw(st.sampled_from([1.0, 1e-3, 1e4]))
    return scale * vertices[shuffled], place[triangles]


@st.composite
def posings(draw):
    """A mesh, handles of any kind with weights and groups, a stiffness, and the targets of a few moves: near,
    100 diagonals away, in one point, swapped with each other."""
    rest, triangles = draw(meshes())
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(0, 8))
    if draw(st.booleans()):
        handles = generator.integers(0, len(rest), count)
        places = rest[handles]
    else:
        inside = generator.integers(0, len(triangles), count)
        weights = generator.dirichlet([1.0, 1.0, 1.0], count).reshape(count, 3)
        handles = (inside, weights)
        places = (weights[:, :, None] * rest[triangles[inside]]).sum(axis=1)
    size = diagonal(rest)
    path = []
    for kind in draw(st.lists(st.sampled_from(["near", "far", "huge", "one", "swapped"]), max_size=5)):
        reach = {"near": 0.1, "far": 1.0, "huge": 100.0}.get(kind, 0.0) * size
        targets = places + generator.uniform(-reach, reach, places.shape)
        if kind == "one":
            targets[:] = generator.uniform(-size, size, 2)
        if kind == "swapped":
            targets = generator.permutation(targets)
        path.append(targets)
    options = {
        "weights": draw(st.sampled_from([None, 10.0 ** generator.uniform(-2, 2, count)])),
        "groups": draw(st.sampled_from([None, generator.integers(0, 3, count)])),
    }
    stiffness = draw(st.sampled_from([None, 10.0 ** generator.uniform(-2, 2, len(triangles))]))
    return rest, triangles, handles, options, stiffness, path


@settings(max_examples=150, deadline=None)
@given(posings())
def test_no_mesh_and_no_targets_make_it_flip_or_leave_the_finite(posing):
    rest, triangles, handles, options, stiffness, path = posing
    poser = planar_native.Poser(rest, triangles, stiffness=stiffness)
    poser.set_handles(handles, **options)
    for targets in path:
        for act in (lambda to=targets: poser.move(to), poser.refine):
            posed = act()
            assert np.isfinite(posed).all()
            assert flipped(rest, posed, triangles) == 0
            assert poser.report.flipped == 0
            assert np.isfinite(poser.report.furthest_handle)
    posed = poser.settle()
    assert np.isfinite(posed).all()
    assert flipped(rest, posed, triangles) == 0


@settings(max_examples=100, deadline=None)
@given(posings(), st.integers(0, 2**32 - 1))
def test_a_start_with_flips_is_never_made_worse(posing, seed):
    rest, triangles, handles, options, stiffness, path = posing
    generator = np.random.default_rng(seed)
    start = rest + generator.normal(0, 0.2, rest.shape) * diagonal(rest) / np.sqrt(len(rest))
    poser = planar_native.Poser(rest, triangles, stiffness=stiffness)
    poser.set_handles(handles, **options)
    poser.reset(start)
    for targets in path:
        before = poser.report.flipped
        posed = poser.move(targets)
        assert np.isfinite(posed).all()
        assert poser.report.flipped <= before
        assert planar_native.distortion(rest, posed, triangles).flipped == poser.report.flipped


@settings(max_examples=60, deadline=None)
@given(posings())
def test_the_same_calls_give_the_same_bits(posing):
    rest, triangles, handles, options, stiffness, path = posing
    shapes = []
    for _ in range(2):
        poser = planar_native.Poser(rest, triangles, stiffness=stiffness)
        poser.set_handles(handles, **options)
        shapes.append([poser.move(targets) for targets in path] + [poser.refine(), poser.settle()])
    np.testing.assert_array_equal(*shapes)


@pytest.mark.parametrize("size", [1e-300, 1e-30, 1e30, 1e300])
@pytest.mark.parametrize("method", ["hold", "akvf", "arap"])
def test_a_failed_solve_leaves_the_poser_as_it_was(method, size):
    """Lengths whose squares leave the range of numbers: an answer that is finite, or the old state."""
    rest, triangles = reference.bar()
    poser = planar_native.Poser(size * rest, triangles, method=method)
    poser.set_handles(HANDLES)
    for act in (lambda: poser.move(size * (rest[HANDLES] + OFFSETS)), poser.refine, poser.settle):
        before, report = poser.positions, repr(poser.report)
        with contextlib.suppress(planar_native.SolveError):
            assert np.isfinite(act()).all()
            continue
        np.testing.assert_array_equal(poser.positions, before)
        assert repr(poser.report) == report


def test_joints_take_layers_along():
    rest, triangles = reference.bar()
    count = len(rest)
    end, start = int(np.argmax(rest[:, 0])), int(np.argmin(rest[:, 0]))
    both = np.concatenate([rest, rest + rest[end] - rest[start]])
    poser = planar_native.Poser(both, np.concatenate([triangles, triangles + count]))
    poser.set_handles([0, 8])
    moved = rest[[0, 8]] + np.array([0.0, 1.0])
    assert np.array_equal(settled(poser, moved)[count:], both[count:])
    poser.reset()
    inside = (np.array([3, 40]), np.full((2, 3), 1 / 3))
    poser.set_joints([end], [count + start], strength=[2.0])
    np.testing.assert_allclose(settled(poser, moved), both + np.array([0.0, 1.0]), rtol=0, atol=1e-6)
    with pytest.raises(ValueError, match="second, row 0: on the same part"):
        poser.set_joints(inside, inside)
    with pytest.raises(ValueError, match="strength: shape"):
        poser.set_joints([end], [count + start], strength=[1.0, 1.0])
    with pytest.raises(ValueError, match="only method hold"):
        planar_native.Poser(rest, triangles, method="arap").set_joints([0], [1])
