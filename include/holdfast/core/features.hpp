// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"

namespace holdfast {

/// Features of one image as a structure of arrays: entry i of every array belongs to feature i. Positions are raw
/// (distorted) pixels of level 0, as the extractor found them; Frame adds the undistorted positions.
struct Features {
  std::vector<float> x;              ///< raw column [px of the full image]
  std::vector<float> y;              ///< raw row [px of the full image]
  std::vector<float> angle;          ///< orientation [rad, 0 to 2 pi), from the x axis towards the y axis
  std::vector<float> response;       ///< corner strength, larger is stronger; comparable within one image only
  std::vector<std::uint8_t> octave;  ///< pyramid level
  DescriptorBlock descriptors;       ///< of the type that the extractor names

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }

  void clear() { x.clear(), y.clear(), angle.clear(), response.clear(), octave.clear(), descriptors.clear(); }
  /// Changes the number of features and the type of their descriptors.
  void resize(std::size_t count, const DescriptorType& type) {
    descriptors.reset(type, 0);
    resize(count);
  }
  /// Changes the number of features; the type of the descriptors stays.
  void resize(std::size_t count) {
    x.resize(count), y.resize(count), angle.resize(count), response.resize(count), octave.resize(count),
        descriptors.resize(count);
  }
};

}  // namespace holdfast
