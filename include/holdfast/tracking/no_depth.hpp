// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "holdfast/tracking/depth_provider.hpp"

namespace holdfast {

/// No depth: frames of one camera.
class NoDepth final : public DepthProvider {
 public:
  bool features_have_depth() const override { return false; }
  cv::Mat begin(const SensorFrame&, const cv::Mat&) override { return {}; }
  void read(const SensorFrame&, Frame& frame) override {
    frame.depth.assign(frame.size(), 0.0F);
    frame.right_x.assign(frame.size(), std::numeric_limits<float>::quiet_NaN());
  }
};

}  // namespace holdfast
