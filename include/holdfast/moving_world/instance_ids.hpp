// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/coarse_view.hpp"

namespace holdfast {

/// A segmented frame: its mask with the instances' numbers in the segmentation, its depth and its pose.
struct SegmentedView {
  const Camera& camera;
  const CoarseView& view;
  const CellMask& mask;
  std::optional<Eigen::Isometry3d> T_camera_world = {};
  double timestamp = 0.0;  ///< [s]

  /// The direction of the centre of a cell, with z = 1, camera frame.
  Eigen::Vector3d ray(int column, int row) const {
    return camera.back_project(view.grid.x_of(column), view.grid.y_of(row), 1.0);
  }
};

/// Assigns persistent ids to the instances of successive masks: data association by mask overlap and predicted
/// position, by greedy assignment in order of decreasing score. Ids survive occlusions. The score of an instance and a
/// track of its class is the sum of
///
///   - the intersection over union of its mask with the propagated mask of the track, both in the same frame,
///   - 0.5 (1 - d / g), with the distance d of its centroid to the predicted one (constant velocity, world frame) and
///     the gate g, which grows with the time since the last observation. Without depth or poses, centroids are compared
///     in the image, relative to the size of the instance.
///
/// Instances of less than 12 cells are matched by overlap alone and never get a new id; unmatched ones get 0.
///
/// Tracks without a mask that were not observed for 4 s are removed. Ids are reused only when all 65535 have been
/// assigned. One thread.
class InstanceIds {
 public:
  /// Returns the ids of the instances 1, 2, ... of a segmented frame; entry 0 is 0. `carried` is the mask of that frame
  /// propagated to the current frame, `held` the previous mask (with ids) of the current frame; both on the same cells.
  std::vector<std::uint16_t> assign(const SegmentedView& segmented, const CellMask& carried, const CellMask& held);

 private:
  /// Position and velocity of an instance.
  struct Place {
    std::uint8_t label = CellMask::unknown;
    std::size_t cells = 0;
    Eigen::Vector2d in_image = Eigen::Vector2d::Zero();  ///< centroid [cells]
    std::optional<Eigen::Vector3d> in_world;             ///< centroid of its visible surface [m]
  };
  struct Track {
    std::uint16_t id = 0;
    Place place;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
    double last_seen = 0.0;
  };
  struct Candidate {
    double score = 0.0;
    std::size_t instance = 0, track = 0;
  };

  static std::vector<Place> places_of(const SegmentedView& segmented);
  /// Score of the positions, at most 0.5; empty outside the gate.
  static std::optional<double> nearness(const Track& track, const Place& place, double timestamp);
  std::vector<Candidate> candidates(const std::vector<Place>& places, const CellMask& carried, const CellMask& held,
                                    double timestamp) const;
  void update(Track& track, const Place& place, double timestamp);

  std::vector<Track> tracks_;  ///< by increasing time of their beginning
  std::uint16_t next_id_ = 1;
};

}  // namespace holdfast
