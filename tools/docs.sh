#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pictures of docs/images anew: those of the demo, then those of the tool in a Blender window.
# usage: tools/docs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
.venv/bin/python examples/demo.py --pictures docs/images
tools/window_tests.sh tools/docs_pictures.py
