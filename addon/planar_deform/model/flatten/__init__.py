# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces laid flat: cut into patches, solved, and put side by side."""
