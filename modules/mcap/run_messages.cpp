// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mcap/run_messages.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "foxglove_messages.hpp"

namespace holdfast::mcap {

namespace {

/// The axes of `map` in terms of those of `world`: x forwards, y left, z up.
Eigen::Isometry3d T_map_world() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

std::uint64_t nanoseconds(double time) { return static_cast<std::uint64_t>(std::llround(std::max(time, 0.0) * 1e9)); }

}  // namespace

RunMessages::RunMessages(MessageSink& sink, const Options& options, const Camera& camera)
    : sink_(sink),
      options_(options),
      camera_(camera),
      status_(add("/status", "holdfast.FrameStatus")),
      log_(add("/log", "foxglove.Log")),
      pose_(add("/camera/pose", "foxglove.PoseInFrame")),
      transforms_(add("/tf", "foxglove.FrameTransform")),
      objects_(add("/objects", "foxglove.SceneUpdate")),
      image_(add("/camera/image", "foxglove.CompressedImage")),
      moving_(add("/camera/moving", "foxglove.CompressedImage")),
      calibration_(add("/camera/calibration", "foxglove.CameraCalibration")),
      path_(add("/map/keyframes", "foxglove.PosesInFrame")),
      points_(add("/map/points", "foxglove.PointCloud")) {}

std::uint16_t RunMessages::add(const char* topic, const char* schema) {
  return sink_.add_channel({topic, "json", schema, "jsonschema", schema_document(schema)});
}

template <class Make>
void RunMessages::write(std::uint16_t channel, const Make& make) {
  if (!sink_.wants(channel)) return;
  sink_.write(channel, nanoseconds(time_), make().dump());
}

void RunMessages::add_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) {
  const double time = time_ = result.timestamp;
  write(status_, [&] { return status_message(result); });
  add_health(result.health);
  write(transforms_, [&] { return transform_message(time, map_frame, world_frame, T_map_world()); });
  if (result.T_world_camera) {
    write(pose_, [&] { return pose_message(time, *result.T_world_camera); });
    write(transforms_, [&] { return transform_message(time, world_frame, camera_frame, *result.T_world_camera); });
  }
  if (!result.objects.empty()) write(objects_, [&] { return objects_message(time, result.objects); });
  if (options_.image_every != 0 && sensor_frame.index % static_cast<std::uint64_t>(options_.image_every) == 0)
    add_images(sensor_frame, frame);
}

void RunMessages::add_images(const SensorFrame& sensor_frame, const Frame& frame) {
  if (!sensor_frame.colour.empty()) {
    write(image_, [&] { return image_message(time_, sensor_frame.colour, options_.quality); });
    write(calibration_, [&] { return calibration_message(time_, camera_); });
  }
  if (frame.coarse.grid.size() > 0) write(moving_, [&] { return moving_message(time_, frame.coarse); });
}

void RunMessages::add_health(const FrameHealth& health) {
  const bool is_new = !health_ || health_->state != health.state || !(health_->reasons == health.reasons);
  health_ = health;
  if (is_new)
    sink_.write_state(log_, nanoseconds(time_), [time = time_, health] { return log_message(time, health).dump(); });
}

void RunMessages::add_map(MapSnapshot map, double time) {
  const auto shared = std::make_shared<const MapSnapshot>(std::move(map));
  sink_.write_state(path_, nanoseconds(time), [=] { return path_message(time, shared->keyframes).dump(); });
  sink_.write_state(points_, nanoseconds(time), [=] { return cloud_message(time, shared->points).dump(); });
}

}  // namespace holdfast::mcap
