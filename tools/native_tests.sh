#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the library by one of the CMake presets and runs its tests.
# usage: tools/native_tests.sh debug|release|eigen|asan
set -euo pipefail
cd "$(dirname "$0")/.."
PATH=/usr/bin:/bin:$PATH # the distribution's cmake and compiler, before a user's own
tools/setup.sh native
cmake --preset "$1"
cmake --build "build/$1" --parallel "$(nproc)"
ctest --test-dir "build/$1" --output-on-failure --no-tests=error
