# SPDX-License-Identifier: BSD-3-Clause
# Cross-compiles for 64-bit ARM (Raspberry Pi 5, Jetson, other aarch64 boards) on Debian and its relatives:
#
#   cmake -B build-arm64 -DCMAKE_TOOLCHAIN_FILE=cmake/toolchains/aarch64-linux-gnu.cmake -DCMAKE_SYSROOT=/path/to/root
#
# The root holds the libraries for arm64; `tests/clean_root.sh arm64 root` makes it. Tests run under qemu where
# qemu-aarch64-static is installed. docs/arm.md has the steps.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)

# CMake reads this file again for each of its own trial projects.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_SYSROOT)

if(NOT CMAKE_SYSROOT)
  message(FATAL_ERROR "Cross-compiling for aarch64 needs the libraries of that system: expected "
                      "-DCMAKE_SYSROOT=FOLDER, a root that `sh tests/clean_root.sh arm64 root` makes; see docs/arm.md")
endif()

find_program(HOLDFAST_CROSS_COMPILER NAMES aarch64-linux-gnu-g++ aarch64-linux-gnu-g++-12 aarch64-linux-gnu-g++-14
             NO_CMAKE_FIND_ROOT_PATH)
if(NOT HOLDFAST_CROSS_COMPILER)
  message(FATAL_ERROR "aarch64-linux-gnu-g++ was not found; `sh cmake/install_dependencies.sh --arm64` installs it")
endif()
mark_as_advanced(HOLDFAST_CROSS_COMPILER)
set(CMAKE_CXX_COMPILER ${HOLDFAST_CROSS_COMPILER})
string(REPLACE "g++" "gcc" CMAKE_C_COMPILER ${HOLDFAST_CROSS_COMPILER})

# Programs such as cmake and python3 are those of this machine; everything else is the board's.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})

# Libraries that are only needed by libraries are searched by the linker, in Debian's folders for alternatives, too.
set(folders ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu ${CMAKE_SYSROOT}/lib/aarch64-linux-gnu)
foreach(folder IN LISTS folders)
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -Wl,-rpath-link,${folder}")
  string(APPEND CMAKE_SHARED_LINKER_FLAGS_INIT " -Wl,-rpath-link,${folder}")
endforeach()

find_program(HOLDFAST_QEMU NAMES qemu-aarch64-static qemu-aarch64 NO_CMAKE_FIND_ROOT_PATH)
mark_as_advanced(HOLDFAST_QEMU)
if(HOLDFAST_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${HOLDFAST_QEMU} -L ${CMAKE_SYSROOT})
endif()
