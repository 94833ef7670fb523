# SPDX-License-Identifier: GPL-3.0-or-later
"""A compiled module that is missing or of another version is named with what to do about it."""

import subprocess
import sys

import pytest

MISSING = "sys.modules['planar_native'] = None"
EMPTY = "sys.modules['planar_native'] = type(sys)('planar_native')"  # of its folder alone
LOADED = f"{EMPTY}; sys.modules['planar_native'].build_info = lambda: {{'version': '7.3.1'}}"
ON_DISK = (
    "import pathlib, tempfile; folder = pathlib.Path(tempfile.mkdtemp()); "
    "(folder / 'planar_native.py').write_text('build_info = lambda: dict(version=\\'7.3.1\\')'); "
    "sys.path.insert(0, str(folder))"
)


@pytest.mark.parametrize(
    ("module", "expected"),
    [
        (MISSING, "install the extension file made for this system"),
        (EMPTY, "install the extension file made for this system"),
        (ON_DISK, "found 7.3.1: remove other copies"),
        (LOADED, "Restart Blender to finish the update of Planar Deform from version 7.3.1 to"),
    ],
)
def test_the_message_says_what_to_do(module, expected):
    code = f"import sys; sys.path[:0] = sys.argv[1:]; {module}\nimport planar_deform.native"
    result = subprocess.run(
        [sys.executable, "-c", code, *sys.path], check=False, capture_output=True, text=True
    )
    assert result.returncode == 1
    assert expected in result.stderr
