// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace holdfast {

/// Confusion matrix of two instance label images: pixels (or cells) of each instance and of each pair. Label 0 is no
/// instance.
class InstanceOverlaps {
 public:
  void add(std::size_t first, std::size_t second) {
    if (first != 0) count(first_, first);
    if (second != 0) count(second_, second);
    if (first != 0 && second != 0) ++both_[{first, second}];
  }

  /// Number of pixels of an instance of the first image.
  double of_first(std::size_t instance) const { return instance < first_.size() ? first_[instance] : 0.0; }
  /// Intersection over union of two instances; 0 if they share no pixel.
  double iou(std::size_t first, std::size_t second) const {
    const auto shared = both_.find({first, second});
    return shared == both_.end() ? 0.0 : shared->second / (first_[first] + second_[second] - shared->second);
  }

 private:
  static void count(std::vector<double>& counts, std::size_t instance) {
    if (instance >= counts.size()) counts.resize(instance + 1, 0.0);
    ++counts[instance];
  }

  std::vector<double> first_, second_;
  std::map<std::pair<std::size_t, std::size_t>, double> both_;
};

}  // namespace holdfast
