#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs, uses and uninstalls the built extension: in the .venv's bpy, in another version of it, or in the Blender of
# a Debian room. In trixie the farm's jobs run, too; in sid, with --whole in both, Blender's window installs and updates
# it from a repository.
# usage: tools/extension_tests.sh [BPY_VERSION|trixie|sid] [--whole]
set -euo pipefail
cd "$(dirname "$0")/.."
make --silent extension PLATFORM=linux
tests=blender_tests/packaging/run.py
more=()
case ${1:-} in
    '')
        tools/setup.sh demo
        exec .venv/bin/python $tests
        ;;
    trixie)
        tools/room.sh trixie tools/venv.sh build/farm farm.txt
        [[ ${2:-} == --whole ]] && more=(--window)
        exec tools/room.sh trixie build/farm/bin/python $tests --blender /usr/bin/blender --farm "${more[@]}"
        ;;
    sid) exec tools/room.sh sid python3 $tests --blender /usr/bin/blender --window ;;
    *) exec tools/with_bpy.sh "$1" $tests ;;
esac
