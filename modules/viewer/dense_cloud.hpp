// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "holdfast/viewer/viewer.hpp"
#include "message.hpp"
#include "shown_map.hpp"

namespace holdfast::viewer {

/// What one browser has been told of the dense cloud.
struct CloudProgress {
  std::uint64_t number = 0;   ///< of the cloud; another one: begin anew
  std::size_t surfaces = 0;   ///< number of surfaces that it has
  std::uint64_t version = 0;  ///< of their poses
};

/// The dense cloud as browsers are told of it: surfaces of keyframes, each with a pose that follows its keyframe, and
/// at most one point for each cube of the world. When there are too many points, the cubes grow and everything is
/// thinned and told anew, which happens a few times in a run. One thread.
class DenseCloud {
 public:
  static constexpr std::size_t most_points = 100'000;
  /// A message brings new surfaces until they have so many points together; the others come with the next one.
  static constexpr std::size_t most_in_message = 20'000;
  static constexpr double finest = 0.02;  ///< side of the cubes at first [m]

  void add(ViewedSurface surface);
  /// Replaces everything by a cloud in the world frame, which follows nothing.
  void replace(const std::vector<CloudPoint>& cloud);
  /// Moves the surfaces with the keyframes of a map that was updated.
  void follow(const ShownMap& map, std::uint64_t version);

  std::size_t size() const { return size_; }
  /// Side of the cubes [m].
  double resolution() const { return resolution_; }
  /// Whether describe() would say something.
  bool has_more(const CloudProgress& progress) const;
  /// Adds what the browser lacks, and moves its progress.
  void describe(CloudProgress& progress, Message& message) const;

 private:
  struct Surface {
    KeyFrameId keyframe;
    double timestamp = 0.0;
    Eigen::Isometry3d T_world_camera;
    std::vector<CloudPoint> points;
    std::uint64_t version = 0;  // in which it moved last; 0 = not since it was added
  };
  /// Removes the points in cubes that are taken, and takes those of the others.
  void thin(Surface& surface);
  void coarsen();

  std::vector<Surface> surfaces_;
  std::size_t size_ = 0;
  double resolution_ = finest;
  std::unordered_set<std::uint64_t> taken_;  // keys of cubes; never iterated over
  std::uint64_t number_ = 1, moved_version_ = 0;
};

}  // namespace holdfast::viewer
