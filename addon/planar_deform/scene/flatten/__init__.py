# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces read, and their flat shapes written: as meshes, and to UV maps."""
