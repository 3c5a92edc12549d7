// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/evaluation/duration_record.hpp"

namespace holdfast {

/// Processing time of one stage over a run. Median, 95th percentile and maximum are over the frames in which it ran,
/// as exact as DurationRecord says.
struct StageRow {
  std::string stage;
  std::size_t frames = 0;
  double median = 0.0;   ///< [s]
  double p95 = 0.0;      ///< [s]
  double maximum = 0.0;  ///< [s]
  double total = 0.0;    ///< [s]
  double share = 0.0;    ///< fraction of the total of all stages, 0 to 1
};

/// Accumulates counts and times of a run frame by frame.
class RunSummary {
 public:
  /// Adds a frame; `decode_seconds` is the time that the source took for its images.
  void add(const FrameResult& result, double decode_seconds);
  /// Adds stages that ran in other threads than tracking.
  void add(const StageTimes& background);

  std::uint64_t frames() const { return frames_; }
  /// Number of frames with a pose.
  std::uint64_t tracked() const {
    return count(TrackingStatus::tracked) + count(TrackingStatus::initialised) + count(TrackingStatus::inertial);
  }
  std::uint64_t lost() const { return count(TrackingStatus::lost); }
  /// Number of frames whose pose was recovered after a loss, from the last keyframes or by place recognition.
  std::uint64_t recovered() const { return recovered_; }
  std::uint64_t relocalised() const { return relocalised_; }
  /// Number of frames that were tracked by features of an earlier frame.
  std::uint64_t by_flow() const { return by_flow_; }
  std::uint64_t count(TrackingStatus status) const;
  /// Number of tracked frames with this fallback.
  std::uint64_t count(TrackingFallback fallback) const;
  const std::map<TrackingFailure, std::uint64_t>& failures() const { return failures_; }
  std::uint64_t count(HealthState state) const;
  /// Numbers of frames in states other than good, by reason.
  const std::map<HealthReason, std::uint64_t>& reasons() const { return reasons_; }
  /// Largest FrameHealth::jump, in the unit of the map.
  double largest_jump() const { return largest_jump_; }
  double mean_inliers() const;
  /// Time from images to pose of every frame [s].
  const std::vector<double>& tracking_seconds() const { return tracking_seconds_; }
  /// Stages in the order of the pipeline: those of tracking, segmentation, mapping, loop closing, the dense map; of
  /// each in the order of their first completion.
  std::vector<StageRow> stages() const;
  /// The row of the total tracking time.
  StageRow tracking() const;

 private:
  struct Stage {
    std::string name;
    DurationRecord seconds;
  };
  DurationRecord& stage(const std::string& name);

  std::uint64_t frames_ = 0, recovered_ = 0, relocalised_ = 0, by_flow_ = 0, inliers_ = 0;
  std::map<TrackingStatus, std::uint64_t> statuses_;
  std::map<TrackingFallback, std::uint64_t> fallbacks_;
  std::map<TrackingFailure, std::uint64_t> failures_;
  std::map<HealthState, std::uint64_t> health_;
  std::map<HealthReason, std::uint64_t> reasons_;
  double largest_jump_ = 0.0;
  std::vector<Stage> stages_;
  std::vector<double> tracking_seconds_;
};

/// Formats the stage table: median, 95th percentile and maximum in milliseconds, share in percent.
std::string stage_table(const RunSummary& summary);

}  // namespace holdfast
