#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the bpy that belongs to the distribution's own Python: the oldest that we support where there is a choice,
# so that what it saves opens everywhere.
set -euo pipefail
case $(/usr/bin/python3 --version) in
    "Python 3.11."*) echo 4.2.23 ;;
    "Python 3.13."*) echo 5.2.3 ;;
    *) echo "Blender comes as a module for Python 3.11 and 3.13 (Debian 12, 13); /usr/bin/python3 is neither." >&2 && exit 1 ;;
esac
