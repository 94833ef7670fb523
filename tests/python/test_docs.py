# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples in docs/module.md give what the page says they give."""

from __future__ import annotations

import doctest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "module.md"


def test_examples_of_the_module_page():
    results = doctest.testfile(str(PAGE), module_relative=False, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert results.attempted > 20  # the page is there and its examples were found
    assert results.failed == 0
