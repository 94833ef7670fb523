#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a program for Windows under wine, which is installed and gets a home in build/wine/prefix when first used.
# Its output goes through a pipe: wine 8 gives Python no files to write to.
# usage: tools/wine/run.sh PROGRAM.exe ARGUMENTS...
set -euo pipefail
project=$(realpath "$(dirname "$0")/../..")
# shellcheck source=tools/packages.sh
source "$project/tools/packages.sh"
"$project/tools/apt.sh" "${wine_packages[@]}" >&2
export WINEPREFIX=$project/build/wine/prefix WINEDEBUG=-all
wine=/usr/lib/wine/wine64
mkdir -p "$project/build/wine"
(
    flock 9
    [[ -e $WINEPREFIX/.made ]] && exit
    # What it starts beside it must not hold the lock, and has to end before programs start: else its desktop ends
    # under them, and the next one holds the pipe of whichever asks for it.
    "$wine" wineboot --init </dev/null >"$WINEPREFIX.log" 2>&1 9>&-
    /usr/lib/wine/wineserver64 --wait
    touch "$WINEPREFIX/.made"
) 9>"$project/build/wine/prefix.lock"
exec "$project/tools/wine/relay.py" "$wine" "$@"
