# SPDX-License-Identifier: GPL-3.0-or-later
"""What the .blend stores for a pin."""

from __future__ import annotations

import contextlib

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..errors import Refusal
from ..model.posing.depths import DEEPEST
from ..model.posing.pin_path import EASES
from ..model.posing.pin_path import KINDS as PATH_KINDS
from ..model.posing.pins import LEAST_SCALE
from .motion import carrying, follow_offset
from .pins import controls, pin_depths
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


def _let_go(pin: PlanarPin, _context: bpy.types.Context) -> None:
    """Another kind or group holds the drawing where it is now; what the old one was asked for is past."""
    pin.has_target = pin.has_posed = False
    pin.angle, pin.scale = 0.0, 1.0


def is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return bool(obj.type == "MESH")


def _follow(pin: PlanarPin, _context: bpy.types.Context) -> None:
    """What is to be followed was chosen by hand: the pin stays where it is beside it from now on."""
    if pin.follow is None or controls.is_given():
        return
    pose = pin.follow.pose
    with controls.given():
        if pin.follow_bone and (pose is None or pin.follow_bone not in pose.bones):
            pin.follow_bone = ""
        if pin.follow_group and pin.follow_group not in pin.follow.vertex_groups:
            pin.follow_group = ""
    try:
        if not pin.follow_group and carrying.is_drawing(pin.follow):
            carrying.carry(pin.id_data, [_index_of(pin)], pin.follow)
        else:
            follow_offset.keep(pin.id_data, [_index_of(pin)])
    except Refusal as refusal:
        pin.follow = None
        tell(str(refusal), title="Not Followed")


def _follow_part(pin: PlanarPin, _context: bpy.types.Context) -> None:
    """What of it is followed was chosen by hand."""
    if pin.follow is not None and not controls.is_given():
        with contextlib.suppress(Refusal):  # of what is not there, which is told when it is looked for
            follow_offset.keep(pin.id_data, [_index_of(pin)])


def _index_of(pin: PlanarPin) -> int:
    return next(index for index, other in enumerate(pin.id_data.planar.pins) if other == pin)


def _is_curve(_path: PlanarPinPath, obj: bpy.types.Object) -> bool:
    return bool(obj.type == "CURVE")


class PlanarPinPath(bpy.types.PropertyGroup):
    """How a pin goes from one pose to the next."""

    pose: StringProperty(options={"HIDDEN"})  # the one from which it leads, by its name
    kind: EnumProperty(
        name="Pin Path", description="Way of the pin to the next pose", items=PATH_KINDS, options=NOT_ANIMATED
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
        items=EASES,
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
        poll=is_mesh,
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
        update=_follow_part,
        options=NOT_ANIMATED,
    )
    follow_group: StringProperty(
        name="Place",
        description=(
            "Vertex group of the mesh that the pin follows: it goes with that, rigidly, wherever the shape "
            "of the mesh takes it. Empty: the pin follows the object alone"
        ),
        update=_follow_part,
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
    has_posed: BoolProperty(options={"HIDDEN"})  # before a reset took its target: poses that were keyed then
    target: FloatVectorProperty(size=3, options={"HIDDEN"})
    reached: FloatVectorProperty(size=3, options={"HIDDEN"})
    # By these the undo of a join is told, which Blender may apply to the mesh alone, see pins/joining.py.
    came_from: IntProperty(options={"HIDDEN"})  # the owner of the mesh that brought it; 0: none
    group_before: StringProperty(options={"HIDDEN"})  # the group that it shared with a pin that came


CLASSES = (PlanarPinPath, PlanarPin)
