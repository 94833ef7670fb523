#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the library by one of the CMake presets and runs its tests, or those whose names match a regular expression.
# usage: tools/native_tests.sh debug|release|eigen|asan|asan-whole|tsan [REGEX]
set -euo pipefail
cd "$(dirname "$0")/.."
PATH=/usr/bin:/bin:$PATH # the distribution's cmake and compiler, before a user's own
tools/setup.sh native
cmake --preset "$1"
# Suites that run beside each other share the cores: tools/run_suites.py.
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
cmake --build "build/$1" --parallel "$jobs"
ctest --test-dir "build/$1" --parallel "$jobs" --output-on-failure --no-tests=error --tests-regex "${2:-.}"
