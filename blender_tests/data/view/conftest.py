# SPDX-License-Identifier: GPL-3.0-or-later
"""How often meshes are read."""

import pytest


@pytest.fixture
def reads(monkeypatch):
    """The names of the objects whose meshes are read, in order."""
    from planar_deform.scene.objects import cutout_object

    names, read = [], cutout_object.read

    def counted(obj, **more):
        names.append(obj.name)
        return read(obj, **more)

    monkeypatch.setattr(cutout_object, "read", counted)
    return names
