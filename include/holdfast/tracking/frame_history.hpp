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

/// Poses of all tracked frames, and the motion model (constant velocity) that follows from the last two. Each pose is
/// kept relative to the frame's reference keyframe, so that it follows later corrections of the map. Functions that
/// take the map read it. One thread.
class FrameHistory {
 public:
  /// Adds a tracked frame. Its velocity is T_current_previous when the frame before was tracked, too.
  void add(const Frame& frame, KeyFrameId reference, const Map& map);
  /// The last frame was not tracked: there is no previous frame and no velocity for the motion model. extrapolate()
  /// still knows the velocity of the last tracked frame.
  void interrupt() { last_.has_previous = last_.has_velocity = false; }
  /// Makes the last tracked frame, if that is its time stamp, the reference of itself: it became this keyframe.
  void became_keyframe(KeyFrameId keyframe, double timestamp);

  /// Adds a keyframe that was taken before the last tracked frame, but after all others.
  void add_before_last(KeyFrameId keyframe, double timestamp) {
    records_.insert(records_.end() - (records_.empty() ? 0 : 1), {timestamp, keyframe});
  }

  /// Adds a frame that was taken before the last tracked one and has got its pose later; replaces the pose that it had.
  /// Returns whether it had none.
  bool add_past(const Frame& frame, KeyFrameId reference, const Map& map);

  /// Pose of a tracked frame by the map as it is now.
  struct PastPose {
    Eigen::Isometry3d T_camera_world;
    bool is_keyframe;  ///< the frame is a keyframe in the map
  };
  /// The pose of the frame with this time stamp; empty if it has none in the map.
  std::optional<PastPose> past_pose(double timestamp, const Map& map) const;
  /// Removes the pose of the frame with this time stamp, which has one and is not the last tracked frame.
  void withdraw(double timestamp);

  /// What the last tracked frames say, to return to.
  class Mark;
  Mark mark() const;
  /// Forgets the frames that were added since the mark; returns how many. None may have been added before it meanwhile.
  std::size_t return_to(const Mark& mark);

  /// Forgets all frames.
  void clear() { *this = FrameHistory(); }

  bool empty() const { return records_.empty(); }
  /// Whether the frame before the current one was tracked.
  bool has_previous() const { return last_.has_previous; }
  bool has_velocity() const { return last_.has_velocity; }
  /// Time stamp of the last tracked frame [s]; the history must not be empty.
  double last_timestamp() const { return records_.back().timestamp; }
  /// T_camera_world of the last tracked frame by the map as it is now; the history must not be empty.
  Eigen::Isometry3d last_pose(const Map& map) const;

  /// The motion model: T_current_previous for a frame at this time; the identity without a velocity.
  Eigen::Isometry3d predicted_step(double timestamp) const;
  /// Motion since the last tracked frame if the camera went on with `share` of its last velocity, also after a loss.
  Eigen::Isometry3d extrapolate(double timestamp, double share) const;

  /// The submap with most of the tracked frames; of equal ones the oldest.
  std::uint32_t main_submap(const Map& map) const;
  /// How many tracked frames are not in the main submap.
  std::size_t frames_left_out(const Map& map) const;
  /// Poses of the tracked frames of the main submap, by the map as it is now.
  Trajectory trajectory(const Map& map) const;

 private:
  struct Record {
    double timestamp;
    KeyFrameId reference;
    // The pose of the last record is also kept as it came (Last::T_camera_reference): the motion model needs every bit.
    Eigen::Quaternion<double, Eigen::DontAlign> R_camera_reference = {1.0, 0.0, 0.0, 0.0};
    Eigen::Vector3d t_camera_reference = Eigen::Vector3d::Zero();  // [m], at scale 1 of the reference
  };
  static_assert(sizeof(Record) == 72, "one is kept of every frame");
  static Record record_of(double timestamp, KeyFrameId reference, const Eigen::Isometry3d& T_camera_reference,
                          double reference_scale);
  static Eigen::Isometry3d pose_of(const Record& record, const Map& map);
  /// The first record at or after this time.
  std::vector<Record>::const_iterator record_from(double timestamp) const;

  /// Of the last tracked frames, beside their records.
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

/// A moment of a history.
class FrameHistory::Mark {
  friend class FrameHistory;
  std::size_t count_ = 0;
  Last last_;
};

}  // namespace holdfast
