# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins, plane frames, drags and solver caches: plain Python and NumPy, never bpy."""
