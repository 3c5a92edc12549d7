// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

/// Watches a run. Every method does nothing unless overridden. In sequential mode all are called by the thread that
/// feeds frames; arguments are valid during the call only. An observer must not change anything.
class Observer : public Module {
 public:
  static constexpr const char* kind = "observers";

  /// After each frame, by the tracking thread.
  virtual void on_frame(const SensorFrame&, const Frame&, const FrameResult&) {}
  /// After a keyframe entered the map and local mapping worked on it, by the mapping thread.
  virtual void on_keyframe(KeyFrameId, const Map&) {}
  /// After a loop was closed between two keyframes, by the loop closing thread.
  virtual void on_loop(KeyFrameId, KeyFrameId, const Map&) {}
  /// Once at the end of the run, when all work is done, by the thread that ends it.
  virtual void on_finish(const Map&) {}
};

}  // namespace holdfast
