# SPDX-License-Identifier: GPL-3.0-or-later
"""What the .blend stores for an object: its pins and settings."""

from __future__ import annotations

import contextlib
from functools import partial

import bpy
import numpy as np
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
from ..model.posing.depths import DEEPEST
from ..model.posing.pin_path import EASES as PIN_EASES
from ..model.posing.pin_path import KINDS as PIN_PATHS
from ..model.posing.pins import LEAST_SCALE
from ..model.timing.ease import EASES
from .flatten import pushing
from .motion import follow_offset, live
from .objects.any_object import shape_refusal
from .pins import controls, pin_depths
from .sequence import pose_list, pose_state
from .sequence.pose_blocks import FIRST
from .storage import cage, migration
from .telling import tell
from .view import snapshot

# Blender evaluates none of these: they are read when something is done. Animated, they would only be set back
# in every frame, and a frame of a pose would move its own key.
NOT_ANIMATED: set[str] = set()

KINDS = (
    ("POINT", "Point", "Holds one point of the drawing, which stays free to turn there"),
    ("PATCH", "Patch", "Holds all vertices of the group rigidly, and can be turned"),
)

# Of what is kept in the list of pins and holds two parts of the drawing together.
JOINT_KINDS = (
    ("HINGE", "Hinge", "Holds two parts of the drawing together in one point, about which they turn"),
    ("WELD", "Weld", "Holds two parts of the drawing together as they lie"),
)

PATHS = (
    ("STRAIGHT", "Straight", "On straight lines"),
    ("ARC", "Arc", "On circular arcs, as the drawing turns"),
)


def _let_go(pin: PlanarPin, _context: bpy.types.Context) -> None:
    """Another kind or group holds the drawing where it is now; what the old one was asked for is past."""
    pin.has_target = False
    pin.angle, pin.scale = 0.0, 1.0


def _is_mesh(_pin: PlanarPin, obj: bpy.types.Object) -> bool:
    return bool(obj.type == "MESH")


def _follow(pin: PlanarPin, _context: bpy.types.Context) -> None:
    """What is to be followed was chosen by hand: the pin stays where it is beside it from now on."""
    if pin.follow is None or controls.is_given():
        return
    pose = pin.follow.pose
    if pin.follow_bone and (pose is None or pin.follow_bone not in pose.bones):
        with controls.given():
            pin.follow_bone = ""
    try:
        follow_offset.keep(pin.id_data, [_index_of(pin)])
    except Refusal as refusal:
        pin.follow = None
        tell(str(refusal), title="Not Followed")


def _follow_bone(pin: PlanarPin, _context: bpy.types.Context) -> None:
    if pin.follow is not None and not controls.is_given():
        with contextlib.suppress(Refusal):  # of a bone that is not there, which is told when it is looked for
            follow_offset.keep(pin.id_data, [_index_of(pin)])


def _index_of(pin: PlanarPin) -> int:
    return next(index for index, other in enumerate(pin.id_data.planar.pins) if other == pin)


def _is_curve(_path: PlanarPinPath, obj: bpy.types.Object) -> bool:
    return bool(obj.type == "CURVE")


class PlanarPinPath(bpy.types.PropertyGroup):
    """How a pin goes from one pose to the next."""

    pose: StringProperty(options={"HIDDEN"})  # the one from which it leads, by its name
    kind: EnumProperty(
        name="Pin Path", description="Way of the pin to the next pose", items=PIN_PATHS, options=NOT_ANIMATED
    )
    curve: PointerProperty(
        type=bpy.types.Object,
        name="Curve",
        description="Curve along whose first spline the pin goes, from its begin to its end",
        poll=_is_curve,
        options=NOT_ANIMATED,
    )
    ease: EnumProperty(
        name="Timing",
        description="When the pin is how far on its path, between the two poses",
        items=PIN_EASES,
        options=NOT_ANIMATED,
    )


def _depth_of(pin: PlanarPin) -> float:
    obj, index = pin.id_data, _index_of(pin)
    if obj != bpy.context.object:
        return pin_depths.depth_shown(obj, index)
    seen = snapshot.of_active(bpy.context)
    return 0.0 if seen is None else seen.depths.get(index, 0.0)


def _set_depth(pin: PlanarPin, depth: float) -> None:
    chosen = {index for index, other in enumerate(pin.id_data.planar.pins) if other.select}
    try:
        pin_depths.give(pin.id_data, chosen | {_index_of(pin)}, depth)
    except Refusal as refusal:
        tell(str(refusal), title="Depth Not Changed")


