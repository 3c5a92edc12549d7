// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::test {

constexpr float no_column = std::numeric_limits<float>::quiet_NaN();

/// A frame of 640 x 480 pixels with features on a grid of 30 px, 20 to a row, each with its own random descriptor.
inline Frame grid_frame(int count) {
  Frame frame;
  frame.camera = std::make_shared<Camera>();
  frame.pyramid = std::make_shared<ScalePyramid>();
  Random random(11);
  frame.features.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    frame.x.push_back(20.0F + 30.0F * static_cast<float>(i % 20));
    frame.y.push_back(20.0F + 30.0F * static_cast<float>(i / 20));
    frame.features.angle[static_cast<std::size_t>(i)] = 1.0F;
    for (std::uint64_t& word : frame.features.descriptors.of_256_bits()[static_cast<std::size_t>(i)].words)
      word = random.next();
  }
  frame.depth.assign(frame.size(), 0.0F);
  frame.right_x.assign(frame.size(), no_column);
  frame.map_points.assign(frame.size(), MapPointId());
  frame.static_probability.assign(frame.size(), 1.0F);
  frame.grid.build(frame.x, frame.y, {0, 0, 639, 479});
  return frame;
}

/// The descriptor with its first bits inverted, so that it is `bits` away.
inline Descriptor256 flipped(const Descriptor256& descriptor, int bits) {
  Descriptor256 result = descriptor;
  for (int i = 0; i < bits; ++i) result.words[static_cast<std::size_t>(i) / 64] ^= std::uint64_t{1} << (i % 64);
  return result;
}

}  // namespace holdfast::test
