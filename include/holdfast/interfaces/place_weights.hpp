// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/feature_label.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

/// Weights of features in place recognition by the class of their pixel: LoopDetector::class_weights() for the labels
/// of a segmenter. What changes from visit to visit (chairs, what a screen shows) should count little, what stays
/// (walls, cupboards, tables) fully. Features without a label count fully. Immutable; any thread.
class PlaceWeights {
 public:
  /// All features count fully.
  PlaceWeights() { of_label_.fill(1.0F); }
  /// `classes`: names by label. Classes that are not among them have no label, and no effect.
  PlaceWeights(const LoopDetector& detector, const std::vector<std::string>& classes) : PlaceWeights() {
    for (const auto& [name, weight] : detector.class_weights()) {
      const auto found = std::find(classes.begin(), classes.end(), name);
      if (found == classes.end() || found - classes.begin() >= CellMask::unknown) continue;
      of_label_[static_cast<std::size_t>(found - classes.begin())] = static_cast<float>(weight);
      are_uniform_ = are_uniform_ && weight == 1.0;
    }
  }

  /// Whether all features count fully, so that nothing needs to be weighted.
  bool are_uniform() const { return are_uniform_; }
  float of(std::uint8_t label) const { return of_label_[label]; }
  /// 1 for each label with a weight below 0.5, whose pixels global descriptors leave out; empty if there is none.
  std::vector<std::uint8_t> minor_labels() const {
    std::vector<std::uint8_t> labels(of_label_.size(), 0);
    bool is_any = false;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (of_label_[i] < 0.5F) labels[i] = 1, is_any = true;
    if (!is_any) labels.clear();
    return labels;
  }
  /// Weights of the static features of a frame, in the order of static_descriptors(); empty if all count fully.
  std::vector<float> of_static_features(const Frame& frame) const {
    std::vector<float> weights;
    if (are_uniform_) return weights;
    weights.reserve(frame.size());
    for (std::size_t i = 0; i < frame.size(); ++i)
      if (is_static(frame, i)) weights.push_back(of(feature_label(frame, i)));
    return weights;
  }

 private:
  std::array<float, CellMask::unknown + 1> of_label_;
  bool are_uniform_ = true;
};

}  // namespace holdfast
