#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds planar_native's wheel for a virtual environment's Python and installs it there; does nothing when the
# sources have not changed. The wheel is built once per distribution and Python, whichever environments ask. A WHEEL
# that is given is installed instead.
# usage: tools/module.sh VENV [WHEEL | --only-wheel]
set -euo pipefail
cd "$(dirname "$0")/.."
venv=$(realpath "$1")
PATH=/usr/bin:/bin:$PATH # the distribution's cmake and compiler, before a user's own

install() { # install STAMP WHEEL
    [[ ! -f $venv/.module || $(<"$venv/.module") != "$1" ]] || return 0
    "$venv/bin/python" -m pip install -qq --disable-pip-version-check --no-deps --force-reinstall "$2"
    echo "$1" >"$venv/.module"
}
if [[ -n ${2:-} && $2 != --only-wheel ]]; then
    install "$(sha256sum "$2")" "$2"
    exit
fi

stamp=$(find CMakeLists.txt CMakePresets.json pyproject.toml native -type f ! -name '*.pyc' -print0 |
    sort -z | xargs -0 sha256sum | sha256sum)
tag=$(. /etc/os-release && echo "$VERSION_CODENAME")-$("$venv/bin/python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
wheels=build/module/$tag
mkdir -p "$wheels"
exec 9>"$wheels/.lock"
flock 9

if [[ ! -f $wheels/.stamp || $(<"$wheels/.stamp") != "$stamp" ]]; then
    echo "Building planar_native ($tag)"
    rm -f "$wheels"/*.whl
    # The compiler under the name that CMake has for it elsewhere, so that ccache knows its objects.
    CXX=/usr/bin/c++ "$venv/bin/python" -m pip wheel -qq --disable-pip-version-check --no-build-isolation --no-deps \
        --config-settings=build-dir="build/module-$tag" --wheel-dir "$wheels" .
    echo "$stamp" >"$wheels/.stamp"
fi
[[ ${2:-} == --only-wheel ]] || install "$stamp" "$wheels"/*.whl
