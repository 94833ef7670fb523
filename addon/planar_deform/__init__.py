# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar Deform: pose flat cutouts by dragging pins."""


def register() -> None:
    """Called by Blender when the extension is enabled."""
    from . import updating

    updating.register()


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    from . import updating

    updating.unregister()
