#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copy the C headers of the Python that runs this, and the suffix of its modules, to DIRECTORY/cpXY.

usage: python_headers.py DIRECTORY
"""

import shutil
import sys
import sysconfig
from pathlib import Path

target = Path(sys.argv[1]) / f"cp{sys.version_info.major}{sys.version_info.minor}"
shutil.rmtree(target, ignore_errors=True)
shutil.copytree(sysconfig.get_path("include"), target)
# Debian's pyconfig.h only chooses among those of several processors, which are elsewhere.
machine = sysconfig.get_config_var("MULTIARCH")
shutil.copy(f"/usr/include/{machine}/python{sysconfig.get_python_version()}/pyconfig.h", target)
(target / "module-suffix").write_text(sysconfig.get_config_var("EXT_SUFFIX"))
