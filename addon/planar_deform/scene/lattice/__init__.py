# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices, and what they deform."""
