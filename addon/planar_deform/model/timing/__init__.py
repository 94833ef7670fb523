# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses in time: when they are played, and which of them are needed."""
