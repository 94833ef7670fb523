# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins, and how a cutout is posed by them."""
