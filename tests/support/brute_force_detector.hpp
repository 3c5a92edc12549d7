// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/interfaces/loop_detector.hpp"

namespace holdfast::test {

/// Compares the query with all it knows: slow, and right by definition.
class BruteForceDetector final : public LoopDetector {
 public:
  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override {
    places_.emplace_back(keyframe,
                         std::vector<Descriptor256>(descriptors.row(0), descriptors.row(0) + descriptors.size()));
  }
  void remove(KeyFrameId keyframe) override {
    std::erase_if(places_, [&](const auto& place) { return place.first == keyframe; });
  }
  std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const override {
    std::vector<PlaceMatch> matches;
    for (const auto& [keyframe, known] : places_) {
      int alike = 0;
      for (std::size_t i = 0; i < descriptors.size(); i += 3)
        alike += std::any_of(known.begin(), known.end(), [&](const Descriptor256& other) {
          return hamming_distance(*descriptors.row(i), other) < 40;
        });
      matches.push_back({keyframe, static_cast<double>(alike) / static_cast<double>(descriptors.size())});
    }
    std::stable_sort(matches.begin(), matches.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    if (static_cast<int>(matches.size()) > max_count) matches.resize(static_cast<std::size_t>(max_count));
    return matches;
  }
  std::size_t size() const { return places_.size(); }
  void clear() { places_.clear(); }

 private:
  std::vector<std::pair<KeyFrameId, std::vector<Descriptor256>>> places_;
};

}  // namespace holdfast::test
