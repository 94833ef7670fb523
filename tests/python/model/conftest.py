# SPDX-License-Identifier: GPL-3.0-or-later
"""The model is imported from the add-on's folder, as Blender would, without Blender."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[3] / "addon"))
sys.path.insert(0, str(Path(__file__).parent))
