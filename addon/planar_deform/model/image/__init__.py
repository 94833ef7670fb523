# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutouts of images: what of an image is art, its outline and mesh, and where its pixels lie in a plane."""
