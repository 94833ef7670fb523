# SPDX-License-Identifier: GPL-3.0-or-later
"""Another mesh of the same drawing for a cutout, with all that the old one had.

Whatever belongs to vertices is carried by their places at rest: shapes, poses and in-betweens, weights,
attributes. Data-blocks stay the same ones, so that names, curves, modifiers and what points to them stay.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ... import native
from ...errors import Refusal
from ...model.image.filling import Filling, clockwise
from ...model.image.reaching import reaching
from ...model.plane.carrying import Carrying
from ...model.plane.charts import charts_of, corner_carrying
from ...model.plane.cutout import NEUTRAL, Cutout, connected_parts, make_cutout, signed_areas
from ...model.plane.frame import Array, Array32
from ...model.posing import joints
from ...model.posing.carried_pins import group_carried, nearest_binding, nearest_binding_at, patch_carried
from ...model.posing.depths import depth_of, spread
from ...model.posing.pins import Holder, Kind, Pin
from ...model.posing.rebinding import Binding
from ...model.posing.upright import set_right, turned_over
from ...model.work import Progress
from ..objects import attributes, mesh_edits, new_faces, rest_shape, stiffness
from ..objects.attributes import Attribute
from ..objects.cutout_object import SAME_PLACE
from ..objects.flat_object import linear_of
from ..objects.modifiers import lattices_of
from ..objects.new_faces import NewFaces, face_of_corners, face_settings
from ..pins import lattice_places, pin_list, places
from ..sequence import pose_blocks, pose_state, up_to_date
from ..sequence.stretches import Stamps
from ..storage import changes, points
from ..storage.vertex_groups import Members, members
from .remesh_source import Present, Source

SOLVED = 0.5  # of the progress, where the new mesh is made
MOST_TOLD = 4  # names
ROUNDING = 1e-5  # of the largest depth


@dataclass(frozen=True)
class HeldBefore:
    """A pin of the object, or of a lattice that deforms it, on the old mesh."""

    owner: str  # the object whose pin it is
    name: str
    group: str
    holder: Holder
    owns_group: bool
    stays: bool  # where the last posing left it, so that its target counts
    hinged: tuple[int, int] | None = None  # the parts that it holds together, if it is a hinge

    def pin_of(self, obj: bpy.types.Object) -> bpy.types.PropertyGroup:
        """The pin of the object, whose it is."""
        return obj.planar.pins[self.holder.pin.key]


@dataclass(frozen=True)
class Carried:
    """All that is to be written."""

    rest: Array32  # k x 3
    stored: Array32 | None  # k x 3, the rest that the mesh holds, if it does
    own: Array32  # k x 3, the mesh's own coordinates
    blocks: dict[str, Array32]  # by the names of shape keys
    faces: NewFaces
    attributes: list[tuple[Attribute, Array]]
    pins: list[Binding | None]  # None: its group says it, which has been carried as all groups are
    cutout: Cutout
    said: tuple[str, ...]


class Remesh:
    """A cutout read, solved and written again."""

    def __init__(self, obj: bpy.types.Object, now: Present, source: Source):
        """Read all that is to be carried, changing nothing. Raises Refusal."""
        mesh = obj.data
        self._now, self._source = now, source
        self._own = points.read(obj)
        self._linear, self._uid = linear_of(obj), obj.session_uid
        self._frame = bpy.context.scene.frame_current_final
        keys = mesh.shape_keys
        blocks = [] if keys is None else list(keys.key_blocks)
        self._blocks = {block.name: points.read_block(obj, block) for block in blocks}
        stored = rest_shape.stored_of(mesh)
        self._held_rest = stored if keys is not None or stored is None else now.rest
        self._attributes = [
            replace(one, values=now.maps[one.name]) if one.is_map and one.name in now.maps else one
            for one in attributes.read(mesh)
        ]
        self._materials, self._smooth = face_settings(mesh)
        self._face_of = face_of_corners(mesh)
        self._groups = members(obj, obj.vertex_groups.keys())
        self._group_names = list(obj.vertex_groups.keys())
        self._stiffness = obj.planar.stiffness_group
        self._held = _held(obj, now)
        self._patch_groups = {held.group for held in self._held if held.holder.pin.kind == "PATCH"}

    # -- solving, without Blender's data

    def solve(self, progress: Progress) -> Carried:
        """The new mesh and all that it takes over. Raises Refusal and native.Cancelled."""
        now, rest_2d = self._now, self._now.drawing.rest
        filling = self._source(lambda share: progress(SOLVED * share))
        tips = [held.holder for held in self._held if held.holder.pin.kind == "POINT"]
        if tips:
            at = np.array([holder.place(rest_2d) for holder in tips])
            filling = reaching(filling, at, np.array([holder.part for holder in tips], np.int32))
        hung = filling.carrying(rest_2d, now.triangles, now.part_of)
        rest = self._stored(hung, now.rest)
        places_2d = now.drawing.rest_places(rest)
        parts = connected_parts(len(rest), filling.triangles)
        cutout = make_cutout(places_2d, filling.triangles, parts)
        pins = [self._pin(filling, hung, cutout, held) for held in self._held]
        kept = self._holding(hung, cutout, pins)
        blocks, flipped = {}, []
        for number, (name, shape) in enumerate(self._blocks.items()):
            if not progress(SOLVED + (1.0 - SOLVED) * number / len(self._blocks)):
                raise native.Cancelled
            posed, upright = self._posed(hung, shape, cutout)
            blocks[name] = self._at_depths(posed, shape, rest, cutout, kept)
            if not upright:
                flipped.append(name)
        own, upright = self._posed(hung, self._own, cutout)
        own = self._at_depths(own, self._own, rest, cutout, kept)
        if not upright and not self._blocks:
            flipped.append("the shape shown")
        faces, carried = self._faces(filling, hung, own)
        said = (*filling.said, *self._patches_said(hung, pins), *self._outside_said(cutout, pins))
        if flipped:
            said += (f"triangles are turned over in {_listed(flipped)}: use Settle Pose there",)
        stored = None if self._held_rest is None else self._stored(hung, self._held_rest)
        return Carried(rest, stored, own, blocks, faces, carried, pins, cutout, said)

    def _stored(self, hung: Carrying, shape: Array32) -> Array32:
        with np.errstate(over="ignore"):
            result = hung.of(shape.astype(np.float64)).astype(np.float32)
        if not np.isfinite(result).all():
            raise Refusal(
                "The drawing has coordinates that are not numbers, or too large ones: undo their edit"
            )
        return result

    def _posed(self, hung: Carrying, shape: Array32, cutout: Cutout) -> tuple[Array32, bool]:
        """A shape on the new mesh, and whether no triangle of it is turned over that was not before."""
        drawing, result = self._now.drawing, self._stored(hung, shape)
        positions = drawing.from_local(result.astype(np.float64))
        over = int(turned_over(positions, cutout.triangles).sum())
        before = drawing.from_local(shape.astype(np.float64))
        if not over or turned_over(before, drawing.cutout.triangles).any():
            return result, True  # as it was
        right = set_right(cutout.rest, cutout.triangles, positions)
        if right is None:
            return result, False
        changed = (right != positions).any(axis=1)
        moved = drawing.to_local(right[changed]) - drawing.to_local(positions[changed])
        result[changed] = (result[changed] + moved).astype(np.float32)
        return result, True

    def _holding(
        self, hung: Carrying, cutout: Cutout, pins: list[Binding | None]
    ) -> list[tuple[Holder, Holder]]:
        """What holds each pin of one part on the old mesh and on the new one."""
        found: list[tuple[Holder, Holder]] = []
        for held, binding in zip(self._held, pins, strict=True):
            if len(np.unique(self._now.drawing.parts[held.holder.pin.vertices])) == 1:
                rows, weights = binding or self._group(hung, held.group, self._groups[held.group])
                if (weights > 0.0).any():
                    pin = Pin(len(found), held.holder.pin.kind, rows[weights > 0.0], weights[weights > 0.0])
                    found.append((held.holder, Holder(pin, cutout)))
        return found

    def _at_depths(
        self,
        result: Array32,
        shape: Array32,
        rest: Array32,
        cutout: Cutout,
        kept: list[tuple[Holder, Holder]],
    ) -> Array32:
        """A shape on the new mesh with its pins as deep as they were on the old one.

        Where depths change most, about a pin, what is carried between vertices flattens them.
        """
        normal = self._now.drawing.frame.n @ self._linear
        old, new = (
            (one.astype(np.float64) - at_rest) @ normal
            for one, at_rest in ((shape, self._now.rest), (result, rest))
        )
        gaps = {holder.pin.key: depth_of(before, old) - depth_of(holder, new) for before, holder in kept}
        least = ROUNDING * float(np.abs(old).max(initial=0.0))
        if not any(abs(gap) > least for gap in gaps.values()):
            return result
        try:
            raised = spread(self._uid, cutout, [holder for _, holder in kept], gaps, np.zeros(len(new)))
        except native.SolveError:
            return result
        across = np.linalg.solve(self._linear, self._now.drawing.frame.n)
        return (result + np.outer(raised, across)).astype(np.float32)

    def _faces(
        self, filling: Filling, hung: Carrying, own: Array32
    ) -> tuple[NewFaces, list[tuple[Attribute, Array]]]:
        now, rest = self._now, self._now.drawing.rest
        middles = filling.middles(rest, now.triangles, now.part_of)
        areas = signed_areas(rest, now.triangles)
        count = int(now.drawing.parts.max()) + 1
        behind = clockwise(areas, now.part_of, count)[now.part_of[middles]]
        triangles = filling.triangles.copy()
        triangles[behind] = triangles[behind][:, ::-1]
        old_faces = self._face_of[now.corners[:, 0]]
        new = NewFaces(
            own,
            triangles,
            self._materials[old_faces[middles]],
            self._smooth[old_faces[middles]],
            {
                self._group_names.index(name): self._group(hung, name, group)
                for name, group in self._groups.items()
            },
        )
        corner_values = [one.values[now.corners] for one in self._attributes if one.is_map]
        kinds = self._materials[old_faces] * count + now.part_of
        charts = charts_of(now.triangles, kinds, corner_values)
        at_corners = corner_carrying(
            rest, now.triangles, now.corners, charts, filling.places, triangles, middles
        )
        carried = []
        for one in self._attributes:
            if one.domain == "FACE":
                values = one.values[old_faces[middles]]
            else:
                values = one.carried(hung if one.domain == "POINT" else at_corners)
            carried.append((one, values))
        return new, carried

    def _group(self, hung: Carrying, name: str, group: Members) -> Members:
        count = len(self._now.rest)
        if name in self._patch_groups:
            rows, weights = group
            held = weights > 0.0
            return patch_carried(hung, count, rows[held], weights[held])
        return group_carried(hung, count, *group, beside=NEUTRAL if name == self._stiffness else 0.0)

    def _pin(self, filling: Filling, hung: Carrying, cutout: Cutout, held: HeldBefore) -> Binding | None:
        if held.hinged is not None:
            place = held.holder.place(held.holder.cutout.rest)
            sides = [nearest_binding_at(cutout, place, filling.points_of(part)) for part in held.hinged]
            rows, weights = (np.concatenate(each) for each in zip(*sides, strict=True))
            return rows, weights
        near = filling.points_of(held.holder.part)
        rows, weights = self._group(hung, held.group, self._groups[held.group])
        if held.holder.pin.kind == "PATCH":
            if len(rows):
                return None
            rows, _ = nearest_binding(cutout, held.holder, near)
            return rows, np.ones(len(rows))
        if not held.owns_group and (weights > 0.0).any():
            there = Holder(Pin(0, "POINT", rows[weights > 0.0], weights[weights > 0.0]), cutout)
            gap = there.place(cutout.rest) - held.holder.place(held.holder.cutout.rest)
            if np.linalg.norm(gap) <= SAME_PLACE * cutout.diagonal:
                return None
        return nearest_binding(cutout, held.holder, near)

    def _patches_said(self, hung: Carrying, pins: list[Binding | None]) -> tuple[str, ...]:
        told = []
        for held, binding in zip(self._held, pins, strict=True):
            if held.holder.pin.kind == "PATCH":
                rows, _ = (
                    self._group(hung, held.group, self._groups[held.group]) if binding is None else binding
                )
                if len(rows) != len(held.holder.pin.vertices):
                    told.append(f"{held.name} ({len(held.holder.pin.vertices)} to {len(rows)})")
        return (f"patches hold other vertices: {_listed(told)}",) if told else ()

    def _outside_said(self, cutout: Cutout, pins: list[Binding | None]) -> tuple[str, ...]:
        told = []
        for held, binding in zip(self._held, pins, strict=True):
            if binding is not None and held.holder.pin.kind == "POINT":
                place = held.holder.place(held.holder.cutout.rest)
                gap = np.linalg.norm(binding[1] / binding[1].sum() @ cutout.rest[binding[0]] - place)
                if gap > SAME_PLACE * cutout.diagonal:
                    told.append(held.name)
        if not told:
            return ()
        return (f"pins outside of the new mesh hold the point of it that is nearest: {_listed(told)}",)

    # -- writing

    def write(self, new: Carried) -> Generator[float, None, None]:
        """Give the object its new mesh. Raises ObjectGone, with nothing changed."""
        yield 0.0
        obj = self._now.drawing.resolve()
        mesh = obj.data
        changes.tell(obj)  # of what a script has done Blender tells later
        fresh = up_to_date.found(obj)
        copies = _copies_as_made(obj)
        owner = mesh_edits.owner_of(mesh) or rest_shape.new_owner()
        had_owners = rest_shape.owners_of(mesh) is not None
        solved = obj.planar.solved_stiffness == self._now.drawing.stiffness_stamp
        new_faces.replace(mesh, new.faces)
        for attribute, values in new.attributes:
            attributes.write(mesh, attribute, values)
        points.write(obj, new.own)
        for name, shape in new.blocks.items():
            points.write_block(mesh.shape_keys.key_blocks[name], shape)
        owners = np.full(len(new.rest), owner, np.int32) if had_owners else None
        rest_shape.put_back(mesh, new.stored, owners)
        points.update(obj)
        self._write_pins(obj, new)
        if solved and obj.planar.solved_stiffness:
            obj.planar.solved_stiffness = stiffness.stamp(stiffness.painted(obj))
        _keep_places(obj)
        if mesh_edits.is_followed(obj):
            mesh_edits.see(obj)
        points.update(obj)
        for pose in copies:
            obj.planar.poses[pose].copied = Stamps(obj).digest(obj.planar.poses[pose].at)
        up_to_date.mark(obj, fresh)
        up_to_date.see(obj)

    def _write_pins(self, obj: bpy.types.Object, new: Carried) -> None:
        for held, binding in zip(self._held, new.pins, strict=True):
            owner = bpy.data.objects[held.owner]
            if binding is not None:
                pin_list.rebind(owner, owner.planar.pins[held.holder.pin.key], *binding)
        elsewhere = bpy.context.scene.frame_current_final != self._frame  # the timeline has gone on
        shape = new.own if obj.data.shape_keys is None else pose_state.shown_points(obj)
        shown = self._now.drawing.from_local(shape.astype(np.float64))
        groups = members(obj, {held.pin_of(obj).group for held in self._held if held.owner == obj.name})
        for held in self._held:
            if held.owner == obj.name and held.stays and not elsewhere:
                pin = held.pin_of(obj)
                rows, weights = groups[pin.group]
                inside = weights > 0.0
                there = Holder(Pin(0, pin.kind, rows[inside], weights[inside]), new.cutout).place(shown)
                self._keep_target(pin, held.holder, there)

    def _keep_target(self, pin: bpy.types.PropertyGroup, before: Holder, place: Array) -> None:
        """A pin that is where it was left is where it is now left, the middle of a patch with its target."""
        drawing, part = self._now.drawing, np.array([before.part], np.int32)
        if pin.kind == "PATCH":
            moved = place - before.place(drawing.positions)
            target = drawing.from_local(np.array([pin.target], np.float64))[0] + moved
            pin.target = drawing.to_local(target[None, :], part)[0]
        pin.reached = drawing.to_local(place[None, :], part)[0]


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - MOST_TOLD} more" if len(names) > MOST_TOLD else ""
    return ", ".join(names[:MOST_TOLD]) + more


def _held(obj: bpy.types.Object, now: Present) -> list[HeldBefore]:
    """The usable pins on the mesh: its own, and those of lattices that deform it."""
    found = []
    for owner in (obj, *lattices_of(obj)):
        if not pin_list.has_pins(owner):
            continue
        pin_list.sync(owner)
        groups = members(obj, pin_list.groups_of(owner))
        for key, pin in enumerate(owner.planar.pins):
            if pin.group not in groups or pin_list.pinned_object(pin) != obj:
                continue
            vertices, weights = groups[pin.group]
            inside = weights > 0.0
            if not inside.any():
                continue
            hinged = None
            kind: Kind = "PATCH" if pin.kind in {"PATCH", "WELD"} else "POINT"
            if pin.kind == "HINGE":
                hinged = joints.two_parts(vertices[inside], weights[inside], now.drawing.parts)
            holder = Holder(Pin(key, kind, vertices[inside], weights[inside]), now.drawing.cutout)
            stays = owner == obj and pin_list.is_reached(pin, now.drawing, holder)
            found.append(HeldBefore(owner.name, pin.name, pin.group, holder, pin.owns_group, stays, hinged))
    return found


def _copies_as_made(obj: bpy.types.Object) -> list[int]:
    """The poses (indices) that repeat others and have not been edited."""
    if not pose_state.is_ours(obj):
        return []
    stamps = Stamps(obj)
    return [
        index
        for index, pose in enumerate(obj.planar.poses)
        if pose.copy_of and pose_blocks.block_at(obj.data.shape_keys, pose.at) is not None
        if stamps.digest(pose.at) == pose.copied
    ]


def _keep_places(obj: bpy.types.Object) -> None:
    """Pins are where they are, on a mesh that has not been edited."""
    mesh = obj.data
    counts = len(mesh.vertices), len(mesh.edges), len(mesh.loops)
    if pin_list.has_pins(obj):
        mesh.planar_seen.counts = counts
        places.follow(obj)
    lattices = [lattice for lattice in lattices_of(obj) if pin_list.has_pins(lattice)]
    if lattices:
        mesh.planar_seen.lattice_counts = counts
        lattice_places.follow(obj, lattices)
