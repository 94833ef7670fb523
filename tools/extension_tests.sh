#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs, uses and uninstalls the built extension: in the .venv's bpy, in another version of it, or in the Blender of
# a Debian room.
# usage: tools/extension_tests.sh [BPY_VERSION|trixie|sid]
set -euo pipefail
cd "$(dirname "$0")/.."
make --silent extension PLATFORM=linux
tests=blender_tests/packaging/run.py
case ${1:-} in
    '') exec .venv/bin/python $tests ;;
    trixie | sid) exec tools/room.sh "$1" python3 $tests --blender /usr/bin/blender ;;
    *) exec tools/with_bpy.sh "$1" $tests ;;
esac
