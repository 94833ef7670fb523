#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prepares a Debian 12 or 13 machine for one of the project's commands: Debian packages, the .venv with pinned
# Python packages, the compiled module in it. Each part is done only when it is missing or out of date.
# usage: tools/setup.sh demo|test|native|lint
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "Planar Deform's commands prepare a Debian 12 or 13; this is another system." >&2
    exit 1
fi
if [[ ! -e /proc/self/exe ]]; then # a bare chroot; compilers, sanitizers and Blender all read it
    mount -t proc proc /proc || { echo "Mount /proc first: mount -t proc proc /proc" >&2 && exit 1; }
fi

bpy_environment() {
    local version
    tools/apt.sh "${build_packages[@]}" "${bpy_packages[@]}"
    version=$(tools/default_bpy.sh)
    tools/venv.sh .venv common.txt
    tools/module.sh .venv --only-wheel & # while bpy is fetched
    tools/venv.sh .venv "bpy-$version.txt" "$@"
    wait $!
    tools/module.sh .venv
}

case ${1:-} in
    demo) bpy_environment demo.txt ;;
    test) tools/apt.sh "${native_test_packages[@]}" "${python_test_packages[@]}" && bpy_environment test.txt ;;
    native) tools/apt.sh "${build_packages[@]}" "${native_test_packages[@]}" ;;
    lint) tools/apt.sh "${build_packages[@]}" "${native_test_packages[@]}" "${python_test_packages[@]}" "${lint_packages[@]}" && bpy_environment test.txt lint.txt ;;
    *) sed -n 's/^# usage: /usage: /p' "$0" >&2 && exit 2 ;;
esac
