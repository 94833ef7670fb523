# SPDX-License-Identifier: GPL-3.0-or-later
"""The Pose tool and its gizmos."""
