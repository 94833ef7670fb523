# SPDX-License-Identifier: GPL-3.0-or-later
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, final

from numpy import bool_, float32, float64, int32
from numpy.typing import ArrayLike, NDArray

_Handles = ArrayLike | tuple[ArrayLike, ArrayLike]

class SolveError(RuntimeError): ...
class Cancelled(RuntimeError): ...  # noqa: N818

@final
class Distortion:
    @property
    def area(self) -> float: ...
    @property
    def angle(self) -> float: ...
    @property
    def flipped(self) -> int: ...
    @property
    def triangle_area(self) -> NDArray[float64]: ...
    @property
    def triangle_angle(self) -> NDArray[float64]: ...
    @property
    def triangle_flipped(self) -> NDArray[bool_]: ...

@final
class Report:
    @property
    def iterations(self) -> int: ...
    @property
    def substeps(self) -> int: ...
    @property
    def furthest_handle(self) -> float: ...
    @property
    def flipped(self) -> int: ...
    @property
    def converged(self) -> bool: ...
    @property
    def coarse_settled(self) -> bool: ...

def killing_field(
    vertices: ArrayLike,
    triangles: ArrayLike,
    handles: _Handles,
    velocities: ArrayLike,
    *,
    pin_weight: float = 1.0,
    hard: bool = False,
    dirichlet: bool = True,
    stiffness: ArrayLike | None = None,
) -> NDArray[float64]: ...
def advance_along_spirals(
    vertices: ArrayLike, triangles: ArrayLike, velocities: ArrayLike
) -> NDArray[float64]: ...
def arap_two_step(
    rest: ArrayLike,
    triangles: ArrayLike,
    handles: _Handles,
    targets: ArrayLike,
    *,
    handle_weight: float = 1000.0,
    weights: Literal["cotangent", "uniform"] = "cotangent",
) -> tuple[NDArray[float64], NDArray[float64]]: ...
def distortion(rest: ArrayLike, posed: ArrayLike, triangles: ArrayLike) -> Distortion: ...

class Poser:
    def __init__(
        self,
        rest: ArrayLike,
        triangles: ArrayLike,
        *,
        method: Literal["hold", "akvf", "arap"] = "hold",
        pin_weight: float | None = None,
        stiffness: ArrayLike | None = None,
        cage: int | None = None,
        progress: Callable[[float], bool | None] | None = None,
    ) -> None: ...
    def set_handles(
        self, handles: _Handles, *, weights: ArrayLike | None = None, groups: ArrayLike | None = None
    ) -> None: ...
    def set_joints(self, first: _Handles, second: _Handles, *, strength: ArrayLike | None = None) -> None: ...
    def move(self, targets: ArrayLike) -> NDArray[float64]: ...
    def refine(self, *, progress: Callable[[float], bool | None] | None = None) -> NDArray[float64]: ...
    def settle(self, *, progress: Callable[[float], bool | None] | None = None) -> NDArray[float64]: ...
    def reset(self, positions: ArrayLike | None = None) -> None: ...
    @property
    def positions(self) -> NDArray[float64]: ...
    @property
    def report(self) -> Report: ...

def inbetween(
    keys: ArrayLike,
    times: ArrayLike,
    *,
    triangles: ArrayLike | None = None,
    edges: ArrayLike | None = None,
    key_times: ArrayLike | None = None,
    rest: ArrayLike | None = None,
    turns: ArrayLike | None = None,
    method: Literal["midpoint", "paper", "global"] = "midpoint",
    anchor: ArrayLike | Sequence[ArrayLike | None] | None = None,
    anchor_path: Literal["straight", "arc"] = "straight",
    joints: Sequence[ArrayLike | None] | None = None,
    pins: _Handles | None = None,
    pin_groups: ArrayLike | None = None,
    pinned: ArrayLike | None = None,
    pin_paths: ArrayLike | None = None,
    smooth: bool = False,
    cage: int | None = None,
    tolerance: float = 5e-4,
    max_iterations: int = 100,
    threads: int = 0,
    progress: Callable[[float], bool | None] | None = None,
) -> NDArray[float64]: ...

