#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks everything that can be checked without running it, and that the add-on registers and unregisters.
# With --changed clang-tidy reads only the sources that differ from what has landed.
# usage: tools/lint.sh [--changed]
set -euo pipefail
cd "$(dirname "$0")/.."
PATH=/usr/bin:/bin:$PATH # the distribution's clang tools, before a user's own

checks=0
failures=0
check() { # check NAME COMMAND...
    local name=$1 output
    shift
    if output=$("$@" 2>&1); then
        echo "PASS $name"
    else
        echo "FAIL $name"
        echo "$output"
        failures=$((failures + 1))
    fi
    checks=$((checks + 1))
}

mapfile -t native < <(git ls-files '*.h' '*.cc' '*.cpp')
sources=(git ls-files 'native/*.cpp')
[[ ${1:-} != --changed ]] || sources=(tools/changed_sources.py native)
compiled=$("${sources[@]}")
mapfile -t shell < <(git ls-files '*.sh' '.ci/run')
ruff=.venv/bin/ruff

check clang-format clang-format --dry-run -Werror "${native[@]}"
cmake -S . -B build/lint -DPLANAR_PYTHON=ON -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=OFF -DCMAKE_UNITY_BUILD=OFF \
    -Dpybind11_DIR="$(.venv/bin/python -m pybind11 --cmakedir)" >/dev/null # without what clang does not know of gcc
tidy() { xargs -r -n 1 -P "$(nproc)" clang-tidy --quiet -p build/lint <<<"$compiled"; }
check "clang-tidy of $(wc -w <<<"$compiled") sources" tidy
check imports .venv/bin/python tools/check_imports.py
check versions .venv/bin/python tools/release.py --check
check includes python3 tools/check_includes.py
check ruff "$ruff" check --no-cache .
check ruff-format "$ruff" format --no-cache --check .
check mypy .venv/bin/mypy
check stubs .venv/bin/python -m mypy.stubtest planar_native --allowlist native/python/stubtest-allowlist.txt
check shellcheck shellcheck --external-sources "${shell[@]}"
check registration .venv/bin/python -m pytest blender_tests/data/test_registration.py

echo
echo "$((checks - failures)) passed, $failures failed"
((failures == 0))
