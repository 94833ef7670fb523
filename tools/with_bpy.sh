#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a Python command in an environment with one version of the bpy wheel, the module and pytest: on this machine,
# or in the Debian room that has the Python which that wheel needs. There the module is the extension's, which has one
# for each Python: what is shipped is tested, and nothing compiled twice.
# usage: tools/with_bpy.sh BPY_VERSION ARGUMENTS_OF_PYTHON...
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh
version=$1
shift
case $version in
    4.2.* | 4.5.* | 5.0.*) python=3.11 room=bookworm ;;
    *) python=3.13 room=trixie ;;
esac
if [[ ! $(/usr/bin/python3 --version) == "Python $python".* ]]; then
    make --silent extension PLATFORM=linux
    exec tools/room.sh $room env EXTENSION_WHEEL="$(echo build/extension/linux-x64/*.whl)" \
        tools/with_bpy.sh "$version" "$@"
fi
tools/apt.sh "${build_packages[@]}" "${bpy_packages[@]}" "${python_test_packages[@]}"
venv=build/bpy/$version
tools/venv.sh "$venv" "bpy-$version.txt" test.txt
tools/module.sh "$venv" ${EXTENSION_WHEEL:+"$EXTENSION_WHEEL"}
"$venv/bin/python" "$@"
