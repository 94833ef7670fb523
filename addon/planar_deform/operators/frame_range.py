# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames that an operator works on."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from ..scene.motion import bake


class FrameRange:
    """Properties of an operator that bakes frames. The next one, perhaps of another object, has them anew."""

    properties: bpy.types.OperatorProperties  # of Blender's operators

    frame_start: IntProperty(
        name="First Frame",
        description="First frame to bake; by default the scene's, or its preview's",
        options={"SKIP_SAVE"},
    )
    frame_end: IntProperty(
        name="Last Frame",
        description="Last frame to bake; by default the scene's, or its preview's",
        options={"SKIP_SAVE"},
    )
    frame_step: IntProperty(
        name="Step",
        description="Frames from one baked frame to the next",
        default=1,
        min=1,
        soft_max=12,
        options={"SKIP_SAVE"},
    )

    def complete_range(self, context: bpy.types.Context) -> None:
        """Give what is not said its default, so that the redo panel shows it."""
        for name, value in zip(("frame_start", "frame_end"), bake.frame_range(context.scene), strict=True):
            if not self.properties.is_property_set(name):
                setattr(self, name, value)

    @property
    def frames(self) -> range:
        """Those to bake. Raises Refusal if there are none."""
        return bake.frames_of(self.frame_start, self.frame_end, self.frame_step)