class TransitionReport:
    @property
    def iterations(self) -> int: ...
    @property
    def converged(self) -> bool: ...
    @property
    def unrepaired(self) -> list[int]: ...

class Inbetweens:
    def __init__(
        self,
        keys: ArrayLike,
        *,
        triangles: ArrayLike | None = None,
        edges: ArrayLike | None = None,
        key_times: ArrayLike | None = None,
        rest: ArrayLike | None = None,
        turns: ArrayLike | None = None,
        anchor: ArrayLike | Sequence[ArrayLike | None] | None = None,
        anchor_path: Literal["straight", "arc"] = "straight",
        joints: Sequence[ArrayLike | None] | None = None,
        pins: _Handles | None = None,
        pin_groups: ArrayLike | None = None,
        pinned: ArrayLike | None = None,
        smooth: bool = False,
        cage: int | None = None,
        tolerance: float = 5e-4,
        max_iterations: int = 100,
        threads: int = 0,
        progress: Callable[[float], bool | None] | None = None,
    ) -> None: ...
    def at(
        self, times: ArrayLike, *, overshoot: bool = False, pin_paths: ArrayLike | None = None
    ) -> NDArray[float64]: ...
    @property
    def report(self) -> list[TransitionReport]: ...

def transfer_motion(
    frames: ArrayLike,
    shape: ArrayLike,
    *,
    triangles: ArrayLike | None = None,
    edges: ArrayLike | None = None,
) -> NDArray[float64]: ...
def edit_sequence(
    frames: ArrayLike,
    edits: Mapping[int, ArrayLike],
    *,
    triangles: ArrayLike | None = None,
    edges: ArrayLike | None = None,
) -> NDArray[float64]: ...

_Basis = Literal["BERNSTEIN", "LINEAR", "CARDINAL", "CATMULL_ROM", "BSPLINE"]
_Weights = tuple[ArrayLike, ArrayLike, ArrayLike]

def lattice_weights(
    points: ArrayLike,
    counts: Sequence[int],
    kinds: Sequence[_Basis],
    *,
    origin: ArrayLike,
    spacing: ArrayLike,
) -> tuple[NDArray[int32], NDArray[int32], NDArray[float64]]: ...

@final
class LatticeReport:
    @property
    def iterations(self) -> int: ...
    @property
    def furthest_handle(self) -> float: ...
    @property
    def handle_distance(self) -> NDArray[float64]: ...
    @property
    def unreached(self) -> list[int]: ...
    @property
    def flipped(self) -> int: ...
    @property
    def converged(self) -> bool: ...

class LatticeSolver:
    def __init__(
        self,
        rest: ArrayLike,
        elements: ArrayLike,
        weights: _Weights,
        lattice_rest: ArrayLike,
        *,
        method: Literal["hold", "paper"] | None = None,
        rigid_following: bool = True,
        edge_weights: Literal["area", "uniform"] = "area",
        weight_shape: float = 1.0,
        weight_mesh: float | None = None,
        weight_lattice: float | None = None,
        weight_rest: float | None = None,
    ) -> None: ...
    def set_handles(
        self,
        vertices: _Handles | None = None,
        lattice_points: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        locked: ArrayLike | None = None,
    ) -> None: ...
    def solve(
        self, vertex_targets: ArrayLike | None = None, lattice_targets: ArrayLike | None = None
    ) -> NDArray[float64]: ...
    def refine(self) -> NDArray[float64]: ...
    def settle(self) -> NDArray[float64]: ...
    def reset(self, points: ArrayLike | None = None) -> None: ...
    @property
    def points(self) -> NDArray[float64]: ...
    @property
    def positions(self) -> NDArray[float64]: ...
    @property
    def report(self) -> LatticeReport: ...

