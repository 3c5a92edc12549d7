// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"

namespace holdfast {

/// Finds what moved earlier and stands still now, such as a chair that was moved: filters that compare a frame with old
/// keyframes call it moving for as long as these are compared, and a surface would never contain it again.
///
/// Keeps the coarse depth of the last tracked frames, one every 0.2 s, with their poses; 77 kB each at 640x480. Used by
/// one thread.
class RestingCells {
 public:
  /// `time`: duration after which something at rest counts as part of the room [s].
  explicit RestingCells(double time) : time_(time) {}

  /// Adds a tracked frame with depth; frames less than 0.2 s after the last one are left out unless they are keyframes.
  /// A pose in a new map or submap, or after a loss, places things elsewhere than those before: it clears these.
  void add(const Frame& frame, const FrameResult& result);
  /// Forgets all frames: their poses are of another map.
  void clear() { views_.clear(); }

  /// The log-odds of the coarse view of a frame that was added not long ago, with 0 for cells that move and whose
  /// surface stood still for the time: a connected part with continuous depth, half of whose cells frames observed
  /// three quarters of the time earlier where they are now, with at most a fifth as many cells in which any frame of
  /// the time looked through it. Other cells are unchanged.
  std::vector<float> released(std::uint64_t frame_index, const std::vector<float>& static_log_odds) const;

 private:
  struct View {
    std::uint64_t frame_index = 0;
    double timestamp = 0.0;
    std::shared_ptr<const Camera> camera;
    CoarseGrid grid;
    Eigen::Isometry3d T_view_world = Eigen::Isometry3d::Identity();
    std::vector<float> depth;
  };
  enum class State : std::uint8_t { unknown, rests, moves };
  std::vector<State> states_of(const View& view, const std::vector<float>& static_log_odds) const;
  State compare(const View& view, int cell) const;

  double time_;
  std::deque<View> views_;  // by time
};

}  // namespace holdfast
