# SPDX-License-Identifier: GPL-3.0-or-later
"""What is stored of shapes: arrays of points, shape keys, and their digests."""
