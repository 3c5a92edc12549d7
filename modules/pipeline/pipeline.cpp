// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline.hpp"

#include <algorithm>
#include <cstdio>

#include "holdfast/core/error.hpp"

namespace holdfast {

struct Pipeline::State {
  explicit State(PipelineParts given)
      : parts(std::move(given)),
        tracker(parts.tracking, parts.camera, *parts.features, *parts.optimizer, filters, map, parts.seed),
        mapper(parts.mapping, map, *parts.optimizer) {
    for (auto& [name, filter] : parts.filters) filters.add(name, std::move(filter));
  }

  PipelineParts parts;
  Map map;
  FilterChain filters;
  Tracker tracker;
  LocalMapper mapper;
  std::uint64_t map_version = 0;
  bool has_frame = false;
  double last_timestamp = 0.0;
};

namespace {
PipelineParts checked(PipelineParts parts) {
  HOLDFAST_CHECK(parts.features != nullptr && parts.optimizer != nullptr,
                 "features " << (parts.features != nullptr) << " optimizer " << (parts.optimizer != nullptr));
  if (parts.segmenter == nullptr) parts.segmenter = std::make_unique<NullSegmenter>();
  if (parts.loop_detector == nullptr) parts.loop_detector = std::make_unique<NullLoopDetector>();
  return parts;
}
}  // namespace

Pipeline::Pipeline(PipelineParts parts) : state_(std::make_unique<State>(checked(std::move(parts)))) {}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

FrameResult Pipeline::feed(const SensorFrame& frame) {
  State& s = *state_;
  if (s.has_frame && !(frame.timestamp > s.last_timestamp)) {
    char text[128];
    std::snprintf(text, sizeof(text), "time stamp %.6f does not follow %.6f; stamps must rise strictly",
                  frame.timestamp, s.last_timestamp);
    throw InputError({"frame " + std::to_string(frame.index)}, text);
  }
  s.has_frame = true;
  s.last_timestamp = frame.timestamp;

  FrameResult result = s.tracker.track(frame, s.map_version);
  if (result.is_keyframe) {
    const KeyFrameId keyframe = s.mapper.add_keyframe(s.tracker.frame(), result.times);
    ++s.map_version;
    s.tracker.keyframe_added(keyframe);
    result.keyframe = keyframe;
    result.T_world_camera = s.tracker.frame().T_world_camera();
    s.parts.loop_detector->add(keyframe, s.map.keyframe(keyframe).frame.features.descriptors);
    for (const auto& observer : s.parts.observers) observer->on_keyframe(keyframe, s.map);
  }
  for (const auto& observer : s.parts.observers) observer->on_frame(frame, s.tracker.frame(), result);
  return result;
}

void Pipeline::finish() {
  for (const auto& observer : state_->parts.observers) observer->on_finish(state_->map);
}

Trajectory Pipeline::trajectory() const { return state_->tracker.trajectory(); }

Trajectory Pipeline::keyframe_trajectory() const {
  Trajectory trajectory;
  state_->map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    trajectory.push_back({keyframe.frame.timestamp, keyframe.frame.T_world_camera()});
  });
  std::sort(trajectory.begin(), trajectory.end(),
            [](const TimedPose& a, const TimedPose& b) { return a.timestamp < b.timestamp; });
  return trajectory;
}

const Map& Pipeline::map() const { return state_->map; }
const MappingCounts& Pipeline::mapping_counts() const { return state_->mapper.counts(); }
const Camera& Pipeline::camera() const { return state_->parts.camera; }

}  // namespace holdfast
