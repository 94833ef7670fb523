#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the tables of the native solver's speed, what a lattice and a drag cost in Blender, and how well and fast
# the module poses, and makes in-betweens, beside others.
# usage: tools/bench.sh
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh
tools/setup.sh native
tools/apt.sh "${benchmark_packages[@]}"
( # the distribution's cmake and compiler, before a user's own
    PATH=/usr/bin:/bin:$PATH
    cmake --preset release >/dev/null
    cmake --build build/release --parallel "$(nproc)" --target planar_benchmarks
)
build/release/benchmarks/planar_benchmarks
tools/setup.sh test
.venv/bin/python blender_tests/data/dense_cost.py
.venv/bin/python blender_tests/data/follow_cost.py
.venv/bin/python blender_tests/data/lattice_cost.py
tools/window_tests.sh blender_tests/window/event_cost.py blender_tests/window/follow_cost.py
tools/figures.sh
