# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the Pose tool is the active one."""

from __future__ import annotations

import bpy

TOOL = "planar.pose_tool"


def pose_tool_is_active(context: bpy.types.Context) -> bool:
    """In the workspace at hand, in Object Mode."""
    if context.mode != "OBJECT":
        return False
    tool = context.workspace.tools.from_space_view3d_mode("OBJECT", create=False)
    return tool is not None and tool.idname == TOOL
