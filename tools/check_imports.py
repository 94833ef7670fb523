#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that no module of the add-on imports anything against the tables below, and none in a circle.

Imports in functions and for type checking alone count, too: they tie modules together as well.

usage: tools/check_imports.py
"""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "addon" / "planar_deform"

BLENDER = frozenset(("blf", "bmesh", "bpy", "bpy_extras", "gpu", "gpu_extras", "mathutils"))
NATIVE = frozenset(("planar_native",))
# The package's rooms, with what each may import of the others and of what is named above. Everything else,
# which is Python's own modules and NumPy, is free to all.
MAY_IMPORT = {
    "errors": frozenset[str](),
    "native": NATIVE | {"errors"},
    "compat": BLENDER,
    "model": frozenset(("native",)),
    "scene": BLENDER | {"compat", "errors", "native", "model"},
    "operators": BLENDER | {"compat", "errors", "native", "model", "scene"},
    "preferences": BLENDER | {"model"},
    "ui": BLENDER | {"compat", "errors", "model", "preferences", "scene"},
    "batch": BLENDER | {"errors", "native", "scene"},
    "events": BLENDER | {"compat", "errors", "model", "operators", "scene"},
    "registration": BLENDER | {"batch", "errors", "events", "operators", "preferences", "scene", "ui"},
    "updating": BLENDER | {"compat", "errors"},  # and registration, by its name once that can be imported
    "__init__": frozenset(("updating",)),
}
# What is in these rooms may import what comes before it there.
ORDER = {
    "model": [
        "__init__",
        "work",
        "latest",
        "plane",
        "posing",
        "lattice",
        "flatten",
        "image",
        "timing",
        "input",
    ],
    "scene": [
        *(
            "__init__",
            "storage",
            "sequence",
            "objects",
            "pins",
            "lattice",
            "flatten",
            "image",
            "view",
            "inbetweens",
            "motion",
        ),
        *("telling", "pin_properties", "properties", "follow"),
    ],
}

Imports = dict[
    str, set[str]
]  # by module: modules of the package ("scene.pins.pin_list"), and those named above


def imports_of(package: Path) -> Imports:
    """What each module of a package imports, anywhere in it."""
    files = {file.relative_to(package).with_suffix(""): file for file in package.rglob("*.py")}
    modules = {".".join(path.parts): ast.parse(file.read_text()) for path, file in files.items()}
    return {
        module: {name for node in ast.walk(tree) for name in _named(node, module, set(modules))}
        for module, tree in modules.items()
    }


def _named(node: ast.AST, module: str, modules: set[str]) -> Iterator[str]:
    """What a statement of a module imports."""
    if isinstance(node, ast.Import):
        yield from {alias.name.partition(".")[0] for alias in node.names} & (BLENDER | NATIVE)
    elif isinstance(node, ast.ImportFrom) and not node.level:
        yield from {(node.module or "").partition(".")[0]} & (BLENDER | NATIVE)
    elif isinstance(node, ast.ImportFrom):
        source = [*module.split(".")[: -node.level], *(node.module or "").split(".")]
        for alias in node.names:
            base = [part for part in source if part]
            inner = [*base, alias.name]
            candidates = (inner, [*inner, "__init__"], base, [*base, "__init__"])
            yield next(name for parts in candidates if (name := ".".join(parts)) in modules)


def faults(imports: Imports) -> list[str]:
    """What is wrong, a line each."""
    return [*_against_the_tables(imports), *_circles(imports)]


def _against_the_tables(imports: Imports) -> Iterator[str]:
    for module, names in sorted(imports.items()):
        room, place = _place(module)
        order = ORDER.get(room)
        if room not in MAY_IMPORT or (order is not None and place not in order):
            yield f"{module}: has no place in the tables of tools/check_imports.py"
            continue
        for name in sorted(names):
            other, other_place = _place(name)
            if other != room:
                allowed = other in MAY_IMPORT[room]
            else:
                allowed = order is None or other_place in order[: order.index(place) + 1]
            if not allowed:
                yield f"{module}: must not import {name}"


def _place(module: str) -> tuple[str, str]:
    """The room of a module, and what it is in there."""
    room, *inner = module.split(".")
    return room, inner[0] if inner else ""


def _circles(imports: Imports) -> Iterator[str]:
    """Circles of imports, at least one where there are any."""
    done: set[str] = set()

    def walk(path: list[str]) -> Iterator[str]:
        for name in sorted(imports.get(path[-1], ())):
            if name in path:
                yield "circle: " + " → ".join([*path[path.index(name) :], name])
            elif name not in done:
                yield from walk([*path, name])
        done.add(path[-1])

    for module in sorted(imports):
        if module not in done:
            yield from walk([module])


def main() -> int:
    found = faults(imports_of(PACKAGE))
    for fault in found:
        print(fault)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
