#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that the add-on registers, unregisters, and leaves nothing behind in Blender's types."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))

# Every base that Blender registers classes of, and the types that add-ons hang properties on.
BASES = ("Operator", "Panel", "Menu", "UIList", "PropertyGroup", "Gizmo", "GizmoGroup", "AddonPreferences")
OWNERS = ("Object", "Mesh", "Scene", "WindowManager", "VertexGroup")


def registered() -> set[str]:
    classes = {
        f"{base}.{cls.__name__}"
        for base in BASES
        for cls in getattr(bpy.types, base).__subclasses__()
        if getattr(cls, "is_registered", False)
    }
    properties = {f"{owner}.{name}" for owner in OWNERS for name in dir(getattr(bpy.types, owner))}
    return classes | properties


def main() -> int:
    import planar_deform

    before = registered()
    planar_deform.register()
    added = registered() - before
    planar_deform.unregister()
    left = registered() - before
    print(f"registered {len(added)} classes and properties, left behind: {sorted(left) or 'none'}")
    return 0 if added and not left else 1


if __name__ == "__main__":
    sys.exit(main())
