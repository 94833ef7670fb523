# SPDX-License-Identifier: GPL-3.0-or-later
"""What is stored with an object: nothing offers itself to be animated that Blender does not evaluate."""

import pytest
from sequences import key
from support import add_end_pins, bar


@pytest.mark.parametrize("of", ["settings", "pin", "pose"])
def test_no_property_can_be_keyed(of):
    obj = bar()
    add_end_pins(obj)
    key(obj, 1)
    settings = obj.planar
    owner = {"settings": settings, "pin": settings.pins[0], "pose": settings.poses[0]}[of]
    stored = [item for item in owner.bl_rna.properties if item.type not in {"COLLECTION", "POINTER"}]
    assert len(stored) > 5
    assert [item.identifier for item in stored if item.is_animatable] == []
    for item in stored:
        with pytest.raises(TypeError):
            owner.keyframe_insert(item.identifier)
    assert obj.animation_data is None