class PlanarPin(bpy.types.PropertyGroup):
    """A pin: a vertex group and how it holds the drawing, or a point of the lattice that it poses."""

    name: StringProperty(name="Name", description="Label of the pin", options=NOT_ANIMATED)
    group: StringProperty(
        name="Vertex Group",
        description="Vertex group whose vertices the pin holds",
        update=_let_go,
        options=NOT_ANIMATED,
    )
    group_index: IntProperty(default=-1, options={"HIDDEN"})
    object: PointerProperty(
        type=bpy.types.Object,
        name="Object",
        description="Object whose vertex group the pin of a lattice holds",
        poll=_is_mesh,
        update=_let_go,
        options=NOT_ANIMATED,
    )
    group_count: IntProperty(options={"HIDDEN"})  # that object's when the pin was last matched to them
    lattice_point: IntProperty(default=-1, options={"HIDDEN"})  # the lattice's own point that it holds
    follow: PointerProperty(
        type=bpy.types.Object,
        name="Follow",
        description="Object that the pin follows, from where it is beside it when this is chosen",
        update=_follow,
        options=NOT_ANIMATED,
    )
    follow_bone: StringProperty(
        name="Bone",
        description="Bone of the armature that the pin follows instead",
        update=_follow_bone,
        options=NOT_ANIMATED,
    )
    # The pin's matrix in the space of what it follows, row by row; and the direction in the object's own
    # space that is the first axis of that matrix where the pin is not turned.
    follow_offset: FloatVectorProperty(size=16, default=np.eye(4).ravel().tolist(), options={"HIDDEN"})
    follow_axis: FloatVectorProperty(size=3, default=(1.0, 0.0, 0.0), options={"HIDDEN"})
    owns_group: BoolProperty(options={"HIDDEN"})  # the group was made for this pin and goes with it
    kind: EnumProperty(
        name="Kind",
        description="How the pin holds the drawing",
        items=KINDS + JOINT_KINDS,
        update=_let_go,
        options=NOT_ANIMATED,
    )
    enabled: BoolProperty(
        name="Enabled", description="Let this pin hold the drawing", default=True, options=NOT_ANIMATED
    )
    weight: FloatProperty(
        name="Weight",
        description="How strongly this pin holds, relative to the others",
        default=1.0,
        min=0.001,
        options=NOT_ANIMATED,
    )
    select: BoolProperty(
        name="Selected",
        description="Moved and turned together with the other selected pins",
        options=NOT_ANIMATED,
    )
    angle: FloatProperty(
        name="Angle",
        description="Turn of a patch from rest",
        subtype="ANGLE",
        unit="ROTATION",
        options=NOT_ANIMATED,
    )
    scale: FloatProperty(
        name="Scale",
        description="What a patch has grown by since rest",
        default=1.0,
        min=LEAST_SCALE,
        options=NOT_ANIMATED,
    )
    reached_scale: FloatProperty(options={"HIDDEN"})  # to which the last posing came; 0: it is not known
    paths: CollectionProperty(type=PlanarPinPath)  # see storage/pin_paths.py
    depth: FloatProperty(
        name="Depth",
        description=(
            "How far in front of the rest of the drawing it is here, below 0 behind, where the drawing "
            "lies on itself. Another one is given to all selected pins"
        ),
        min=-DEEPEST,
        max=DEEPEST,
        soft_min=-3.0,
        soft_max=3.0,
        step=100,
        precision=2,
        get=_depth_of,
        set=_set_depth,
        options=NOT_ANIMATED,
    )
    # Object-local: where the pin was asked to be, and where the last posing left it.
    has_target: BoolProperty(options={"HIDDEN"})
    target: FloatVectorProperty(size=3, options={"HIDDEN"})
    reached: FloatVectorProperty(size=3, options={"HIDDEN"})
    # By these the undo of a join is told, which Blender may apply to the mesh alone, see pins/joining.py.
    came_from: IntProperty(options={"HIDDEN"})  # the owner of the mesh that brought it; 0: none
    group_before: StringProperty(options={"HIDDEN"})  # the group that it shared with a pin that came


def _rename_block(pose: PlanarPose, _context: bpy.types.Context) -> None:
    if pose.at >= FIRST:  # otherwise the list is being put together
        pose_list.rename_blocks(pose.id_data, pose)


def _frame_of(pose: PlanarPose) -> float:
    frames = pose_state.frames_at(pose.id_data, pose.at)
    return frames[0] if frames else 0.0


def _retime(pose: PlanarPose, frame: float) -> None:
    obj = pose.id_data
    try:
        reason = shape_refusal(obj) or pose_state.absence(obj)
        if reason is not None:
            raise Refusal(reason)
        index = next(index for index, other in enumerate(obj.planar.poses) if other.at == pose.at)
        pose_list.retime(obj, index, frame)
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
        description="Frame at which the pose is shown: the first of its keys on the curve",
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
    # The active shape key when the sequence was begun; negative: there were none.
    key_before: IntProperty(options={"HIDDEN"})
    # The curve's values before in-betweens were generated, see model/timing/played_curve.py.
    curve_before: StringProperty(options={"HIDDEN"})
    surface: PointerProperty(
        type=bpy.types.Object,
        name="Surface",
        description="Surface that this mesh is, laid flat",
        poll=_is_mesh,
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


CLASSES = (PlanarPinPath, PlanarPin, PlanarPose, PlanarPlace, PlanarSeen, PlanarSettings)


def register() -> None:
    """Adds Object.planar, Mesh.planar_version and Mesh.planar_seen; the classes are registered already."""
    bpy.types.Object.planar = PointerProperty(type=PlanarSettings)
    bpy.types.Mesh.planar_version = IntProperty(options={"HIDDEN"})  # see storage/migration.py
    bpy.types.Mesh.planar_seen = PointerProperty(type=PlanarSeen)


def unregister() -> None:
    """Removes them."""
    own = ((bpy.types.Mesh, "planar_seen"), (bpy.types.Mesh, "planar_version"), (bpy.types.Object, "planar"))
    try_all(partial(delattr, owner, name) for owner, name in own)
