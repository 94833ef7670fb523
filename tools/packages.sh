# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash disable=SC2034
# The Debian packages that each part of the work needs (bookworm, trixie and sid have them under these names).

# A Python environment, and what builds the library and the module into it.
build_packages=(
    python3-dev python3-venv g++ ccache cmake make ninja-build
    libsuitesparse-dev libblas3 liblapack3 libeigen3-dev libcgal-dev
)
# The extension, whose compiler is PyPI's.
cross_packages=(python3-venv ccache cmake ninja-build libeigen3-dev libcgal-dev)
# What the bpy wheels load, though they draw no window.
bpy_packages=(libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libxext6 libgl1)
# What runs Windows' programs.
wine_packages=(wine64)
# The library's tests and benchmarks.
native_test_packages=(libgtest-dev libbenchmark-dev)
# What CHOLMOD's own numbers, which the benchmarks stand beside, need to be fast.
benchmark_packages=(libopenblas0-pthread)
lint_packages=(clang-format clang-tidy libomp-dev shellcheck)
# What the tests without a Blender call.
python_test_packages=(git)
# A screen to open a window on, and pictures of it.
screen_packages=(xvfb xauth libgl1-mesa-dri imagemagick)
# Debian's own Blender. Without the last two 5.2's own extension add-on logs an import error.
blender_packages=(blender python3-numpy 'python3-cattrs|python3-cattr' python3-requests)
