#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prepares what compiles for other systems: zig and the pinned sources, in build/cross. Does nothing when all is there.
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
/usr/bin/python3 tools/cross/sources.py "$@"
