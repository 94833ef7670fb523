# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces laid flat, and what is done with their flat meshes."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ..errors import ObjectGone, Refusal
from ..model.flatten.flattening import Flat, Settings, lengths_kept, turned_over
from ..model.plane.frame import Array32
from ..scene.flatten import flat_mesh, pattern, pushing, refreshing, surface, uv_maps
from ..scene.flatten.link import is_flat_mesh
from ..scene.objects.flat_object import make_current
from ..scene.pins import pin_list
from ..scene.storage.paths import absolute
from .modal.long_job import Job, LongOperator
from .modal.object_posing import ObjectPosing
from .posing_operator import PosingOperator
from .settle import STILL

TARGETS = (
    ("MESH", "Flat Mesh", "A new mesh, true to scale, which can be posed and pushed back to the UV map"),
    ("UV", "UV Map", "Straight to a UV map of the surface"),
)
METHODS = (
    ("HOLD", "Hold Shape", "The flat shape of least distortion; no triangle is turned over"),
    (
        "TWO_STEP",
        "Two Steps",
        "As-rigid-as-possible in two steps, as other programs do it: triangles may be turned over",
    ),
)
WEIGHTS = (
    ("COTANGENT", "Cotangent", "By the angles opposite to each edge"),
    ("UNIFORM", "Uniform", "All edges alike"),
)
EXACT = 0.01  # of an edge's length: what nobody sees
BADLY = 2.0  # the longest edge against the shortest one, both by what they should be


class Flattening(LongOperator):
    """Lays patches flat by these settings."""

    method: EnumProperty(name="Method", description="How patches are laid flat", items=METHODS)
    weights: EnumProperty(
        name="Weights",
        description="What edges count in the two steps, from which Hold Shape starts as well",
        items=WEIGHTS,
    )
    iterations: IntProperty(
        name="Iterations",
        description=(
            "Hold Shape: steps at most, 0: until nothing is left to do. Two Steps: repetitions of the second "
            "step"
        ),
        default=0,
        min=0,
        max=1000,
    )

    def settings(self, fixed: tuple[int, int] | None = None) -> Settings:
        return Settings(self.method.lower(), self.weights.lower(), self.iterations, fixed)


