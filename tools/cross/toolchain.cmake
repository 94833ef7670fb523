# SPDX-License-Identifier: GPL-3.0-or-later
# zig's Clang as the compiler for another system, or for Linux with an old C library. Needs tools/cross/setup.sh.
# usage: cmake -DCMAKE_TOOLCHAIN_FILE=tools/cross/toolchain.cmake -DPLANAR_PLATFORM=linux-x64|windows-x64|macos-arm64|macos-x64
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PLANAR_PLATFORM)
if(PLANAR_PLATFORM STREQUAL "linux-x64")
  set(CMAKE_SYSTEM_NAME Linux)
  set(target x86_64-linux-gnu.2.28)
elseif(PLANAR_PLATFORM STREQUAL "windows-x64")
  set(CMAKE_SYSTEM_NAME Windows)
  set(target x86_64-windows-gnu)
elseif(PLANAR_PLATFORM STREQUAL "macos-arm64")
  set(CMAKE_SYSTEM_NAME Darwin)
  set(target aarch64-macos.11.0)
elseif(PLANAR_PLATFORM STREQUAL "macos-x64")
  set(CMAKE_SYSTEM_NAME Darwin)
  set(target x86_64-macos.10.15)
else()
  message(FATAL_ERROR "PLANAR_PLATFORM=${PLANAR_PLATFORM}: choose linux-x64, windows-x64, macos-arm64 or macos-x64")
endif()
string(REGEX REPLACE "-.*" "" CMAKE_SYSTEM_PROCESSOR ${target})
if(CMAKE_SYSTEM_NAME STREQUAL "Darwin") # zig brings the system's headers and knows its version by the target
  set(CMAKE_OSX_SYSROOT "")
  set(CMAKE_OSX_DEPLOYMENT_TARGET "")
  set(CMAKE_OSX_ARCHITECTURES "")
  set(CMAKE_INSTALL_NAME_TOOL /bin/true) # CMake asks for one, but nothing is installed
endif()

set(CMAKE_C_COMPILER ${CMAKE_CURRENT_LIST_DIR}/zig-cc)
set(CMAKE_CXX_COMPILER ${CMAKE_CURRENT_LIST_DIR}/zig-c++)
set(CMAKE_C_COMPILER_TARGET ${target})
set(CMAKE_CXX_COMPILER_TARGET ${target})
set(CMAKE_AR ${CMAKE_CURRENT_LIST_DIR}/zig-ar)
set(CMAKE_RANLIB ${CMAKE_CURRENT_LIST_DIR}/zig-ranlib)
set(CMAKE_STRIP /bin/true) # the linker does it: -s

# To ccache a script is no compiler that it knows, nor does its date tell the compiler's version. Checkouts differ in
# the folder that is mapped, but not in what comes of it.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../requirements/zig.txt zig REGEX "^ziglang==")
set(PLANAR_CCACHE_SETTINGS
  CCACHE_COMPILERTYPE=clang CCACHE_COMPILERCHECK=string:${zig} CCACHE_IGNOREOPTIONS=-ffile-prefix-map=*)

# CMake's questions are answered by compiling: the first program that is linked waits for zig's C++ library.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

# zig's linker knows no such optimization for macOS; all platforms go one way.
set(CMAKE_INTERPROCEDURAL_OPTIMIZATION OFF)

# Nothing in the result tells where it was built. The project's folder lies two above this one.
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH above)
cmake_path(GET above PARENT_PATH project)
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_INIT "-ffile-prefix-map=${project}=. -ffunction-sections -fdata-sections -fvisibility=hidden")
endforeach()
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  string(APPEND CMAKE_CXX_FLAGS_INIT " -I${CMAKE_CURRENT_LIST_DIR}/glibc")
endif()
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-s")
set(CMAKE_SHARED_LINKER_FLAGS_INIT "-s")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
