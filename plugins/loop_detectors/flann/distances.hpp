// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "holdfast/core/descriptor.hpp"

namespace holdfast::flann_plugin {

/// Hamming distances with the processor's own count of bits where it has one; same values everywhere.
struct DistanceKernels {
  int (*of_two)(const Descriptor& a, const Descriptor& b);
  /// distances[i] = distance of query and descriptors[i], for descriptors that lie side by side.
  void (*of_row)(const Descriptor& query, const Descriptor* descriptors, std::size_t count, std::uint16_t* distances);
};

/// Those of this processor, as simd_level() says.
DistanceKernels distance_kernels();

}  // namespace holdfast::flann_plugin
