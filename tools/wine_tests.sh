#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs tests in Windows' Python under wine: those without a Blender, or the data tests, in a version of Windows' bpy; the
# extension's installation, use and removal in that, or an update of it; or files that are exchanged with Linux' bpy.
# usage: tools/wine_tests.sh python|data BPY_VERSION [ARGUMENTS_OF_PYTEST...]
#        tools/wine_tests.sh extension|update|exchange BPY_VERSION
set -euo pipefail
cd "$(dirname "$0")/.."
what=$1 version=$2
shift 2
case $what in
    python) tests=tests/python ;;
    data) tests=blender_tests/data ;;
    extension)
        make --silent extension PLATFORM=windows
        exec tools/wine/with_bpy.sh --bare "$version" blender_tests/packaging/run.py
        ;;
    update) exec tools/wine/with_bpy.sh --bare "$version" blender_tests/packaging/update.py ;;
    exchange)
        here=(tools/with_bpy.sh "$version")
        if [[ $(tools/default_bpy.sh) == "$version" ]]; then
            tools/setup.sh demo
            here=(.venv/bin/python)
        fi
        exec /usr/bin/python3 blender_tests/packaging/exchange.py "$version" "${here[@]}"
        ;;
    *) sed -n '/^# usage: /,/^set/{/^#/p}' "$0" >&2 && exit 2 ;;
esac
exec tools/wine/with_bpy.sh "$version" -m pytest "$@" "$tests"
