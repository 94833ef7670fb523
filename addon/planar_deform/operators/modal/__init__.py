# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes on while the user watches or moves the mouse: drags, and solving in a thread."""
