// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bridge/bridge.hpp"
#include "holdfast/config/configuration.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "image_pairing.hpp"
#include "odometry_frames.hpp"

namespace holdfast::bridge {

/// Reads a configuration with the images of the bridge as its source. Plugins are loaded into `registry`.
Configuration read_bridge_configuration(const Parameters& parameters, Registry& registry);

/// What a session begins with.
struct SessionStart {
  const Configuration& configuration;
  const Registry& registry;  ///< with the modules of the configuration
  const Parameters& parameters;
  SourceDescription source;  ///< of the bridge: which images there are, and their camera if that is known
  std::string map_file;      ///< empty = a new map
  bool localise_only = false;
};

/// A pipeline from its first frame on, or from that of a loaded map, with the frames of the robot. add_frame() is
/// called by one thread; the other functions by any.
class Session {
 public:
  /// Throws as build_pipeline() does, and waits until networks are loaded.
  explicit Session(const SessionStart& start);

  /// Feeds a frame; `T_base_camera` counts with the first one. `odometry`: T_odom_base of somebody else, if any. Throws
  /// InputError for a frame that cannot be used, and any exception of the pipeline's threads.
  FrameOutput add_frame(const ImageSet& images, std::vector<ImuSample> imu, const Eigen::Isometry3d& T_base_camera,
                        const std::optional<Eigen::Isometry3d>& odometry);

  Pipeline& pipeline() { return built_->pipeline; }
  const Pipeline& pipeline() const { return built_->pipeline; }
  const Warnings& warnings() const { return warnings_; }
  /// Whether keyframes were added or moved since the last call.
  bool take_map_change() { return has_map_changed_.exchange(false); }
  /// Makes take_map_change() return true once more.
  void keep_map_change() { has_map_changed_ = true; }
  /// Whether this stamp is more than a second before that of the last frame.
  bool is_before_last(Stamp stamp) const { return stamp < stamp_ - 1'000'000'000; }
  std::size_t keyframes() const { return keyframes_; }

  /// The map as it is now; empty before the first pose.
  std::optional<MapOutput> map_output() const;
  /// Grid and octree of the surface as fused so far; empty without a surface and before it holds something.
  std::optional<GridOutput> grid_output() const;

 private:
  class Watcher;
  /// Changed by add_frame() before the first pose is given out, constant afterwards.
  struct Placement {
    Eigen::Isometry3d T_map_world = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  };
  std::optional<Eigen::Isometry3d> base_motion(double timestamp, const FrameResult& result) const;
  void describe_pose(const FrameResult& result, const std::optional<Eigen::Isometry3d>& odometry, FrameOutput& output);
  cv::Mat mask_of(const CoarseView& view) const;

  std::optional<BuiltPipeline> built_;
  std::optional<CoarseSampler> sampler_;
  Warnings warnings_;
  OdometryFrames frames_;
  std::uint64_t next_index_ = 0;
  std::optional<double> last_pose_;  // time stamp of the frame before, if that had a pose [s]
  cv::Mat mask_;                     // of the frame in progress
  mutable std::mutex mutex_;
  std::optional<Placement> placement_;  // guarded by mutex_
  std::atomic<Stamp> stamp_ = 0;        // of the last frame
  std::atomic<bool> has_map_changed_ = false;
  std::atomic<std::size_t> keyframes_ = 0;  // that were added
};

}  // namespace holdfast::bridge
