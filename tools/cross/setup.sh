#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prepares what compiles for other systems: zig and the pinned sources, in build/cross. Does nothing when all is there.
# All checkouts of a user share one zig, as it knows the C and C++ library that it has compiled for a system, which takes
# it minutes, only by the path of its own folder.
# usage: tools/cross/setup.sh PLATFORM...
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source=tools/packages.sh
source tools/packages.sh
mkdir -p build/cross
exec 8>build/cross/lock
flock 8
tools/apt.sh "${cross_packages[@]}"
tools/venv.sh build/cross/venv common.txt cross.txt
version=$(sed -n 's/^ziglang==//p' tools/requirements/zig.txt)
zig=${XDG_CACHE_HOME:-$HOME/.cache}/planar-deform/zig-$version
mkdir -p "$zig"
(
    flock 9
    [[ ! -e $zig/ziglang ]] || exit 0
    echo "Installing zig $version into $zig"
    rm -rf "$zig/partial"
    build/cross/venv/bin/python -m pip install -qq --disable-pip-version-check --no-deps --target "$zig/partial" \
        --requirement tools/requirements/zig.txt
    mv "$zig/partial/ziglang" "$zig"
    rm -r "$zig/partial"
) 9>"$zig/lock"
[[ $(readlink build/cross/zig) == "$zig" ]] || ln -sfn "$zig" build/cross/zig
/usr/bin/python3 tools/cross/sources.py "$@"
