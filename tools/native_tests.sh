#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the library by one of the CMake presets and runs its tests, or those whose names match a regular expression.
# clang is Debian's, with gcc's C++ library; zig is the extension's compiler, with LLVM's; what it builds for Windows runs
# under wine.
# usage: tools/native_tests.sh debug|release|eigen|tsan|clang|zig [REGEX]
#        tools/native_tests.sh asan|asan-whole|zig-windows
set -euo pipefail
cd "$(dirname "$0")/.."
PATH=/usr/bin:/bin:$PATH # the distribution's cmake and compiler, before a user's own
tools/setup.sh native
case $1 in
    clang) tools/apt.sh clang ;;
    zig) tools/cross/setup.sh linux-x64 ;;
    zig-windows) tools/cross/setup.sh windows-x64 ;;
esac
cmake --preset "$1"
# Suites that run beside each other share the cores: tools/run_suites.py.
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
cmake --build "build/$1" --parallel "$jobs"
case $1 in
    # All in one process: what one test leaves to the next is seen here, and a sanitized process takes long to start.
    asan*) "build/$1/tests/native/planar_tests" --gtest_brief=1 ;;
    # One process, too, as each takes wine seconds to start.
    zig-windows) tools/wine/run.sh "build/$1/tests/native/planar_tests.exe" --gtest_brief=1 ;;
    *) ctest --test-dir "build/$1" --parallel "$jobs" --output-on-failure --no-tests=error --tests-regex "${2:-.}" ;;
esac
