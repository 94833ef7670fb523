#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs tests in Windows' Python under wine: those without a Blender, or the data tests, in a version of Windows' bpy.
# usage: tools/wine_tests.sh python|data BPY_VERSION [ARGUMENTS_OF_PYTEST...]
set -euo pipefail
cd "$(dirname "$0")/.."
what=$1 version=$2
shift 2
case $what in
    python) tests=tests/python ;;
    data) tests=blender_tests/data ;;
    *) sed -n 's/^# usage: /usage: /p' "$0" >&2 && exit 2 ;;
esac
exec tools/wine/with_bpy.sh "$version" -m pytest "$@" "$tests"
