# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices: what is solved for their points."""
