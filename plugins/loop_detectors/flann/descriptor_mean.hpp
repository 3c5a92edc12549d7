// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"

namespace holdfast::flann_plugin {

/// The descriptor in the middle of some others: the bitwise majority of binary ones, which has the least sum of Hamming
/// distances to them (Grana et al., "A fast approach for integrating ORB descriptors in the bag of words model", SPIE
/// 8667, 2013), the mean of the numbers of others, of unit length for the cosine metric.
class DescriptorMean {
 public:
  explicit DescriptorMean(const DescriptorType& type);

  /// `descriptor`: its first unit of memory, here and below.
  void add(const Descriptor256* descriptor);
  /// Replaces `descriptor`, which stays where nothing was added, and in bits that are 0 as often as 1.
  void write(Descriptor256* descriptor) const;

 private:
  void write_majority(Descriptor256* descriptor) const;
  void write_numbers(Descriptor256* descriptor) const;

  DescriptorType type_;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> bits_set_;
  std::vector<double> sums_;
};

}  // namespace holdfast::flann_plugin
