# SPDX-License-Identifier: GPL-3.0-or-later
"""The Pose tool in the toolbar, with its keys."""

from __future__ import annotations

import bpy

from .gizmos import PLANAR_GGT_pins
from .tool_state import TOOL

CLASSES = ()


Setting = tuple[str, str | bool]  # of an operator: name and value
Key = tuple[str, dict[str, str | bool], dict[str, list[Setting]] | None]  # operator, event, properties


def _key(operator: str, key: str, *, properties: list[Setting] | None = None, **modifiers: bool) -> Key:
    event: dict[str, str | bool] = {"type": key, "value": "PRESS", **modifiers}
    return operator, event, {"properties": properties} if properties else None


def _guarded(
    operator: str, key: str, properties: list[Setting] | None = None, **modifiers: bool
) -> tuple[Key, Key]:
    guard = _key("planar.guard_key", key, properties=[("operator", operator)], **modifiers)
    return guard, _key(f"planar.{operator}", key, properties=properties, **modifiers)


class PoseTool(bpy.types.WorkSpaceTool):
    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = TOOL
    bl_label = "Pose Cutout"
    bl_description = (
        "Drag pins; the drawing follows.\n"
        "• Click selects a pin, Shift-click adds to the selection.\n"
        "• Ctrl-click adds a pin to the active mesh, or to what the active lattice deforms.\n"
        "• Pins of all selected drawings are posed as one.\n"
        "• Shift-Ctrl-click adds a joint where two parts lie on each other.\n"
        "• G moves, R turns, S spreads, X removes the selected pins.\n"
        "• I keys the pose"
    )
    bl_icon = "ops.pose.push"
    bl_widget = PLANAR_GGT_pins.bl_idname
    # A key whose operator does not apply would go on to Blender's own, which moves or deletes the object.
    # Operators without a poll take the key and say why nothing happens; beside the others stands a guard.
    bl_keymap = (
        _key("planar.click", "LEFTMOUSE"),
        _key("planar.click", "LEFTMOUSE", shift=True, properties=[("extend", True)]),
        _key("planar.click", "LEFTMOUSE", ctrl=True, properties=[("add", True)]),
        _key("planar.click", "LEFTMOUSE", shift=True, ctrl=True, properties=[("add_joint", True)]),
        _key("planar.pin_menu", "RIGHTMOUSE"),
        _key("planar.drag_pins", "G"),
        _key("planar.rotate_pins", "R"),
        _key("planar.spread_pins", "S"),
        _key("planar.remove_pins", "X"),
        _key("planar.remove_pins", "DEL"),
        *_guarded("select_pins", "A", [("action", "ALL")]),
        *_guarded("select_pins", "A", [("action", "NONE")], alt=True),
        *_guarded("select_pins", "I", [("action", "INVERT")], ctrl=True),
        *_guarded("box_select_pins", "B"),
        *_guarded("disable_pins", "H"),
        *_guarded("enable_pins", "H", alt=True),
        *_guarded("key_pose", "I"),
    )

    @staticmethod
    def draw_settings(
        context: bpy.types.Context, layout: bpy.types.UILayout, _tool: bpy.types.WorkSpaceTool
    ) -> None:
        obj = context.object
        if obj is not None and obj.type == "LATTICE":
            layout.prop(obj.planar, "pin_weight")
            layout.prop(obj.planar, "show_quality")
        if obj is not None and obj.type == "MESH":
            layout.prop(obj.planar, "method", text="")
            layout.prop(obj.planar, "pin_weight")
            layout.prop(obj.planar, "show_quality")
            layout.prop(obj.planar, "show_mesh")


def register() -> None:
    bpy.utils.register_tool(PoseTool, after={"builtin.transform"}, separator=True)


def unregister() -> None:
    bpy.utils.unregister_tool(PoseTool)
