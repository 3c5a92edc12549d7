// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/simd.hpp"

namespace holdfast {

/// Computes distances between descriptors of one type, with the instructions of the processor (run-time dispatch). The
/// values are the same at every SIMD level: sums of floating-point numbers are formed in one fixed order.
class DescriptorDistances {
 public:
  /// `type` must be valid; see trouble_of(). The processor must have `level`.
  explicit DescriptorDistances(const DescriptorType& type, SimdLevel level = simd_level());

  /// The distance of two descriptors, given by their first units of memory.
  float of_two(const Descriptor256* a, const Descriptor256* b) const { return two_(a, b, units_); }
  /// distances[i] = distance between the query and row i of contiguous descriptors.
  void of_rows(const Descriptor256* query, const Descriptor256* rows, std::size_t count, float* distances) const {
    rows_(query, rows, units_, count, distances);
  }
  /// distances[i] = distance between the query and row candidates[i].
  void of_candidates(const Descriptor256* query, const Descriptor256* rows, std::span<const std::uint32_t> candidates,
                     float* distances) const {
    candidates_(query, rows, units_, candidates, distances);
  }

 private:
  using Two = float (*)(const Descriptor256*, const Descriptor256*, std::size_t units);
  using Rows = void (*)(const Descriptor256*, const Descriptor256*, std::size_t units, std::size_t count, float*);
  using Candidates = void (*)(const Descriptor256*, const Descriptor256*, std::size_t units,
                              std::span<const std::uint32_t>, float*);

  template <class Kernel>
  void use(SimdLevel level);

  std::size_t units_;
  Two two_ = nullptr;
  Rows rows_ = nullptr;
  Candidates candidates_ = nullptr;
};

/// distances[i] = distance between descriptor `query` of `queries` and descriptor candidates[i] of `references`, which
/// are of comparable types.
inline void descriptor_distances(const DescriptorView& queries, std::size_t query, const DescriptorView& references,
                                 std::span<const std::uint32_t> candidates, float* distances) {
  DescriptorDistances(references.type()).of_candidates(queries.row(query), references.row(0), candidates, distances);
}

}  // namespace holdfast
