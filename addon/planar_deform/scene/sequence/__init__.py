# SPDX-License-Identifier: GPL-3.0-or-later
"""The pose sequence of an object: its shape keys, the curve that plays them, the list of its poses."""
