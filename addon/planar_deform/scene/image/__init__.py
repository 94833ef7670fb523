# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts made from images: what is read of these, planes that show them, meshes that take their place."""
