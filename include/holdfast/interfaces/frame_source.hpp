// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// A frame that could not be used and was left out because the user allowed it (`on_bad_frame: skip`).
struct SkippedFrame {
  std::uint64_t index = 0;
  double timestamp = 0.0;
  std::string reason;  ///< names the file
};

/// What a source offers, known before its first frame.
struct SourceDescription {
  std::string name;  ///< of the sequence, for titles
  bool has_depth = false;
  bool has_object_masks = false;             ///< FrameTruth::object_mask and class_labels
  std::vector<std::string> class_names;      ///< of class_labels, by index
  std::optional<std::uint64_t> frame_count;  ///< nothing for an endless source
  std::optional<Camera> camera;  ///< the source's own camera, when it knows it better than the configuration
};

/// Where frames come from: a recording, a simulation, a camera. Frames come in the order of their time stamps, which
/// rise strictly. Used by one thread.
class FrameSource : public Module {
 public:
  static constexpr const char* kind = "source";

  virtual SourceDescription describe() const = 0;
  /// The next frame, or nothing at the end. Throws InputError, naming the file, for a frame that cannot be used, unless
  /// the source was told to skip and count those.
  virtual std::optional<SensorFrame> next() = 0;
  /// True poses, sorted by stamp (not necessarily the frames' stamps); empty when not known.
  virtual Trajectory truth() const { return {}; }
  /// Frames left out so far.
  virtual std::vector<SkippedFrame> skipped() const { return {}; }
};

}  // namespace holdfast
