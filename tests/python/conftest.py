# SPDX-License-Identifier: GPL-3.0-or-later
"""What every test without a Blender has in common: small stacks."""

import ctypes
import sys

STACK = 512 * 1024  # of a thread; macOS gives no more, where Linux gives 8 MiB

if sys.platform == "linux":
    _libc = ctypes.CDLL(None)
    _attributes = ctypes.create_string_buffer(64)  # pthread_attr_t
    _libc.pthread_attr_init(_attributes)
    _libc.pthread_attr_setstacksize(_attributes, ctypes.c_size_t(STACK))
    if _libc.pthread_setattr_default_np(_attributes) != 0:
        raise RuntimeError("the size of stacks cannot be set")
