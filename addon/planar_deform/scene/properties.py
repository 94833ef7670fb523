# SPDX-License-Identifier: GPL-3.0-or-later
"""What the .blend stores for an object: its pins and settings."""

from __future__ import annotations

from functools import partial

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    PointerProperty,
    StringProperty,
)

from ..errors import Refusal, try_all
from ..model.timing.ease import EASES
from . import pin_properties
from .flatten import pushing
from .motion import live
from .objects.any_object import shape_refusal
from .pin_properties import NOT_ANIMATED, PlanarPin, is_mesh
from .pins.pin_list import NO_FRAME
from .pins.taking_part import taking_part
from .sequence import playback, pose_list, pose_state
from .sequence.pose_blocks import FIRST
from .storage import cage, migration
from .telling import tell

PATHS = (
    ("STRAIGHT", "Straight", "On straight lines"),
    ("ARC", "Arc", "On circular arcs, as the drawing turns"),
)


def _rename_block(pose: PlanarPose, _context: bpy.types.Context) -> None:
    if pose.at >= FIRST:  # otherwise the list is being put together
        pose_list.rename_blocks(pose.id_data, pose)


def _frame_of(pose: PlanarPose) -> float:
    frames = pose_state.frames_at(pose.id_data, pose.at)
    return frames[0] if frames else 0.0


def _retime(pose: PlanarPose, frame: float) -> None:
    obj = pose.id_data
    objects = taking_part(bpy.context).objects if obj == bpy.context.object else [obj]
    try:
        reason = shape_refusal(obj) or pose_state.absence(obj)
        if reason is not None:
            raise Refusal(reason)
        index = next(index for index, other in enumerate(obj.planar.poses) if other.at == pose.at)
        found = pose_list.alike(obj, index, [one for one in objects if shape_refusal(one) is None])
        steps = [
            playback.named(
                name if len(found) > 1 else None, pose_list.retiming(bpy.data.objects[name], its, frame)
            )
            for name, its in found.items()
        ]
        playback.run(playback.together(steps))
    except Refusal as refusal:
        tell(str(refusal), title="Pose Not Moved")


class PlanarPose(bpy.types.PropertyGroup):
    """A keyed pose of the object's sequence."""

    name: StringProperty(
        name="Name",
        description="Name of the pose and its shape key",
        update=_rename_block,
        options=NOT_ANIMATED,
    )
    at: FloatProperty(options={"HIDDEN"})  # the eval_time of its shape key on the curve, see scene/sequence/
    frame: FloatProperty(
        name="Frame",
        description=(
            "Frame at which the pose is shown: the first of its keys on the curve. A change takes along the "
            "poses of all that are selected with it"
        ),
        get=_frame_of,
        set=_retime,
        options=NOT_ANIMATED,
        step=100,
        precision=0,
    )
    # Of the way to the next pose, see inbetweens/planning.py.
    generated: IntProperty(options={"HIDDEN"})  # how many eval_times belong to generated shapes
    stamp: StringProperty(options={"HIDDEN"})  # what they were made from
    made_with: StringProperty(options={"HIDDEN"})  # and with, see sequence/conditions.py
    edited: BoolProperty(options={"HIDDEN"})  # whether they have been changed since
    turns: IntProperty(
        name="Extra Turns",
        description=(
            "Whole counter-clockwise turns that the drawing makes on its way to the next pose, beside the "
            "shortest way; negative: clockwise"
        ),
        min=-100,
        max=100,
        soft_min=-3,
        soft_max=3,
        options=NOT_ANIMATED,
    )
    copy_of: StringProperty(options={"HIDDEN"})  # the pose that it repeats at a later time
    copied: StringProperty(options={"HIDDEN"})  # stamp of that when it was copied
    order_before: IntProperty(options={"HIDDEN"})  # from 1: among the poses before they were put in order


def _set_live(settings: PlanarSettings, context: bpy.types.Context) -> None:
    _number(settings, context)
    live.switched(settings.id_data)


def _number(settings: PlanarSettings, _context: bpy.types.Context) -> None:
    migration.migrate(settings.id_data)


def _set_live_uv(settings: PlanarSettings, context: bpy.types.Context) -> None:
    _number(settings, context)
    if not settings.live_uv:
        return
    try:
        pushing.push(settings.id_data)
    except Refusal as refusal:
        settings.live_uv = False
        tell(str(refusal), title="Live UV Off")


