#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds dist/planar_deform-VERSION-PLATFORM.zip, which installs in Blender 4.2 and newer, with a wheel of the module
# for every Python that such a Blender has: 3.11 (4.2 to 5.0), 3.13 (5.1 and newer) and that of Debian's newest one.
#
# It is compiled on Debian 12, in this machine or in its room, since a wheel needs a C library as new as the one it
# was made with. Of the other Pythons only the headers are there.
# usage: tools/build_extension.sh
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh

if [[ $(. /etc/os-release && echo "$VERSION_CODENAME") != bookworm ]]; then
    if tools/room.sh bookworm; then exec tools/room.sh bookworm tools/build_extension.sh; fi
    echo "Without the bookworm room the wheel is for this release of Debian and for newer systems only." >&2
fi
mkdir -p build/extension
exec 8>build/extension/lock # one build at a time
flock 8
tools/apt.sh "${build_packages[@]}"
tools/venv.sh build/extension/venv common.txt package.txt
/usr/bin/python3 tools/python_headers.py build/extension/headers bookworm trixie sid
build/extension/venv/bin/python tools/build_extension.py build/extension/headers
