# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading and writing Blender's data: meshes, shape keys, vertex groups, and what the .blend stores."""
