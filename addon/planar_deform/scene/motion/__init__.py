# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done with a whole motion: baked, edited, thinned, made over to other objects."""
