#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the extension for some platforms, or all, and checks its files without running them.
# usage: tools/extension_files.sh [linux|windows|macos-arm64|macos-x64]...
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh demo # Blender's own tool judges the manifest
platforms=()
for name in "$@"; do
    make --silent extension PLATFORM="$name"
    case $name in
        linux | windows) platforms+=("$name-x64") ;;
        *) platforms+=("$name") ;;
    esac
done
if ((${#platforms[@]} == 0)); then
    make --silent extension PLATFORM=all
    platforms=(linux-x64 windows-x64 macos-arm64 macos-x64)
fi
blender_ext=$(echo .venv/lib/python3.*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py)
build/cross/venv/bin/python blender_tests/packaging/binaries.py "$blender_ext" "${platforms[@]}"
