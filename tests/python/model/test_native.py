# SPDX-License-Identifier: GPL-3.0-or-later
"""A compiled module that is missing or of another version is named with what to do about it."""

import subprocess
import sys

import pytest

MISSING = "sys.modules['planar_native'] = None"
OTHER = (
    "fake = sys.modules['planar_native'] = type(sys)('planar_native'); "
    "fake.build_info = lambda: {'version': '7.3.1'}"
)


@pytest.mark.parametrize(
    ("module", "expected"),
    [
        (MISSING, "install the extension file made for this system"),
        (OTHER, "found 7.3.1: remove other copies"),
    ],
)
def test_the_message_says_what_to_do(module, expected):
    code = f"import sys; sys.path[:0] = sys.argv[1:]; {module}\nimport planar_deform.native"
    result = subprocess.run(
        [sys.executable, "-c", code, *sys.path], check=False, capture_output=True, text=True
    )
    assert result.returncode == 1
    assert expected in result.stderr
