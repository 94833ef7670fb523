# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes generated between the poses of a sequence."""
