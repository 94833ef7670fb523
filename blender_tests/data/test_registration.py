# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling and disabling the add-on leaves Blender as it was; errors on the way are not swallowed."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest
from support import bar


def registered():
    """Names in bpy.types and handlers that could be ours."""
    handlers = [
        function.__module__
        for name in dir(bpy.app.handlers)
        if isinstance(functions := getattr(bpy.app.handlers, name), list)
        for function in functions
    ]
    types = {name for name in dir(bpy.types) if name.startswith(("PLANAR_", "Planar"))}
    return types, [module for module in handlers if module.startswith("planar_deform")]


@pytest.fixture
def _registered_again():
    import planar_deform

    yield
    planar_deform.unregister()
    planar_deform.register()


@pytest.mark.usefixtures("_registered_again")
def test_unregistering_leaves_nothing_and_registering_again_works():
    import planar_deform

    planar_deform.unregister()
    assert registered() == (set(), [])
    assert not hasattr(bpy.types.Object, "planar")
    assert "PLANAR_OT_add_pin" not in dir(bpy.types)
    planar_deform.register()
    bar()
    assert bpy.ops.planar.add_pin(location=(0.5, 0.5, 0)) == {"FINISHED"}


@pytest.mark.usefixtures("_registered_again")
def test_an_error_while_registering_undoes_the_rest_and_is_passed_on(monkeypatch):
    import planar_deform
    from planar_deform.ui.tool import pose_tool

    planar_deform.unregister()

    def fail():
        raise RuntimeError("no room")

    monkeypatch.setattr(pose_tool, "register", fail)
    with pytest.raises(RuntimeError, match="no room"):
        planar_deform.register()
    assert registered() == (set(), [])
    monkeypatch.undo()
    planar_deform.register()


@pytest.mark.usefixtures("_registered_again")
def test_unregistering_goes_on_after_failures_and_tells_of_all(monkeypatch):
    import planar_deform
    from planar_deform import events
    from planar_deform.operators.modal import running
    from planar_deform.ui.draw import quality

    planar_deform.unregister()
    done = quality.unregister

    def fail():
        done()
        raise RuntimeError("no overlay")

    class Broken:
        def give_way(self):
            raise RuntimeError("no way")

        def let_go(self):
            raise RuntimeError("no way")

    monkeypatch.setattr(quality, "unregister", fail)
    planar_deform.register()
    running.start(Broken())
    with pytest.raises(ExceptionGroup) as raised:
        planar_deform.unregister()
    assert [str(error) for error in raised.value.exceptions] == ["no way", "no overlay"]
    assert registered() == (set(), [])
    assert running.now() is None
    assert not any(handler in getattr(bpy.app.handlers, name) for name, handler in events.HANDLERS.items())
    assert not hasattr(bpy.types.Object, "planar")
    assert not hasattr(bpy.types.Mesh, "planar_version")
    monkeypatch.undo()
    planar_deform.register()


@pytest.mark.usefixtures("_registered_again")
def test_unregistering_goes_on_when_others_have_taken_parts_away():
    """As an add-on does that clears the handlers of all others."""
    import planar_deform
    from planar_deform import events
    from planar_deform.operators.modal import running

    class Run:
        ended = False

        def give_way(self):
            Run.ended = True

        def let_go(self):
            Run.ended = True

    running.start(Run())
    first = next(iter(events.HANDLERS))
    getattr(bpy.app.handlers, first).clear()
    del bpy.types.Mesh.planar_version
    with pytest.raises(ExceptionGroup) as raised:
        planar_deform.unregister()
    assert [type(error) for error in raised.value.exceptions] == [ValueError, AttributeError]
    assert registered() == (set(), [])
    assert Run.ended
    assert not hasattr(bpy.types.Object, "planar")
    planar_deform.register()


UPDATED = """
import sys
sys.path.append(sys.argv[1])
import planar_native
planar_native.build_info = lambda: {"version": "0.0.9"}
import bpy
import planar_deform
def ours():
    return [name for name in dir(bpy.types) if name.upper().startswith("PLANAR")], dir(bpy.ops.planar)
planar_deform.register()
print(ours())
planar_deform.unregister()
print(ours())
"""


def test_with_the_module_of_another_version_in_memory_only_a_restart_is_asked_for():
    import planar_deform

    command = [sys.executable, "-c", UPDATED, Path(planar_deform.__file__).parents[1]]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    told, *registered_then = done.stdout.splitlines()[-3:]  # Blender's own log comes first
    assert told.startswith("Restart Blender to finish the update of Planar Deform from version 0.0.9 to ")
    assert registered_then == ["(['PLANAR_PT_restart'], [])", "([], [])"]


def test_every_operator_has_a_description_and_a_tidy_label():
    for name in dir(bpy.ops.planar):
        rna = getattr(bpy.ops.planar, name).get_rna_type()
        assert rna.description
        assert not rna.description.endswith(".")
        small = {"as", "from", "to", "in", "the", "of"}
        assert all(word[0].isupper() or word in small for word in rna.name.split())
