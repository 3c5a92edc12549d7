// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/filter_chain.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/local_map.hpp"
#include "holdfast/tracking/projection_search.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Finds the pose of every frame against the map (Mur-Artal and Tardos 2017, section III): prediction with constant
/// velocity, or the reference keyframe when that fails, then the local map, then a keyframe decision. When lost, the
/// last keyframes are tried until one fits. Changes the map only by starting it and by counting how often points are
/// found. One thread.
class Tracker {
 public:
  /// Extractor, optimizer and map must outlive the tracker.
  Tracker(const TrackingSettings& settings, const Camera& camera, FeatureExtractor& extractor, Optimizer& optimizer,
          FilterChain& filters, Map& map, std::uint64_t seed);

  /// Tracks one frame. When the result says is_keyframe, hand take_keyframe() to local mapping and tell the outcome
  /// with keyframe_added().
  FrameResult track(const SensorFrame& sensor_frame, std::uint64_t map_version);

  /// The frame last tracked, as features, matches and pose.
  const Frame& frame() const { return current_; }
  /// The keyframe that the tracked frame became, after local mapping had its turn: its matches and its pose are taken
  /// over.
  void keyframe_added(KeyFrameId keyframe);

  /// Every tracked frame's pose as the map knows it now: frames follow the keyframes that they were tracked against.
  Trajectory trajectory() const;

 private:
  enum class State { waiting, tracking, lost };

  bool start_map(FrameResult& result);
  bool predict_with_velocity(FrameResult& result);
  bool predict_with_keyframe(KeyFrameId keyframe, FrameResult& result);
  bool recover(FrameResult& result);
  bool track_local_map(FrameResult& result);
  bool needs_keyframe(const FrameResult& result) const;
  int adjust_pose();
  void drop_outliers();
  int match_previous(float radius_factor);
  void match_descriptors(const Frame& keyframe_frame);
  void remember(FrameResult& result);

  /// A tracked frame, fixed to its reference keyframe.
  struct Record {
    double timestamp;
    KeyFrameId reference;
    Eigen::Isometry3d T_camera_reference;
  };

  TrackingSettings settings_;
  FrameBuilder builder_;
  Optimizer& optimizer_;
  FilterChain& filters_;
  Map& map_;
  Random random_;

  std::uint64_t map_version_ = 0;
  State state_ = State::waiting;
  Frame current_, previous_;
  bool has_previous_ = false;  // previous_ has a pose
  Eigen::Isometry3d T_previous_reference_ = Eigen::Isometry3d::Identity();
  bool has_velocity_ = false;
  Eigen::Isometry3d velocity_ = Eigen::Isometry3d::Identity();  // T_current_previous of the last step
  double velocity_interval_ = 0.0;                              // [s]
  KeyFrameId reference_keyframe_;
  KeyFrameId last_keyframe_;
  double last_keyframe_time_ = 0.0;
  std::vector<Record> records_;

  LocalMap local_map_;
  ProjectionSearch search_;
  SearchWindows windows_;
  PoseProblem problem_;
  std::vector<std::uint32_t> problem_features_;
};

}  // namespace holdfast
