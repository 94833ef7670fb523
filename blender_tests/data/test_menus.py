# SPDX-License-Identifier: GPL-3.0-or-later
"""The Planar menu in Object: every operator is in it, and so in Menu Search, which lists menus alone."""

import bpy
from support import bar

# What the Pose tool's keys do, and the file browser of one that is there.
LEFT_OUT = {"PLANAR_OT_click", "PLANAR_OT_guard_key", "PLANAR_OT_pin_menu", "PLANAR_OT_choose_images"}


class Layout:
    """Keeps what a menu puts into its layout."""

    def __init__(self, found):
        self._found = found
        self.operator_context = "EXEC_DEFAULT"

    def operator(self, name, **options):
        self._found.append((name, options.get("text"), self.operator_context))
        kind = getattr(bpy.ops.planar, name.removeprefix("planar.")).get_rna_type()
        return type("Properties", (), {item.identifier: None for item in kind.properties})()

    def menu(self, name, **options):
        entries(name, self._found)

    def separator(self, **options):
        pass

    def label(self, **options):
        pass


def entries(menu, found):
    """The operators of a menu and those below it, with names and contexts."""
    kind = getattr(bpy.types, menu)
    stub = type("Menu", (), {"layout": Layout(found), "column": getattr(kind, "column", None)})()
    kind.draw(stub, bpy.context)
    return found


def test_every_operator_is_in_the_menu_and_asks_for_the_mouse():
    bar()
    found = entries("PLANAR_MT_object", [])
    wanted = {name for name in dir(bpy.types) if name.startswith("PLANAR_OT_")} - LEFT_OUT
    operators = {"PLANAR_OT_" + name.removeprefix("planar.") for name, _, _ in found}
    assert operators == wanted
    for name, _, context in found:
        if hasattr(getattr(bpy.types, "PLANAR_OT_" + name.removeprefix("planar.")), "invoke"):
            assert context == "INVOKE_REGION_WIN", name


def test_no_two_entries_have_the_same_name():
    bar()
    names = [
        text or getattr(bpy.ops.planar, name.removeprefix("planar.")).get_rna_type().name
        for name, text, _ in entries("PLANAR_MT_object", [])
    ]
    assert len(names) == len(set(names))


def test_it_is_in_blender_s_menu_as_long_as_the_add_on_is_on():
    import planar_deform

    def draws():
        return [draw.__module__ for draw in bpy.types.VIEW3D_MT_object._dyn_ui_initialize()]

    assert draws().count("planar_deform.ui.menus") == 1
    planar_deform.unregister()
    assert "planar_deform.ui.menus" not in draws()
    planar_deform.register()
