# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user does with mouse and keys, as values."""
