// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>

/// What Holdfast requires of a processor. cmake/HoldfastVersions.cmake checks the same when CMake configures; this
/// header also stops programs that are built on an installed Holdfast.
static_assert(
    std::endian::native == std::endian::little,
    "Holdfast needs a little-endian processor: maps, bags and depth files are read in the byte order of memory");
static_assert(sizeof(void*) == 8,
              "Holdfast needs a 64-bit system: maps and recordings exceed 32-bit addresses. On an ARM board, install "
              "the 64-bit system (aarch64)");
