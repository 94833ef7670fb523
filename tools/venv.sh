#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a virtual environment of the distribution's own Python and installs requirement files into it; does
# nothing when that was done before. A user's other Pythons (pyenv, conda) have no part in it.
# usage: tools/venv.sh DIRECTORY REQUIREMENTS.txt...
set -euo pipefail
venv=$(realpath -m "$1")
shift
cd "$(dirname "$0")/requirements"

stamp=$(cat "$@" common.txt | sha256sum)
python=$(/usr/bin/python3 --version)
mkdir -p ../../build
exec 9>../../build/venv.lock
flock 9
if [[ ! -x $venv/bin/python || "$("$venv/bin/python" --version 2>&1)" != "$python" ]]; then
    echo "Making $venv ($python)"
    /usr/bin/python3 -m venv --clear "$venv"
fi
# One stamp a set of files, so that `make demo` after `make test` installs nothing.
mark=$venv/.installed-$(basename -s .txt -a "$@" | paste -sd +)
if [[ -f $mark && $(<"$mark") == "$stamp" ]]; then
    exit 0
fi
echo "Installing into $venv: $*"
"$venv/bin/python" -m pip install -qq --disable-pip-version-check "${@/#/--requirement=}"
echo "$stamp" >"$mark"
