# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins that follow something baked frame by frame: to keyed poses, or to a point cache.

Each bake is a generator, as in bake.py.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import replace

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.plane.frame import Array, Array32
from ...model.posing import solving
from ...model.posing.pins import Holder
from ...model.posing.posing import start_of, start_scale_of
from ..lattice.posed import PosedObject, read_posed
from ..lattice.posed_lattice import PosedLattice
from ..objects.cutout_object import CutoutObject
from ..pins import followed_mesh, pin_list
from ..sequence import playback, pose_edit
from ..storage import points
from ..storage.vertex_groups import Members
from . import bake, live, point_cache
from .to_controls import at_frame, followed, look_at_carriers

SAME_LENGTHS = 1e-6  # of a length squared

FORMS = (
    ("POSES", "Poses", "A keyed pose for each frame, evenly blended, which can be changed"),
    ("POINT_CACHE", "Point Cache", "A .pc2 file that a Mesh Cache modifier plays, for long shots"),
)


def to_poses(obj: bpy.types.Object, frames: range) -> Generator[float, None, None]:
    """Key a pose for each of these frames, evenly blended to the next one; what was keyed between them goes.

    Pins that follow nothing stand where they were before the first one. What the others follow is where the
    frames have it as seen from the object itself, which may move; what a lattice deforms is in each frame as
    it reaches the modifiers then, and each frame is solved from the one before it. Live goes off. Yields the
    share done; closed before its end, everything is as it was. Raises Refusal and ObjectGone.
    """
    drawing, shapes = read_posed(obj, unkeyed=True), {}
    rest = drawing.rest_coordinates()
    for frame, shape in zip(frames, _shapes(drawing, frames), strict=True):
        shapes[float(frame)] = shape
        yield 0.9 * len(shapes) / len(frames)
    obj = drawing.resolve()
    find = playback.finder(obj)  # keyed, it is stored in another way
    for share in pose_edit.put_coordinates(obj, shapes, rest, throughout=True):
        yield 0.9 + 0.1 * share
    bake.blend_evenly(find(), frames)
    find().planar.live = False  # it would show something else than what is keyed


def to_point_cache(
    obj: bpy.types.Object, frames: range, filepath: str, *, replace: bool = False
) -> Generator[float, None, None]:
    """Write the same shapes to a .pc2 file that a Mesh Cache modifier plays; the drawing stays as it is.

    `replace`: as in bake.py. Live goes off. Raises Refusal and ObjectGone.
    """
    if obj.type != "MESH":
        raise Refusal(f"'{obj.name}' is not a mesh: bake its pins to Poses")
    path = point_cache.checked_path(obj, filepath, replace=replace)
    drawing = read_posed(obj, unkeyed=True)
    with point_cache.written(path, points.count(obj), frames) as file:
        for done, shape in enumerate(_shapes(drawing, frames), 1):
            file.write(point_cache.packed(shape))
            yield done / len(frames)
    obj = drawing.resolve()
    point_cache.play(obj, path, frames)
    obj.planar.cache_stamp = ""  # it is not what the poses show
    obj.planar.live = False


def _shapes(drawing: PosedObject, frames: range) -> Iterator[Array32]:
    """The shapes of frames; the scene is at its own frame again in the end. Raises Refusal and ObjectGone."""
    scene, now = bpy.context.scene, bpy.context.scene.frame_current_final
    steps = _of_drawing(drawing) if isinstance(drawing, CutoutObject) else _of_lattice(drawing)
    next(steps)
    try:
        with live.paused():
            for frame in frames:
                scene.frame_set(frame)
                solving.halt()
                yield steps.send(frame)
    except native.SolveError as error:
        raise Refusal(str(error)) from error
    finally:
        followed_mesh.evaluated()
        scene.frame_set(int(now), subframe=now - int(now))


Steps = Generator[Array32, float, None]  # is sent the frame that the scene is at, yields its shape


def _of_drawing(drawing: CutoutObject) -> Steps:
    """What Live shows."""
    read_at = np.array(drawing.resolve().matrix_world, np.float64)
    shape = drawing.rest_coordinates()
    while True:
        frame = yield shape
        obj, depsgraph = drawing.resolve(), bpy.context.evaluated_depsgraph_get()
        look_at_carriers(obj, frame, depsgraph)
        matrix = np.array(obj.matrix_world, np.float64)
        if not _is_rigid(matrix @ np.linalg.inv(read_at)):  # other lengths make another drawing of it
            drawing, read_at = drawing.carried(obj), matrix
        posing, keyed = at_frame(obj, drawing, frame, depsgraph, read_at)
        shape = drawing.coordinates(posing.positions) if keyed is None else keyed


def _is_rigid(motion: Array) -> bool:
    """Whether a map of space (4 x 4) leaves all lengths as they are."""
    linear = motion[:3, :3]
    return bool(np.abs(linear.T @ linear - np.eye(3)).max() <= SAME_LENGTHS)


def _of_lattice(drawing: PosedObject) -> Steps:
    """Each from the one before it."""
    obj = drawing.resolve()
    groups, positions = pin_list.read_groups(obj), drawing.positions
    asked = _asked(drawing, pin_list.bound_pins(obj, drawing, groups))
    shape = drawing.coordinates(positions)
    while True:
        frame = yield shape
        obj = drawing.resolve()
        drawing, read_at = _read_at(obj, frame), np.array(obj.matrix_world, np.float64)
        holders, positions = _holding(obj, drawing, groups, asked), drawing.flattened(shape)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        look_at_carriers(obj, frame, depsgraph)
        posing = followed(obj, drawing, holders, positions, depsgraph, read_at)
        posing.run()
        shape = drawing.coordinates(posing.positions)


# By the key of a pin: where in the object's space, and its angle and scale.
Asked = dict[int, tuple[Array, float, float]]


def _asked(drawing: PosedObject, holders: Iterable[Holder]) -> Asked:
    """Where pins are to stand, and how they are turned and scaled."""
    asked = {}
    for holder in holders:
        place, angle = start_of(holder, drawing.positions)
        asked[holder.pin.key] = (
            drawing.to_local(place[None, :], np.array([holder.part], np.int32))[0],
            angle,
            start_scale_of(holder, drawing.positions),
        )
    return asked


def _holding(
    obj: bpy.types.Object,
    drawing: PosedObject,
    groups: Mapping[int, Mapping[str, Members]],
    asked: Asked,
) -> list[Holder]:
    """The usable pins of an object, which stand where they were asked to."""
    holders = []
    for holder in pin_list.bound_pins(obj, drawing, groups):
        if holder.pin.key in asked:
            place, angle, scale = asked[holder.pin.key]
            target = drawing.from_local(place[None, :])[0]
            pin = replace(holder.pin, target=target, angle=angle, scale=scale)
            holder = holder.holding(pin, drawing.cutout)
        holders.append(holder)
    return holders


def _read_at(obj: bpy.types.Object, frame: float) -> PosedLattice:
    """What a lattice deforms at the present frame. Raises Refusal."""
    try:
        drawing = read_posed(obj, unkeyed=True)
    except Refusal as refusal:
        raise Refusal(f"At frame {frame:g}: {refusal}") from refusal
    assert isinstance(drawing, PosedLattice)
    return drawing
