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

in_debian() { # in_debian RELEASE COMMAND...
    local release=$1
    shift
    if [[ $(. /etc/os-release && echo "$VERSION_CODENAME") == "$release" ]]; then
        "$@"
    else
        tools/room.sh "$release" "$@"
    fi
}

if [[ ${1:-} == --compile ]]; then # the part that runs on Debian 12
    tools/apt.sh "${build_packages[@]}"
    tools/venv.sh $venv common.txt package.txt
    exec $venv/bin/python tools/build_extension.py $headers
fi

rm -rf $headers
mkdir -p $headers
for release in trixie sid; do
    in_debian $release tools/apt.sh python3-dev &&
        in_debian $release /usr/bin/python3 tools/python_headers.py $headers ||
        echo "The extension goes without a wheel for the Python of Debian $release, whose room cannot be had." >&2
done
in_debian bookworm "$0" --compile
