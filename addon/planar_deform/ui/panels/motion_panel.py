# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done with a whole motion, in the sidebar tab."""

from __future__ import annotations

import bpy

from ...scene.sequence import pose_state
from .tab import PlanarPanel


class PLANAR_PT_motion(PlanarPanel, bpy.types.Panel):
    bl_label = "Motion"
    bl_parent_id = "PLANAR_PT_poses"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 0

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and pose_state.has_blocks(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("planar.transfer_motion", icon="MOD_DATA_TRANSFER")
        column.operator("planar.edit_sequence", icon="SMOOTHCURVE")
        column.operator("planar.thin_poses", icon="MOD_DECIM")


CLASSES = (PLANAR_PT_motion,)
