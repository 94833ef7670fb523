#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints how well and how fast the module poses characters, beside libigl, and how good its in-betweens and lattices
# are, what each method of posing does, how surfaces are laid flat, how drawings are meshed, and how dense ones are
# posed through a cage, in an environment of its own.
# usage: tools/figures.sh [FOLDER] [--table distortion|loops|settle|inbetweens|lattice|arap|flatten|cutout|cage]
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tools/packages.sh
source tools/packages.sh
tools/apt.sh "${build_packages[@]}"
tools/venv.sh build/figures figures.txt
tools/module.sh build/figures
build/figures/bin/python benchmarks/figures.py "$@"
