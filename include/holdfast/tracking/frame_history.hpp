// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// Poses of all tracked frames, and the constant-velocity motion model. Each pose is stored relative to the reference
/// keyframe of the frame, so that later corrections of the map apply to it. Functions with a map argument read the map.
/// One thread.
class FrameHistory {
 public:
  /// Adds a tracked frame. The velocity is T_current_previous if the previous frame was tracked as well.
  void add(const Frame& frame, KeyFrameId reference, const Map& map);
  /// Registers a frame without a pose: the motion model then has no previous frame and no velocity. extrapolate() still
  /// uses the velocity of the last tracked frame.
  void interrupt() { last_.has_previous = last_.has_velocity = false; }
  /// If the last tracked frame has this time stamp, makes `keyframe` its reference keyframe: the frame became this
  /// keyframe.
  void became_keyframe(KeyFrameId keyframe, double timestamp);

  /// Inserts a keyframe between the last tracked frame and the one before it.
  void add_before_last(KeyFrameId keyframe, double timestamp) {
    records_.insert(records_.end() - (records_.empty() ? 0 : 1), {timestamp, keyframe});
  }

  /// Inserts a frame before the last tracked one, whose pose was estimated later, or replaces its pose. Returns whether
  /// it had no pose.
  bool add_past(const Frame& frame, KeyFrameId reference, const Map& map);

  /// Replaces the pose of the frame with this time stamp, which must have one.
  void replace(double timestamp, const Eigen::Isometry3d& T_camera_world, const Map& map);

  /// Current pose of a tracked frame.
  struct PastPose {
    Eigen::Isometry3d T_camera_world;
    bool is_keyframe;      ///< the frame is a keyframe in the map
    KeyFrameId reference;  ///< the keyframe to which the pose is relative
  };
  /// Current pose of the frame with this time stamp; empty without a pose in the map.
  std::optional<PastPose> past_pose(double timestamp, const Map& map) const;
  /// Removes the pose of the frame with this time stamp. The frame must have a pose and must not be the last tracked
  /// one.
  void withdraw(double timestamp);

  /// A state of the history to which return_to() resets it.
  class Mark;
  Mark mark() const;
  /// Removes the frames that were added since the mark and returns their number. No frame may have been inserted before
  /// the mark meanwhile.
  std::size_t return_to(const Mark& mark);

  /// Removes all frames.
  void clear() { *this = FrameHistory(); }

  bool empty() const { return records_.empty(); }
  /// Whether the frame before the current one was tracked.
  bool has_previous() const { return last_.has_previous; }
  bool has_velocity() const { return last_.has_velocity; }
  /// Time stamp of the last tracked frame [s]; the history must not be empty.
  double last_timestamp() const { return records_.back().timestamp; }
  /// Current T_camera_world of the last tracked frame; the history must not be empty.
  Eigen::Isometry3d last_pose(const Map& map) const;

  /// Interval in which the velocity was measured [s].
  double velocity_interval() const { return last_.velocity_interval; }
  /// Constant-velocity prediction of T_current_previous for a frame at this time; the identity without a velocity.
  Eigen::Isometry3d predicted_step(double timestamp) const;
  /// Predicted motion since the last tracked frame with the last velocity times `share`, also after a loss.
  Eigen::Isometry3d extrapolate(double timestamp, double share) const;

  /// The submap with the most tracked frames; the oldest one of equals.
  std::uint32_t main_submap(const Map& map) const;
  /// Number of tracked frames outside the main submap.
  std::size_t frames_left_out(const Map& map) const;
  /// Current poses of the tracked frames of the main submap.
  Trajectory trajectory(const Map& map) const;

 private:
  struct Record {
    double timestamp;
    KeyFrameId reference;
    // The pose of the last record is also kept unconverted (Last::T_camera_reference), for an exact motion model.
    Eigen::Quaternion<double, Eigen::DontAlign> R_camera_reference = {1.0, 0.0, 0.0, 0.0};
    Eigen::Vector3d t_camera_reference = Eigen::Vector3d::Zero();  // [m], at scale 1 of the reference
  };
  static_assert(sizeof(Record) == 72, "one is kept of every frame");
  static Record record_of(double timestamp, KeyFrameId reference, const Eigen::Isometry3d& T_camera_reference,
                          double reference_scale);
  static Eigen::Isometry3d pose_of(const Record& record, const Map& map);
  /// The first record at or after this time.
  std::vector<Record>::const_iterator record_from(double timestamp) const;

  /// State of the motion model.
  struct Last {
    Eigen::Isometry3d T_camera_reference = Eigen::Isometry3d::Identity();  // of the last record
    double reference_scale = 1.0;                                          // KeyFrame::scale when it was added
    bool has_previous = false;
    bool has_velocity = false;
    Eigen::Isometry3d velocity = Eigen::Isometry3d::Identity();  // T_current_previous
    double velocity_interval = 0.0;                              // [s]
  };

  std::vector<Record> records_;
  Last last_;
};

/// State of a history at the time of its construction.
class FrameHistory::Mark {
  friend class FrameHistory;
  std::size_t count_ = 0;
  Last last_;
};

}  // namespace holdfast
