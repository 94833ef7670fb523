# SPDX-License-Identifier: GPL-3.0-or-later
"""The conditions that a table of figures prints and checks."""

from __future__ import annotations


class Conditions:
    """The conditions of one table: how many there were and which failed."""

    def __init__(self) -> None:
        self.count = 0
        self.failed: list[str] = []

    def check(self, name: str, holds: bool) -> None:
        self.count += 1
        if not holds:
            self.failed.append(name)

    def conclude(self) -> bool:
        print(f"{self.count - len(self.failed)} of {self.count} conditions hold", flush=True)
        for name in self.failed:
            print(f"FAILED: {name}")
        print()
        return not self.failed
