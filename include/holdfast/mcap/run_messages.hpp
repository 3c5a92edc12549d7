// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/mcap/message_sink.hpp"

namespace holdfast::mcap {

/// Writes the results of a run as messages of Foxglove's schemas (docs.foxglove.dev/docs/visualization/message-schemas)
/// in JSON: poses and transforms, status and health of every frame, moving objects, images with their moving cells,
/// keyframes and static points. plugins/observers/mcap/README.md lists the topics.
///
/// The time of a message is that of the last frame. Functions throw Error if OpenCV cannot encode an image, and what
/// the sink throws. Used by one thread at a time; only add_map() may run beside the others if the sink may.
class RunMessages {
 public:
  /// Which images there are.
  struct Options {
    int image_every = 5;  ///< an image for every frame whose index is a multiple of this number; 0 = none
    int quality = 80;     ///< of JPEG images, 1 to 100
  };

  /// Adds the topics to the sink, which must outlive this object. `camera`: of the images.
  RunMessages(MessageSink& sink, const Options& options, const Camera& camera);

  void add_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result);
  /// `time`: of the last frame [s]. States of the map, and of the health, are given by MessageSink::write_state().
  void add_map(MapSnapshot map, double time);

  /// Time stamp of the last frame [s]; 0 before the first one.
  double time() const { return time_; }

 private:
  std::uint16_t add(const char* topic, const char* schema);
  /// Makes and writes a message if the sink wants one of the topic.
  template <class Make>
  void write(std::uint16_t channel, const Make& make);
  void add_images(const SensorFrame& sensor_frame, const Frame& frame);
  void add_health(const FrameHealth& health);

  MessageSink& sink_;
  Options options_;
  Camera camera_;
  double time_ = 0.0;
  std::optional<FrameHealth> health_;  // that was logged last
  std::uint16_t status_, log_, pose_, transforms_, objects_, image_, moving_, calibration_, path_, points_;
};

}  // namespace holdfast::mcap
