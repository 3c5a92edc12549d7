// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "holdfast/bridge/messages.hpp"
#include "holdfast/core/frame_health.hpp"

namespace holdfast::bridge {

/// What the bridge has counted since it began.
struct BridgeCounts {
  std::uint64_t colour = 0, depth = 0, right = 0, inertia = 0;  ///< messages that came
  std::uint64_t unusable = 0;                                   ///< messages and frames that were refused
  std::uint64_t unpaired = 0;                                   ///< colour images without a partner
  std::uint64_t dropped = 0;                                    ///< frames that waited too long
  std::uint64_t answered = 0;                                   ///< frames with a result
  std::uint64_t with_pose = 0;
  std::uint64_t late = 0;        ///< answers later than the period of the camera
  double latency = 0.0;          ///< of the last answer [s]
  double largest_latency = 0.0;  ///< [s]
};

/// What a diagnosis is made from.
struct BridgeStatus {
  BridgeCounts counts;
  bool is_paused = false;
  bool needs_camera = false;             ///< neither the configuration nor a message has told the camera
  std::string failure;                   ///< why there is no pipeline, or the last exception of it
  std::optional<PipelineHealth> health;  ///< of the pipeline, if there is one
  std::size_t keyframes = 0;             ///< that were added; some are removed later
};

/// What an operator should know first, and all numbers.
Diagnostics diagnose(const BridgeStatus& status);

}  // namespace holdfast::bridge
