#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run wine, and pass on what its program prints, without carriage returns, until that ends.

Not until the pipe ends: what wine starts beside it, its explorer, say, holds that as long as anything runs.

usage: relay.py WINE PROGRAM.exe ARGUMENTS...
"""

import os
import select
import subprocess
import sys


def main() -> int:
    reading, writing = os.pipe()
    process = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=writing, stderr=writing)
    os.close(writing)
    ended = False
    while True:
        ready = select.select([reading], [], [], 0.0 if ended else 0.1)[0]
        data = os.read(reading, 1 << 16) if ready else b""
        if data:
            sys.stdout.buffer.write(data.replace(b"\r", b""))
            sys.stdout.buffer.flush()
        elif ended:
            return process.returncode
        ended = process.poll() is not None


if __name__ == "__main__":
    sys.exit(main())
