// SPDX-License-Identifier: GPL-3.0-or-later
// By this header, if it is there, CGAL asks whether a process has one thread only. glibc 2.28 does not have
// it, and zig's stops the compiler then. The answer is that there may be others.
#pragma once
constexpr char __libc_single_threaded = 0;
