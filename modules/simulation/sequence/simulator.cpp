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
}  // namespace

Simulator::Simulator(const SimulationSettings& settings, const Camera& camera)
    : settings_(settings),
      camera_(camera),
      room_(make_room(settings.room, settings.seed)),
      path_(settings.path, room_.stage, settings.seed),
      renderer_(room_.world, camera_) {
  const double count = std::ceil(settings.duration * settings.frame_rate - 1e-9);
  if (!(count >= 1.0) || !(count < 1e9)) {
    std::ostringstream text;
    text << "a simulation of " << settings.duration << " s at " << settings.frame_rate
         << " frames/s has no frame (or no end); expected both to be positive";
    std::vector<Diagnostic> problems(1);
    problems[0].message = text.str();
    throw ConfigurationError(std::move(problems));
  }
  frame_count_ = static_cast<std::uint64_t>(count);
  class_names_ = simulation::class_names(room_.world);
  mask_values_ = {0};
  class_values_ = {0};
  std::uint8_t moving = 0;
  for (const Object& object : room_.world.objects) {
    mask_values_.push_back(object.moves() ? ++moving : 0);
    const auto name = std::find(class_names_.begin(), class_names_.end(), object.class_name);
    class_values_.push_back(static_cast<std::uint8_t>(name - class_names_.begin()));
  }
}

Trajectory Simulator::truth() const {
  Trajectory trajectory;
  for (std::uint64_t i = 0; i < frame_count_; ++i) trajectory.push_back({timestamp(i), T_world_camera(i)});
  return trajectory;
}

RenderedFrame Simulator::render(std::uint64_t index) {
  return renderer_.render(T_world_camera(index), timestamp(index));
}

SensorFrame Simulator::frame(std::uint64_t index) {
  HOLDFAST_CHECK(index < frame_count_, "index " << index << " of " << frame_count_);
  RenderedFrame rendered = render(index);
  Random random = Random(settings_.seed).fork(0x5e4503).fork(index);
  const std::uint64_t depth_seed = random.next(), colour_seed = random.next();

  auto truth = std::make_shared<FrameTruth>();
  truth->T_world_camera = T_world_camera(index);
  truth->object_mask = look_up(rendered.object_ids, mask_values_);
  truth->class_labels = look_up(rendered.object_ids, class_values_);

  SensorFrame frame;
  frame.index = index;
  frame.timestamp = timestamp(index);
  frame.depth = sense_depth(rendered.depth, rendered.cosine, camera_, settings_.depth_sensor, depth_seed);
  frame.colour = rendered.colour;
  add_colour_noise(frame.colour, settings_.colour_sensor, colour_seed);
  frame.truth = std::move(truth);
  return frame;
}

}  // namespace holdfast::simulation