class PLANAR_OT_flatten(Flattening, bpy.types.Operator):
    bl_idname = "planar.flatten"
    bl_label = "Flatten"
    bl_description = (
        "Lay a surface flat, cut along its seams, true to scale: the whole mesh, in Edit Mode its selected "
        "faces"
    )

    to: EnumProperty(name="To", description="What is made of the flat patches", items=TARGETS)
    numbered_edges: BoolProperty(
        name="Numbered Edges",
        description="Give both edges of each seam a number, for paper and cloth",
    )
    new_map: BoolProperty(name="New UV Map", description="Make a UV map instead of changing the active one")
    keep_scale: BoolProperty(
        name="Keep Scale",
        description=(
            "A unit of the UV map is a unit of the scene, also if islands reach out of the map then. "
            "Otherwise all are scaled alike to fill it"
        ),
    )
    fixed_edge: IntProperty(
        name="Fixed Edge",
        description=(
            "Edge from which to begin, and which lies horizontal: in Edit Mode the active one. -1: one in "
            "the middle"
        ),
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return surface.refusal(context)

    def job(self, context: bpy.types.Context) -> Job:
        obj = context.object
        edited = obj.mode == "EDIT"
        if self.to == "UV" and (reason := uv_maps.refusal(obj)) is not None:
            raise Refusal(reason)
        if not self.properties.is_property_set("fixed_edge"):
            self.fixed_edge = surface.active_edge(obj)
        held = None
        with surface.in_object_mode(context):
            make_current(context)
            found = surface.read(obj, selected=edited)
            fixed = surface.fixed_edge(obj.data, self.fixed_edge)
            if self.to == "UV" and not self.new_map:
                held = uv_maps.pinned(obj.data, found.patches)
        solve = partial(found.flattened, self.settings(fixed), held=held)
        write = partial(self._write, obj.name, obj.session_uid, found)
        return Job(write, solve, partial(self._summary, found))

    def _summary(self, found: surface.Surface, flat: Flat) -> str:
        count = found.patches.count
        least, most = lengths_kept(found.places, flat.places, found.patches.triangles)
        exact = least > 1.0 - EXACT and most < 1.0 + EXACT
        scale = (
            "true to scale" if exact else f"edges {least:.2f} to {most:.2f} times as long as on the surface"
        )
        told = f"{count} patch{'es' if count > 1 else ''} laid flat, {scale}"
        if most > BADLY * least:
            told += ": more seams distort less"
        over = turned_over(flat.places, found.patches.triangles) if self.method == "TWO_STEP" else 0
        return f"{told}; {over} triangles are turned over: Hold Shape has none" if over else told

    def _write(self, name: str, uid: int, found: surface.Surface, flat: Flat) -> Generator[float, None, None]:
        yield 0.0
        context = bpy.context
        obj = bpy.data.objects.get(name)
        if obj is None or obj.session_uid != uid or context.object != obj:
            raise ObjectGone(f"'{name}' is not the active object any more")
        if self.to == "MESH":
            if obj.mode == "EDIT":
                bpy.ops.object.mode_set(mode="OBJECT")
            flat_mesh.add(context, obj, found, flat.places, numbered=self.numbered_edges)
            return
        with surface.in_object_mode(context):
            places = uv_maps.laid_out(context, found.patches, flat, keep_scale=self.keep_scale)
            mesh = obj.data
            layer = uv_maps.new(mesh, "UVMap") if self.new_map else uv_maps.active_or_new(mesh)
            uvs = uv_maps.read(layer)
            uvs[found.patches.corners] = places[found.patches.flat]
            uv_maps.write(mesh, layer, uvs)

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        names = ("numbered_edges",) if self.to == "MESH" else ("new_map", "keep_scale")
        for name in ("to", "method", "weights", "iterations", "fixed_edge", *names):
            column.prop(self, name)


class PLANAR_OT_push_to_uv_map(PosingOperator, bpy.types.Operator):
    bl_idname = "planar.push_to_uv_map"
    bl_label = "Push to UV Map"
    bl_description = "Write the flat mesh, posed and edited as it is, to the active UV map of its surface"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return refreshing.refusal(context.object)

    def apply(self, context: bpy.types.Context) -> None:
        make_current(context)
        written = pushing.push(context.object)
        self.report({"INFO"}, f"Written to UV map '{written.data.uv_layers.active.name}' of '{written.name}'")


class PLANAR_OT_refresh_from_surface(Flattening, bpy.types.Operator):
    bl_idname = "planar.refresh_from_surface"
    bl_label = "Refresh from Surface"
    bl_description = (
        "Lay the edited surface flat again; pins stay, a pose is solved again from the new shape, and keyed "
        "poses are carried over to it"
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return refreshing.refusal(context.object)

    def job(self, context: bpy.types.Context) -> Job:
        make_current(context)
        refresh = refreshing.Refresh(context.object, self.settings())
        return Job(partial(self._write, refresh), refresh.solve)

    def _write(
        self, refresh: refreshing.Refresh, new: tuple[Array32, refreshing.Shapes]
    ) -> Generator[float, None, None]:
        yield 0.0
        refresh.write(new)
        obj = bpy.context.object
        try:
            if refresh.posed and any(pin.enabled and not pin_list.is_joint(pin) for pin in obj.planar.pins):
                ObjectPosing(bpy.context, settling=True).run([STILL], settle=True)
            elif obj.planar.live_uv:
                pushing.push(obj)
        except Exception:
            refresh.take_back()
            raise


class PLANAR_OT_export_pattern(PosingOperator, ExportHelper, bpy.types.Operator):
    bl_idname = "planar.export_pattern"
    bl_label = "Export Pattern"
    bl_description = (
        "Write the flat mesh to an SVG in millimetres, a unit as long as the scene's units tell: the outline "
        "of each patch, and numbers where Numbered Edges was on"
    )
    bl_options = {"REGISTER"}  # it changes nothing

    filename_ext = ".svg"
    filter_glob: StringProperty(default="*.svg", options={"HIDDEN"})

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.object
        return None if is_flat_mesh(obj) and obj.mode == "OBJECT" else refreshing.refusal(obj)

    def apply(self, context: bpy.types.Context) -> None:
        if not self.filepath:
            raise Refusal("Where is the pattern to be written? Give a path")
        path = absolute(self.filepath)
        pattern.export(context.object, path, context.scene.unit_settings.scale_length)
        self.report({"INFO"}, f"Written to {path}")


CLASSES: tuple[Any, ...] = (
    PLANAR_OT_flatten,
    PLANAR_OT_push_to_uv_map,
    PLANAR_OT_refresh_from_surface,
    PLANAR_OT_export_pattern,
)
