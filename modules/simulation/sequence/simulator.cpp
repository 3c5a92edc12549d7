// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::simulation {

namespace {
cv::Mat look_up(const cv::Mat& object_ids, const std::vector<std::uint8_t>& values) {
  cv::Mat result(object_ids.size(), CV_8UC1);
  for (int y = 0; y < object_ids.rows; ++y) {
    const auto* in = object_ids.ptr<std::uint16_t>(y);
    auto* out = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < object_ids.cols; ++x) out[x] = values[in[x]];
  }
  return result;
}

Camera exposed_at_once(Camera camera) {
  camera.readout = 0.0;
  return camera;
}

}  // namespace

CameraPath make_path(const Scene& scene, const Stage& stage) {
  const CameraPlan& plan = scene.camera;
  if (scene.road) return {*scene.road, scene.visit_seed(), plan.style};
  if (plan.path == PathKind::waypoints) return {plan.waypoints, scene.visit_seed(), plan.style};
  return {plan.path, stage, scene.visit_seed(), plan.style};
}

Simulator::Simulator(const Scene& scene, const Camera& camera)
    : scene_(scene),
      camera_(exposed_at_once(camera)),
      scene_world_(make_scene_world(scene)),
      path_(make_path(scene, scene_world_.stage)),
      renderer_(scene_world_.world, camera_) {
  const double count = std::ceil(scene.duration * scene.frame_rate - 1e-9);
  if (!(count >= 1.0) || !(count < 1e9)) {
    std::ostringstream text;
    text << "a simulation of " << scene.duration << " s at " << scene.frame_rate
         << " frames/s has no frame (or no end); expected both to be positive";
    throw ConfigurationError(SourceLocation{}, text.str());
  }
  frame_count_ = static_cast<std::uint64_t>(count);
  Random random = Random(scene_.visit_seed()).fork(0x5e4503);
  depth_seed_ = random.next(), colour_seed_ = random.next(), right_seed_ = random.next();
  class_names_ = simulation::class_names(world());
  mask_values_.assign(world().objects.size() + 1, 0);
  class_values_ = {0};
  for (const NumberedObject& numbered : numbered_objects()) mask_values_[numbered.index + 1] = numbered.number;
  for (const Object& object : world().objects) {
    const auto name = std::find(class_names_.begin(), class_names_.end(), object.class_name);
    class_values_.push_back(static_cast<std::uint8_t>(name - class_names_.begin()));
  }
}

bool Simulator::is_dark(double time) const {
  return std::any_of(scene_.lights_out.begin(), scene_.lights_out.end(),
                     [&](const LightsOut& dark) { return time >= dark.from && time < dark.to; });
}

Trajectory Simulator::truth() const {
  Trajectory trajectory;
  for (std::uint64_t i = 0; i < frame_count_; ++i) trajectory.push_back({timestamp(i), T_world_camera(i)});
  return trajectory;
}

RenderedFrame Simulator::render(std::uint64_t index, const Eigen::Isometry3d& T_first_camera) {
  const double shutter = scene_.colour_sensor.shutter;
  // Before the first frame the camera stands still, for half a shutter's time.
  const auto pose = [&](double time) { return path_.pose(std::max(time, 0.0)) * T_first_camera; };
  return renderer_.render(pose, timestamp(index), shutter);
}

void Simulator::sense(cv::Mat& colour, std::uint64_t seed, double time) const {
  sense_colour(colour, scene_.colour_sensor, seed, time, is_dark(time) ? 0.0 : 1.0);
}

SensorFrame Simulator::colour_frame(std::uint64_t index, const RenderedFrame& rendered) const {
  HOLDFAST_CHECK(index < frame_count_, "index " << index << " of " << frame_count_);
  auto truth = std::make_shared<FrameTruth>();
  truth->T_world_camera = T_world_camera(index);
  truth->object_mask = look_up(rendered.object_ids, mask_values_);
  truth->class_labels = look_up(rendered.object_ids, class_values_);
  for (const NumberedObject& numbered : numbered_objects())
    if (moves_at(object(numbered), timestamp(index))) truth->moving_objects.push_back(numbered.number);

  SensorFrame frame;
  frame.index = index;
  frame.timestamp = timestamp(index);
  frame.colour = rendered.colour;
  sense(frame.colour, colour_seed_, frame.timestamp);
  frame.truth = std::move(truth);
  return frame;
}

SensorFrame Simulator::frame(std::uint64_t index) {
  const RenderedFrame rendered = render(index);
  SensorFrame frame = colour_frame(index, rendered);
  frame.depth =
      sense_depth(rendered.depth, rendered.cosine, camera_, scene_.depth_sensor, depth_seed_, frame.timestamp);
  return frame;
}

SensorFrame Simulator::stereo_frame(std::uint64_t index, double baseline) {
  SensorFrame frame = colour_frame(index, render(index));
  const Eigen::Isometry3d T_left_right(Eigen::Translation3d(baseline, 0.0, 0.0));
  frame.right = render(index, T_left_right).colour;
  sense(frame.right, right_seed_, frame.timestamp);
  return frame;
}

}  // namespace holdfast::simulation
