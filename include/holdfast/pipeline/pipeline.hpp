// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/all.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "holdfast/mapping/mapping_settings.hpp"
#include "holdfast/tracking/filter_chain.hpp"
#include "holdfast/tracking/tracker.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Everything a pipeline is made of; PipelineBuilder checks and fills it.
struct PipelineParts {
  Camera camera;
  std::unique_ptr<FeatureExtractor> features;
  std::unique_ptr<Segmenter> segmenter;
  std::vector<std::pair<std::string, std::unique_ptr<DynamicFilter>>> filters;  ///< by name, in order
  std::unique_ptr<Optimizer> optimizer;
  std::unique_ptr<LoopDetector> loop_detector;
  std::vector<std::unique_ptr<Observer>> observers;
  TrackingSettings tracking;
  MappingSettings mapping;
  std::uint64_t seed = 1;
};

/// Visual SLAM from frames to poses and a map, in sequential mode: feed() does all the work of a frame, local mapping
/// included, in the calling thread, and gives the same bits on every run. Pipelines share nothing: any number may live
/// in one process. One thread at a time.
class Pipeline {
 public:
  /// Throws CheckError when a required part is missing.
  explicit Pipeline(PipelineParts parts);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Processes one frame; time stamps must rise strictly (InputError otherwise). Trouble with the frame is a typed
  /// result.
  FrameResult feed(const SensorFrame& frame);
  /// Ends the run: tells the observers. feed() must not be called any more.
  void finish();

  /// Poses of all tracked frames, in order, as corrected by all that came later. World frame: the first camera's.
  Trajectory trajectory() const;
  /// Poses of the keyframes in the map, by time.
  Trajectory keyframe_trajectory() const;
  const Map& map() const;
  const MappingCounts& mapping_counts() const;
  const Camera& camera() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace holdfast
