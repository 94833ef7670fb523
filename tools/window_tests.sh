#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs window tests (all, or the files given): in a Debian room, or, without --room, in $BLENDER, else in a `blender`
# of 4.2 or newer on PATH, else in the trixie room.
# usage: tools/window_tests.sh [--room trixie|sid] [FILE...]
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh

new_enough() {
    local version
    version=$("$1" --version 2>/dev/null | sed -n 's/^Blender \([0-9.]*\).*/\1/p' | head -n 1)
    [[ -n $version && $(printf '4.2\n%s\n' "$version" | sort -V | head -n 1) == 4.2 ]]
}

make --silent extension PLATFORM=linux # the tests install it as a user does
room=
if [[ ${1:-} == --room ]]; then
    room=$2
    shift 2
fi
if [[ -z $room ]]; then
    blender=${BLENDER:-$(command -v blender || true)}
    if [[ -n $blender ]] && new_enough "$blender"; then
        tools/apt.sh "${screen_packages[@]}"
        exec python3 blender_tests/window/run.py --blender "$blender" "$@"
    fi
    if [[ -n ${BLENDER:-} ]]; then
        echo "BLENDER=$BLENDER is no Blender of version 4.2 or newer." >&2
        exit 1
    fi
    room=trixie
fi
exec tools/room.sh "$room" python3 blender_tests/window/run.py --blender /usr/bin/blender "$@"
