# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown in a 3D view, and what lies under the mouse there."""
