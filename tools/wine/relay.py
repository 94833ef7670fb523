#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run wine, and pass on what its program prints, without carriage returns, until that ends.

Not until the pipe ends: what wine starts beside it, its explorer, say, holds that as long as anything runs.
Processes that wine leaves to nobody come to this one, so that their processor time counts as its own.

usage: relay.py WINE PROGRAM.exe ARGUMENTS...
"""

import ctypes
import os
import select
import subprocess
import sys

PR_SET_CHILD_SUBREAPER = 36  # of linux/prctl.h


def main() -> int:
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    reading, writing = os.pipe()
    process = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=writing, stderr=writing)
    os.close(writing)
    while True:
        ready = select.select([reading], [], [], 0.1 if process.returncode is None else 0.0)[0]
        data = os.read(reading, 1 << 16) if ready else b""
        if data:
            sys.stdout.buffer.write(data.replace(b"\r", b""))
            sys.stdout.buffer.flush()
        elif process.returncode is not None:
            return process.returncode
        while process.returncode is None:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if pid == process.pid:
                process.returncode = os.waitstatus_to_exitcode(status)
            elif pid == 0:
                break


if __name__ == "__main__":
    sys.exit(main())
