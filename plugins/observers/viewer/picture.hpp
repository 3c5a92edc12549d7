// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/viewer/viewer.hpp"

namespace holdfast::viewer_plugin {

/// Collects what the viewer shows of a frame's picture. One thread.
class PictureMaker {
 public:
  explicit PictureMaker(const Camera& camera);

  /// Copies image, features and mask.
  ViewedPicture make(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) const;

  static constexpr int cell = 8;  ///< of the mask [raw pixels]

 private:
  std::vector<std::uint8_t> mask(const CoarseView& coarse) const;

  CoarseGrid grid_;
  int columns_, rows_;
  std::vector<std::int32_t> cells_;  // of the coarse view, by cell of the mask; -1 = none
};

}  // namespace holdfast::viewer_plugin
