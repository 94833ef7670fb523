#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds dist/planar_deform-VERSION-PLATFORM.zip, which installs in Blender 4.2 and newer, with a wheel of the module
# for every Python that such a Blender has: 3.11 (4.2 to 5.0), 3.13 (5.1 and newer) and, on Linux, that of Debian's
# newest one. All platforms together also make one zip for all of them.
#
# It is compiled on Debian 12, in this machine or in its room, since CGAL, boost and Eigen come from there.
# usage: tools/build_extension.sh [all|linux|windows|macos-arm64|macos-x64]
set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-all} in
    all) platforms=(linux-x64 windows-x64 macos-arm64 macos-x64) ;;
    linux | windows) platforms=("$1-x64") ;;
    macos-arm64 | macos-x64) platforms=("$1") ;;
    *) sed -n 's/^# usage: /usage: /p' "$0" >&2 && exit 2 ;;
esac
if [[ $(. /etc/os-release && echo "$VERSION_CODENAME") != bookworm ]]; then
    if tools/room.sh bookworm; then exec tools/room.sh bookworm tools/build_extension.sh "$@"; fi
    echo "Without the bookworm room the result depends on this system's CGAL, boost and Eigen." >&2
fi
mkdir -p build/extension
exec 7>build/extension/lock # one build at a time
flock 7
tools/cross/setup.sh "${platforms[@]}"
build/cross/venv/bin/python tools/build_extension.py "${platforms[@]}"
