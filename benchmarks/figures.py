#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print how well and how fast "hold" poses characters, beside AKVF and libigl's SLIM and ARAP, how good the
in-betweens of these poses are, beside the printed form and a polar blend, how lattices pose, beside the
printed form, how ARAP does beside the other methods, how surfaces are laid flat, beside libigl, how drawings
are meshed, and how dense ones are posed through a cage, in one run.

Exits with 1 when one of the printed conditions fails. tools/figures.sh runs it with all it needs.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from figures_arap import arap_table
from figures_cage import cage_table
from figures_cutout import cutout_table
from figures_data import bent_bar, read_shape
from figures_flatten import flatten_table
from figures_inbetweens import inbetween_table
from figures_lattice import lattice_table
from figures_posing import distortion_table, loop_table, settle_table

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"

TABLES = {
    "distortion": distortion_table,
    "loops": loop_table,
    "settle": settle_table,
    "inbetweens": inbetween_table,
    "lattice": lattice_table,
    "arap": arap_table,
    "flatten": flatten_table,
    "cutout": cutout_table,
    "cage": cage_table,
}
# Those that have something to measure without characters.
BAR_TOO = ("settle", "inbetweens", "arap", "flatten", "cutout", "cage")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        default=SHARED,
        help="characters: *.obj, poses in *.json; drawings: *.png, images/*.png (default: %(default)s)",
    )
    parser.add_argument("--table", choices=TABLES, help="only this one")
    arguments = parser.parse_args()
    characters = [read_shape(path) for path in sorted(arguments.folder.glob("*.obj"))]
    if not characters:
        print(f"No characters (*.obj) in {arguments.folder}: only the bar is measured.\n")
    given = {"settle": [bent_bar(), *characters], "cutout": arguments.folder}
    results = [
        table(given.get(name, characters))
        for name, table in TABLES.items()
        if arguments.table in (None, name) and (characters or name in BAR_TOO)
    ]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