class PlanarPlace(bpy.types.PropertyGroup):
    """Where the pins of a vertex group, which is its name, are on the rest shape."""

    place: FloatVectorProperty(size=3, options={"HIDDEN"})  # object-local
    even: BoolProperty(options={"HIDDEN"})  # all of the group have the same weight


class PlanarSeen(bpy.types.PropertyGroup):
    """A mesh as it was last seen; see objects/mesh_edits.py and pins/places.py."""

    keyed: BoolProperty(options={"HIDDEN"})  # the shape seen is that of the Basis
    counts: IntVectorProperty(size=3, options={"HIDDEN"})  # vertices, edges, corners
    places: CollectionProperty(type=PlanarPlace)
    # Of the pins of lattices, see pins/lattice_places.py.
    lattice_counts: IntVectorProperty(size=3, options={"HIDDEN"})
    lattice_places: CollectionProperty(type=PlanarPlace)


class PlanarSettings(bpy.types.PropertyGroup):
    """Pins and posing settings of an object."""

    version: IntProperty(options={"HIDDEN"})  # see storage/migration.py
    pins: CollectionProperty(type=PlanarPin)
    active_pin: IntProperty(name="Active Pin", description="Pin shown in the panel", options=NOT_ANIMATED)
    group_count: IntProperty(options={"HIDDEN"})  # vertex groups when the pins were last matched to them
    use_mirror_x: BoolProperty(
        name="Symmetry",
        description=(
            "Move, turn and scale pins together with their partners on the other side, paired by their names "
            "(Hand.L, Hand.R) or places"
        ),
        update=_number,
        options=NOT_ANIMATED,
    )
    method: EnumProperty(
        name="Method",
        description="How the drawing follows the pins",
        items=(
            (
                "HOLD",
                "Hold Shape",
                "Of all shapes that the pins allow, the one that distorts the rest shape least: pins brought "
                "back bring the drawing back",
            ),
            (
                "AKVF",
                "AKVF",
                "As-Killing-as-possible: each move keeps the drawing as rigid as it can locally, and begins "
                "from where the last one ended. Forgets the rest shape",
            ),
            (
                "ARAP",
                "ARAP",
                "As-rigid-as-possible, in two linear steps, as other programs know it: the same work for any "
                "move, but it depends on how the drawing is meshed, and large poses turn triangles over",
            ),
        ),
        update=_number,
        options=NOT_ANIMATED,
    )
    pin_weight: FloatProperty(
        name="Pin Weight",
        description="How strongly all pins hold, relative to what the method does by itself",
        default=1.0,
        min=1e-3,
        soft_max=10.0,
        update=_number,
        options=NOT_ANIMATED,
    )
    stiffness_group: StringProperty(
        name="Stiffness",
        description=(
            "Vertex group painted with stiffness: at a weight of 0.5 the drawing is as it is without, "
            "at 1 a hundred times as stiff, at 0 a hundred times as soft"
        ),
        update=_number,
        options=NOT_ANIMATED,
    )
    stiffness_index: IntProperty(default=-1, options={"HIDDEN"})
    # What of the stiffness the shape shown was solved with, as stiffness.stamp() tells it; empty: unknown.
    solved_stiffness: StringProperty(options={"HIDDEN"})
    show_quality: EnumProperty(
        name="Quality",
        description="Colour the drawing by how much the pose distorts it; flipped triangles are marked, too",
        items=(
            ("OFF", "Off", "No colours"),
            ("AREA", "Area", "How much larger or smaller each triangle has become"),
            ("ANGLE", "Angle", "How much each triangle has changed its shape"),
        ),
        update=_number,
        options=NOT_ANIMATED,
    )
    coarse_above: IntProperty(
        name="Solve Coarsely Above",
        description=(
            f"A drawing of more vertices is solved on a coarse mesh of about {cage.VERTICES} round it, "
            "which carries it along"
        ),
        default=cage.ABOVE,
        min=cage.VERTICES,
        update=_number,
        options=NOT_ANIMATED,
    )
    show_mesh: BoolProperty(
        name="Mesh Edges",
        description="Show the edges of the mesh in the Pose tool",
        update=_number,
        options=NOT_ANIMATED,
    )
    poses: CollectionProperty(type=PlanarPose)
    active_pose: IntProperty(
        name="Active Pose", description="Pose that the panel's buttons act on", options=NOT_ANIMATED
    )
    show_onion: BoolProperty(
        name="Onion Skin",
        description=(
            "Show the outlines of the poses keyed before (green) and behind (blue) the current frame, "
            "but not while the timeline plays"
        ),
        update=_number,
        options=NOT_ANIMATED,
    )
    anchor_path: EnumProperty(
        name="Path",
        description="Way from pose to pose of planted pins, else of all pins, else of the middle",
        items=PATHS,
        options=NOT_ANIMATED,
        update=_number,
    )
    smooth: BoolProperty(
        name="Smooth",
        description="Pass through the poses without a change of speed or direction there",
        options=NOT_ANIMATED,
        update=_number,
    )
    depth_between: EnumProperty(
        name="Depth",
        description="Depths of the pins between two poses",
        items=(
            ("BLENDED", "Blended", "They go evenly from one pose to the next"),
            ("HELD", "Held", "They stay those of the pose before, until the next one"),
        ),
        options=NOT_ANIMATED,
        update=_number,
    )
    ease: EnumProperty(
        name="New Keys",
        description="Ease of the keys that new poses get, and not of those there are",
        items=EASES,
        options=NOT_ANIMATED,
        update=_number,
    )
    record_loop: BoolProperty(
        name="Loop",
        description=(
            "Begin again at the first frame of the recording when it comes to the end of the range: what is "
            "recorded then replaces what was before. Otherwise the recording ends there"
        ),
        options=NOT_ANIMATED,
        update=_number,
    )
    record_overwrite: BoolProperty(
        name="Overwrite",
        description="Pins that are not dragged stay where they are, instead of moving on as they did",
        options=NOT_ANIMATED,
        update=_number,
    )
    live: BoolProperty(
        name="Live",
        description=(
            "Let the pins follow what they are to follow while that is moved, and in every frame that is "
            "played or rendered. What is shown is keyed only by Key Pose"
        ),
        update=_set_live,
        options=NOT_ANIMATED,
    )
    # Where what the pins follow was when they have followed it last, as controls.stamp() tells it.
    followed: StringProperty(options={"HIDDEN"})
    # The frame at which it was posed by hand since it last followed; a frame that none has: it was not.
    posed_at: FloatProperty(default=NO_FRAME, options={"HIDDEN"})
    # The active shape key when the sequence was begun; negative: there were none.
    key_before: IntProperty(options={"HIDDEN"})
    # The curve's values before in-betweens were generated, see model/timing/played_curve.py.
    curve_before: StringProperty(options={"HIDDEN"})
    surface: PointerProperty(
        type=bpy.types.Object,
        name="Surface",
        description="Surface that this mesh is, laid flat",
        poll=is_mesh,
        update=_number,
        options=NOT_ANIMATED,
    )
    surface_vertices: IntProperty(options={"HIDDEN"})  # that it had when it was laid flat
    # How the flat mesh lies in the surface's UV map since it was first pushed; a scale of 0: it never was.
    uv_scale: FloatProperty(options={"HIDDEN"})
    uv_offset: FloatVectorProperty(size=2, options={"HIDDEN"})
    pushed: StringProperty(options={"HIDDEN"})  # digest of the shape that was pushed last
    live_uv: BoolProperty(
        name="Live UV",
        description="Let the surface's UV map follow whatever changes the shape of its flat mesh",
        update=_set_live_uv,
        options=NOT_ANIMATED,
    )
    # A lattice as it was last seen, see objects/lattice_edits.py.
    seen_basis: FloatVectorProperty(size=16, options={"HIDDEN"})
    seen_sums: FloatVectorProperty(size=24, options={"HIDDEN"})
    image_state: StringProperty(options={"HIDDEN"})  # see image/file_state.py
    # What the point cache was baked from, see motion/cache_age.py.
    cache_stamp: StringProperty(options={"HIDDEN"})


CLASSES = (*pin_properties.CLASSES, PlanarPose, PlanarPlace, PlanarSeen, PlanarSettings)


def register() -> None:
    """Adds Object.planar, Mesh.planar_version and Mesh.planar_seen; the classes are registered already."""
    bpy.types.Object.planar = PointerProperty(type=PlanarSettings)
    bpy.types.Mesh.planar_version = IntProperty(options={"HIDDEN"})  # see storage/migration.py
    bpy.types.Mesh.planar_seen = PointerProperty(type=PlanarSeen)


def unregister() -> None:
    """Removes them."""
    own = ((bpy.types.Mesh, "planar_seen"), (bpy.types.Mesh, "planar_version"), (bpy.types.Object, "planar"))
    try_all(partial(delattr, owner, name) for owner, name in own)
