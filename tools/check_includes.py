#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that includes in native/ go one way: a room includes itself and the rooms named beside it, nobody
includes in a circle. A public header belongs to the room whose sources define it.

usage: tools/check_includes.py
"""

import graphlib
import re
import sys
from pathlib import Path

NATIVE = Path(__file__).resolve().parents[1] / "native"
SOURCES, PUBLIC = NATIVE / "src", NATIVE / "include" / "planar"
MAY_INCLUDE = {
    "base": set[str](),
    "parallel": {"base"},
    "linear": {"base"},
    "mesh": {"base"},
    "energy": {"base", "linear", "mesh"},
    "cage": {"base", "linear", "mesh"},
    "posing": {"base", "parallel", "linear", "mesh", "energy", "cage"},
    "inbetween": {"base", "parallel", "linear", "mesh", "energy", "cage", "posing"},
    "lattice": {"base", "parallel", "linear", "mesh", "energy"},
    "flatten": {"base", "parallel", "linear", "mesh", "energy", "posing"},
    "cutout": {"base", "mesh"},
}
PUBLIC_ROOM = {
    "planar/types.h": "base",
    "planar/build_info.h": "base",
    "planar/handle.h": "mesh",
    "planar/distortion.h": "mesh",
    "planar/akvf.h": "posing",
    "planar/arap.h": "posing",
    "planar/log_spiral.h": "posing",
    "planar/poser.h": "posing",
    "planar/inbetween.h": "inbetween",
    "planar/sequence_edit.h": "inbetween",
    "planar/transfer.h": "inbetween",
    "planar/lattice.h": "lattice",
    "planar/flatten.h": "flatten",
    "planar/harmonic.h": "flatten",
    "planar/cutout.h": "cutout",
}


def room_of(name: str) -> str:
    return PUBLIC_ROOM.get(name) or name.partition("/")[0]


def main() -> int:
    files = {str(path.relative_to(SOURCES)): path for path in SOURCES.rglob("*") if path.is_file()}
    files |= {f"planar/{path.name}": path for path in PUBLIC.iterdir()}
    wrong, headers = [], {}
    for name, path in files.items():
        included = re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE)
        headers[name] = [other for other in included if other != name]
        room = room_of(name)
        if room not in MAY_INCLUDE:
            wrong.append(f"{name}: {room} is no room of tools/check_includes.py")
            continue
        for other in included:
            if other not in files:
                wrong.append(f"{name}: no file {other}")
            elif room_of(other) not in MAY_INCLUDE[room] | {room}:
                wrong.append(f"{name}: {room} may not include {other}")
    try:
        graphlib.TopologicalSorter(headers).prepare()
    except graphlib.CycleError as error:
        wrong.append("a circle: " + " → ".join(reversed(error.args[1])))
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
