# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes in their plane: frames, points, triangles, lines."""
