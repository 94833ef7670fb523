# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: events and properties in, model called, scene written."""
