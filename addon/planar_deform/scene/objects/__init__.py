# SPDX-License-Identifier: GPL-3.0-or-later
"""From a Blender object to the flat shape that is solved, and back."""
