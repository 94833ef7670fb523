# SPDX-License-Identifier: GPL-3.0-or-later
"""What the vertices of batches of dense drawings, of which there are a million, are made of."""

from __future__ import annotations

import gpu


def places(*, coloured: bool = False) -> gpu.types.GPUVertFormat:
    """Places "pos" in space and, if `coloured`, each with its "color", in bytes."""
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="pos", comp_type="F32", len=3, fetch_mode="FLOAT")
    if coloured:
        form.attr_add(id="color", comp_type="U8", len=4, fetch_mode="INT_TO_FLOAT_UNIT")
    return form
