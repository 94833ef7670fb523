# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool, gizmos, overlay and panels: they draw a prepared snapshot and compute nothing."""
