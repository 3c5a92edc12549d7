// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "holdfast/core/descriptor.hpp"

namespace holdfast::flann_plugin {

/// Hamming distances with the popcnt instruction of the processor if available; the values are the same everywhere.
struct DistanceKernels {
  int (*of_two)(const Descriptor& a, const Descriptor& b);
  /// distances[i] = distance between query and descriptors[i], for contiguous descriptors.
  void (*of_row)(const Descriptor& query, const Descriptor* descriptors, std::size_t count, std::uint16_t* distances);
};

/// The kernels of this processor according to simd_level().
DistanceKernels distance_kernels();

}  // namespace holdfast::flann_plugin
