# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is passed in: the documented error that names the argument, or the answer of the plain call; never
a crash, and never a change in what was passed."""

import contextlib
import copy
import warnings

import native_reference as reference
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import planar_native

VERTICES, TRIANGLES = reference.bar(columns=5, rows=3)
N, M = len(VERTICES), len(TRIANGLES)
HANDLES = np.array([0, 5, 20])
BARYCENTRIC = np.array([[0.2, 0.3, 0.5], [1.0, 0.0, 0.0], [0.0, 0.25, 0.75]])
VELOCITIES = np.array([[0.3, -0.1], [0.0, 0.4], [-0.2, 0.2]])
TURNED = VERTICES @ [[0.8, 0.6], [-0.6, 0.8]]


METHODS = ["hold", "akvf", "arap"]


def posed_by(method):
    def pose(rest, triangles, handles, targets, stiffness, weights, groups, positions):
        poser = planar_native.Poser(rest, triangles, method=method, stiffness=stiffness)
        poser.set_handles(handles, weights=weights, groups=groups)
        poser.reset(positions)
        poser.move(targets)
        return poser.refine()

    return pose


# Every function with every array argument it has, and values that are right for them.
CALLS = {
    "killing_field": (
        planar_native.killing_field,
        {
            "vertices": VERTICES,
            "triangles": TRIANGLES,
            "handles": HANDLES,
            "velocities": VELOCITIES,
            "stiffness": np.linspace(1, 2, M),
        },
    ),
    "killing_field in triangles": (
        lambda vertices, triangles, triangle, weights, velocities: planar_native.killing_field(
            vertices, triangles, (triangle, weights), velocities
        ),
        {
            "vertices": VERTICES,
            "triangles": TRIANGLES,
            "triangle": np.array([2, 11, 19]),
            "weights": BARYCENTRIC,
            "velocities": VELOCITIES,
        },
    ),
    "advance_along_spirals": (
        planar_native.advance_along_spirals,
        {"vertices": VERTICES, "triangles": TRIANGLES, "velocities": 0.1 * TURNED},
    ),
    "distortion": (
        lambda rest, posed, triangles: planar_native.distortion(rest, posed, triangles).triangle_area,
        {"rest": VERTICES, "posed": TURNED, "triangles": TRIANGLES},
    ),
    "arap_two_step": (
        lambda rest, triangles, handles, targets: np.stack(
            planar_native.arap_two_step(rest, triangles, handles, targets)
        ),
        {"rest": VERTICES, "triangles": TRIANGLES, "handles": HANDLES, "targets": TURNED[HANDLES] + 0.1},
    ),
    **{
        f"Poser {method}": (
            posed_by(method),
            {
                "rest": VERTICES,
                "triangles": TRIANGLES,
                "handles": HANDLES,
                "targets": TURNED[HANDLES] + 0.1,
                "stiffness": np.linspace(1, 2, M),
                "weights": np.array([1.0, 2.0, 3.0]),
                "groups": np.array([0, 1, 1]),
                "positions": TURNED,
            },
        )
        for method in METHODS
    },
}
ARGUMENTS = [(call, name) for call, (_, values) in CALLS.items() for name in values]
# What the error calls an argument, where that is not the argument's own name.
SHOWN = {"triangle": "handles", "weights": "(barycentric|weights)"}
INTEGER = {"triangles", "triangle", "handles", "groups"}
OPTIONAL = {"stiffness", "weights", "groups", "positions"}
every_argument = pytest.mark.parametrize(("call", "name"), ARGUMENTS)


def call_with(call, **changed):
    """The result with these arguments changed; nothing that is passed may change."""
    function, values = CALLS[call]
    values = {**values, **changed}
    before = {name: value.copy() for name, value in values.items() if isinstance(value, np.ndarray)}
    try:
        return function(**values)
    finally:
        for name, value in before.items():
            np.testing.assert_array_equal(values[name], value)


def refused(call, name, value):
    with pytest.raises(ValueError, match=f"^{SHOWN.get(name, name)}\\b") as caught:
        call_with(call, **{name: value})
    return str(caught.value)


def strided(array):
    """The same numbers, every third one of a larger array."""
    wide = np.zeros((*array.shape[:-1], 3 * array.shape[-1]), array.dtype)
    wide[..., ::3] = array
    return wide[..., ::3]


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def unaligned(array):
    raw = np.empty(array.nbytes + 1, np.uint8)
    view = raw[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


LAYOUTS = {
    "Fortran order": np.asfortranarray,
    "strided": strided,
    "reversed": lambda array: array[::-1].copy()[::-1],
    "read-only": read_only,
    "swapped bytes": lambda array: array.astype(array.dtype.newbyteorder()),
    "unaligned": unaligned,
    "list": lambda array: array.tolist(),
    "subclass": lambda array: array.view(type("Subclass", (np.ndarray,), {})),
    "masked": np.ma.masked_array,
}


@every_argument
@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_bits(call, name, layout):
    plain = call_with(call)
    value = LAYOUTS[layout](CALLS[call][1][name])
    np.testing.assert_array_equal(call_with(call, **{name: value}), plain)


@every_argument
@pytest.mark.parametrize("kind", ["f2", "f4", "g", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_real_and_integer_dtypes_are_converted(call, name, kind):
    if name in INTEGER and np.dtype(kind).kind == "f":
        refused(call, name, CALLS[call][1][name].astype(kind))
        return
    values = CALLS[call][1][name]
    if np.dtype(kind).kind in "iu" and name not in INTEGER:
        if name == "weights" and values.ndim == 2:
            values = np.eye(3)  # barycentric
        else:
            values = np.arange(1, values.size + 1).reshape(values.shape) ** 2 % 101
    value = values.astype(kind)
    wide = value.astype(np.int64 if name in INTEGER else float)
    # float16 positions can make a bad mesh: then both calls must fail alike.
    outcomes = []
    for each in (value, wide):
        try:
            outcomes.append(call_with(call, **{name: each}))
        except (ValueError, planar_native.SolveError) as error:
            outcomes.append(np.array(str(error)))
    np.testing.assert_array_equal(*outcomes)


BAD_DTYPES = {
    "complex": lambda array: array.astype(complex),
    "bool": lambda array: array.astype(bool),
    "object": lambda array: array.astype(object),
    "strings": lambda array: array.astype(str),
    "bytes": lambda array: array.astype("S8"),
    "dates": lambda array: array.astype(int).astype("M8[s]"),
    "record": lambda array: np.zeros(array.shape, [("x", float)]),
    "text": lambda array: "not an array",
    "number": lambda array: 1.5,
    "dict": lambda array: {"x": 1},
    "nested objects": lambda array: [[object()]],
}


@every_argument
@pytest.mark.parametrize("kind", BAD_DTYPES)
def test_other_dtypes_are_refused(call, name, kind):
    refused(call, name, BAD_DTYPES[kind](CALLS[call][1][name]))


@every_argument
def test_none_is_refused_unless_it_is_the_default(call, name):
    if name in OPTIONAL and (call == "killing_field" or call.startswith("Poser")):
        call_with(call, **{name: None})
    else:
        refused(call, name, None)


@every_argument
def test_ragged_lists_are_refused(call, name):
    refused(call, name, [[1, 2], [3]])


@every_argument
def test_wrong_shapes_are_refused(call, name):
    value = CALLS[call][1][name]
    shapes = [value[None], value.ravel()[0], value[..., None], np.zeros((0, 7), value.dtype)]
    if value.ndim == 2:
        shapes += [value.ravel(), value[:, :-1], np.hstack([value, value])]
    for wrong in shapes:
        assert "shape" in refused(call, name, wrong)


@every_argument
def test_wrong_lengths_are_refused(call, name):
    value = CALLS[call][1][name]
    if name in ("vertices", "rest", "handles", "triangles", "triangle"):
        return  # these decide how long the others must be
    for wrong in (value[:-1], np.concatenate([value, value[:1]]), value[:0]):
        assert f"expected {len(value)}" in refused(call, name, wrong).replace("(", "")


@every_argument
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_not_finite_names_the_row(call, name, bad):
    value = CALLS[call][1][name]
    if name in INTEGER:
        return
    wrong = value.copy()
    wrong[2] = bad
    assert "row 2" in refused(call, name, wrong)


@every_argument
@pytest.mark.parametrize("bad", [-1, 10**6, 2**31, 2**32, 2**63 - 1, -(2**63)])
def test_index_out_of_range_names_the_row(call, name, bad):
    value = CALLS[call][1][name]
    if name not in INTEGER or (name == "groups" and abs(bad) < 2**31):
        return  # a group is any label
    wrong = value.astype(np.int64)
    wrong[2] = bad
    assert "row 2" in refused(call, name, wrong)
    if bad == 2**63 - 1:
        wrong = value.astype(np.uint64)
        wrong[2] = 2**64 - 1
        assert "row 2" in refused(call, name, wrong)


@pytest.mark.skipif(
    np.finfo("g").max == np.finfo(float).max,
    reason="no float here is wider than double (Windows, Apple's arm64)",
)
def test_float32_overflow_of_wider_floats_is_not_finite():
    wrong = VERTICES.astype("g")
    wrong[1] = np.finfo("g").max
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert "row 1" in refused("distortion", "rest", wrong)


def test_more_rows_than_indices_can_count_are_refused():
    huge = np.broadcast_to(0.5, (2**31, 2))  # takes no memory
    with pytest.raises(ValueError, match="^rest: 2147483648 rows"):
        planar_native.distortion(huge, huge, TRIANGLES)
    with pytest.raises(ValueError, match="^handles: 2147483648 rows"):
        planar_native.killing_field(VERTICES, TRIANGLES, np.broadcast_to(0, 2**31), VELOCITIES)


def test_empty_meshes_are_refused():
    empty = np.zeros((0, 2))
    with pytest.raises(ValueError, match="^rest is empty"):
        planar_native.Poser(empty, np.zeros((0, 3), int))
    with pytest.raises(ValueError, match="^triangles is empty"):
        planar_native.Poser(VERTICES, np.zeros((0, 3), int))
    with pytest.raises(ValueError, match="^vertices is empty"):
        planar_native.killing_field(empty, np.zeros((0, 3), int), np.zeros(0, int), empty)


@pytest.mark.parametrize("wrong", [(0, 5), (HANDLES,), (HANDLES, BARYCENTRIC, HANDLES), ()])
def test_a_tuple_that_is_no_pair_is_refused(wrong):
    refused("killing_field", "handles", wrong)


@pytest.mark.parametrize(
    "weights", [[0.5, 0.6, 0.5], [1.5, -0.5, 0.0], [0.0, 0.0, 0.0]], ids=["sum", "negative", "zero"]
)
def test_weights_that_are_not_barycentric_are_refused(weights):
    wrong = BARYCENTRIC.copy()
    wrong[1] = weights
    with pytest.raises(ValueError, match=r"row 1\b"):
        call_with("killing_field in triangles", weights=wrong)


@pytest.mark.parametrize("call", [f"Poser {method}" for method in METHODS])
@pytest.mark.parametrize("option", ["stiffness", "weights"])
@pytest.mark.parametrize("bad", [0.0, -1.0])
def test_factors_must_be_positive(call, option, bad):
    wrong = CALLS[call][1][option].copy()
    wrong[1] = bad
    assert "row 1" in refused(call, option, wrong)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_pin_weight_must_be_positive_and_finite(bad):
    with pytest.raises(ValueError, match="pin_weight"):
        planar_native.killing_field(VERTICES, TRIANGLES, HANDLES, VELOCITIES, pin_weight=bad)
    with pytest.raises(ValueError, match="pin_weight"):
        planar_native.Poser(VERTICES, TRIANGLES, pin_weight=bad)


@pytest.mark.parametrize(
    "option", [{"hard": 1}, {"dirichlet": None}, {"pin_weight": "1"}, {"pin_weight": 1j}, {"x": 1}]
)
def test_options_of_the_wrong_type_are_refused(option):
    with pytest.raises(TypeError):
        planar_native.killing_field(VERTICES, TRIANGLES, HANDLES, VELOCITIES, **option)


@pytest.mark.parametrize("method", ["ARAP", "", "AKVF"])
def test_unknown_methods_are_refused_and_the_known_named(method):
    with pytest.raises(ValueError, match="method.*'hold'.*'akvf'.*'arap'"):
        planar_native.Poser(VERTICES, TRIANGLES, method=method)


@pytest.mark.parametrize(
    "use",
    [
        lambda p: p.move(VELOCITIES),
        lambda p: p.refine(),
        lambda p: p.settle(),
        lambda p: p.positions,
        lambda p: p.set_handles([0]),
    ],
)
def test_a_poser_that_was_not_initialised_refuses(use):
    with pytest.raises(RuntimeError):
        use(planar_native.Poser.__new__(planar_native.Poser))


def test_a_poser_cannot_be_copied():
    with pytest.raises(TypeError):
        copy.copy(planar_native.Poser(VERTICES, TRIANGLES, method="akvf"))


def test_errors_of_foreign_code_pass_through():
    class Hostile:
        def __array__(self, *args, **kwargs):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        planar_native.distortion(Hostile(), VERTICES, TRIANGLES)


# A refused call, and the argument that its error names.
FAILURES = {
    "move": ("targets", lambda poser: poser.move(np.full((3, 2), np.nan))),
    "move of another count": ("targets", lambda poser: poser.move(np.zeros((2, 2)))),
    "set_handles": ("handles", lambda poser: poser.set_handles([0, 1, 10**6])),
    "weights": ("weights", lambda poser: poser.set_handles([0, 1], weights=[1.0, -1.0])),
    "groups": ("groups", lambda poser: poser.set_handles([0, 1], groups=[0])),
    "reset": ("positions", lambda poser: poser.reset(np.full((N, 2), np.inf))),
    "reset of another count": ("positions", lambda poser: poser.reset(VERTICES[:-1])),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("failure", FAILURES)
def test_a_refused_call_leaves_the_poser_as_it_was(failure, method):
    def drag(poser):
        first = poser.move(VERTICES[HANDLES] + VELOCITIES)
        yield first
        yield poser.move(VERTICES[HANDLES] + 2 * VELOCITIES)
        yield poser.refine()
        yield poser.settle()

    named, refused_call = FAILURES[failure]
    plain = planar_native.Poser(VERTICES, TRIANGLES, method=method)
    troubled = planar_native.Poser(VERTICES, TRIANGLES, method=method)
    for poser in (plain, troubled):
        poser.set_handles(HANDLES)
    for expected, got in zip(drag(plain), drag(troubled), strict=True):
        np.testing.assert_array_equal(got, expected)
        report = repr(troubled.report)
        with pytest.raises(ValueError, match=f"^{named}\\b"):
            refused_call(troubled)
        np.testing.assert_array_equal(troubled.positions, expected)
        assert repr(troubled.report) == report


anything = st.one_of(
    arrays.arrays(
        dtype=st.one_of(arrays.floating_dtypes(), arrays.integer_dtypes(), arrays.unsigned_integer_dtypes()),
        shape=arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6),
    ),
    arrays.arrays(dtype=arrays.scalar_dtypes(), shape=arrays.array_shapes(min_side=0, max_side=4)),
    st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(), st.lists, max_leaves=8),
)


@settings(max_examples=400, deadline=None)
@given(where=st.sampled_from(ARGUMENTS), value=anything)
def test_anything_gives_an_answer_or_a_documented_error(where, value):
    call, name = where
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # NumPy's own, about overflow in a cast
        with contextlib.suppress(ValueError, planar_native.SolveError):
            call_with(call, **{name: value})


@settings(max_examples=150, deadline=None)
@given(
    vertices=arrays.arrays(float, (6, 2), elements=st.floats(-1e12, 1e12)),
    triangles=arrays.arrays(int, (4, 3), elements=st.integers(0, 5)),
    handles=arrays.arrays(int, st.integers(0, 4), elements=st.integers(0, 5)),
    shift=st.floats(-1e6, 1e6),
    hard=st.booleans(),
    method=st.sampled_from(METHODS),
)
def test_wild_meshes_give_finite_numbers_or_a_documented_error(
    vertices, triangles, handles, shift, hard, method
):
    """Triangles that repeat a corner, overlap or have no area, coinciding vertices, all scales."""
    targets = vertices[handles] + shift
    velocities = np.full(targets.shape, shift)
    with contextlib.suppress(ValueError, planar_native.SolveError):
        field = planar_native.killing_field(vertices, triangles, handles, velocities, hard=hard)
        assert np.isfinite(field).all()
        poser = planar_native.Poser(vertices, triangles, method=method)
        poser.set_handles(handles)
        assert np.isfinite(poser.move(targets)).all()
        assert np.isfinite(poser.refine()).all()
        assert np.isfinite(poser.settle()).all()