_Line = tuple[ArrayLike, ArrayLike, ArrayLike]

def flatten(
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    method: Literal["hold", "two_step"] = "hold",
    iterations: int = 0,
    weights: Literal["cotangent", "uniform"] = "cotangent",
    fixed: ArrayLike | None = None,
    progress: Callable[[float], bool | None] | None = None,
) -> NDArray[float64]: ...

class Flattener:
    def __init__(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        method: Literal["hold", "two_step"] = "hold",
        iterations: int = 0,
        weights: Literal["cotangent", "uniform"] = "cotangent",
        fixed: ArrayLike | None = None,
        pin_weight: float | None = None,
        progress: Callable[[float], bool | None] | None = None,
    ) -> None: ...
    def set_pins(
        self, handles: _Handles, *, weights: ArrayLike | None = None, lines: Sequence[_Line] = ()
    ) -> None: ...
    def fitted_line(
        self, vertices: ArrayLike
    ) -> tuple[NDArray[int32], NDArray[float64], NDArray[float64]]: ...
    def move(self, targets: ArrayLike) -> NDArray[float64]: ...
    def refine(self) -> NDArray[float64]: ...
    def settle(self) -> NDArray[float64]: ...
    def reset(self) -> None: ...
    @property
    def positions(self) -> NDArray[float64]: ...
    @property
    def report(self) -> Report: ...

@final
class Harmonic:
    def __init__(self, rest: ArrayLike, triangles: ArrayLike, held: ArrayLike) -> None: ...
    def spread(self, values: ArrayLike) -> NDArray[float64]: ...

@final
class Outline:
    @property
    def rings(self) -> list[NDArray[float64]]: ...
    @property
    def edge(self) -> float: ...
    @property
    def margin(self) -> float: ...
    @property
    def rounding(self) -> float: ...
    @property
    def sample(self) -> float: ...
    @property
    def islands(self) -> int: ...
    @property
    def holes(self) -> int: ...
    @property
    def dropped_islands(self) -> int: ...
    @property
    def dropped_pixels(self) -> int: ...
    @property
    def filled_holes(self) -> int: ...

@final
class Cutout:
    @property
    def points(self) -> NDArray[float64]: ...
    @property
    def triangles(self) -> NDArray[int32]: ...
    @property
    def parts(self) -> NDArray[int32]: ...
    @property
    def n_parts(self) -> int: ...
    @property
    def rings(self) -> list[NDArray[int32]]: ...
    @property
    def outline(self) -> Outline: ...
    @property
    def edge(self) -> float: ...
    @property
    def shortest(self) -> float: ...
    @property
    def reached(self) -> bool: ...
    @property
    def said(self) -> list[str]: ...

@final
class Keyed:
    @property
    def alpha(self) -> NDArray[float32]: ...
    @property
    def keyed(self) -> bool: ...
    @property
    def colour(self) -> list[float]: ...
    @property
    def said(self) -> str: ...

def cutout(
    alpha: ArrayLike,
    *,
    vertices: int = 1500,
    edge: float | None = None,
    margin: float | None = None,
    rounding: float | None = None,
    threshold: float = 0.05,
    holes: Literal["KEEP", "FILL"] = "KEEP",
    smallest: float | None = None,
    finest: float = 6.0,
    progress: Callable[[float], bool | None] | None = None,
) -> Cutout: ...
def outline(
    alpha: ArrayLike,
    *,
    vertices: int = 1500,
    edge: float | None = None,
    margin: float | None = None,
    rounding: float | None = None,
    threshold: float = 0.05,
    holes: Literal["KEEP", "FILL"] = "KEEP",
    smallest: float | None = None,
    finest: float = 6.0,
    progress: Callable[[float], bool | None] | None = None,
) -> Outline: ...
def key_colour(pixels: ArrayLike, *, tolerance: float = 24.0 / 255.0) -> Keyed: ...
def build_info() -> dict[str, Any]: ...
