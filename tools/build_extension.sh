#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds dist/planar_deform-VERSION-PLATFORM.zip, which installs in Blender 4.2 and newer, with a wheel of the module
# for each Python that such a Blender has: 3.11 (4.2 to 5.0), 3.13 (5.1 and newer) and that of Debian's newest Blender.
#
# All are compiled on Debian 12, in this machine or in its room, since a wheel needs a C library as new as the one it
# was made with. Of the other Pythons only the headers are taken, from the Debian rooms that have them.
# usage: tools/build_extension.sh
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh
headers=build/extension/headers
venv=build/extension/venv
here=$(. /etc/os-release && echo "$VERSION_CODENAME")

in_debian() { # in_debian RELEASE COMMAND...
    local release=$1
    shift
    if [[ $release == "$here" ]]; then "$@"; else tools/room.sh "$release" "$@"; fi
}

if [[ ${1:-} == --compile ]]; then
    tools/apt.sh "${build_packages[@]}"
    tools/venv.sh $venv common.txt package.txt
    /usr/bin/python3 tools/python_headers.py $headers
    exec $venv/bin/python tools/build_extension.py $headers
fi

rm -rf $headers
mkdir -p $headers
for release in trixie sid; do
    if ! { in_debian $release tools/apt.sh python3-dev &&
        in_debian $release /usr/bin/python3 tools/python_headers.py $headers; }; then
        echo "The extension goes without a wheel for the Python of Debian $release, whose room cannot be had." >&2
    fi
done
if [[ $here != bookworm ]] && ! tools/room.sh bookworm; then
    echo "Without the bookworm room the wheels are made for this release of Debian and newer systems only." >&2
    exec "$0" --compile
fi
in_debian bookworm "$0" --compile
