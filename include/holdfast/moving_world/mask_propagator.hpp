// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/moving_world/instance_ids.hpp"
#include "holdfast/moving_world/mask_transfer.hpp"
#include "holdfast/moving_world/point_follower.hpp"

namespace holdfast {

/// Samples a segmentation at the centres of the cells; background outside the image. Empty for an empty segmentation.
/// Instances keep the numbers of the segmentation.
CellMask sample_mask(const CoarseSampler& sampler, const Segmentation& segmentation);

/// Propagates the masks of segmented frames, which are few and arrive late, to every frame by optical flow and
/// ego-motion. Order of the calls for each frame:
///
///     advance(...)          moves the followed points and the mask to the frame
///     set_pose(...)         once its pose is estimated
///     remember()            when the frame is going to be segmented
///     apply(index, ...)     when the mask of a remembered frame has arrived: its labels are transferred to the current
///                           frame along the points that were followed in between
///
/// One thread.
class MaskPropagator {
 public:
  /// The sampler must outlive the propagator. `memory` is the time after which the confidence has halved [s];
  /// `has_depth` says whether frames may have depth.
  MaskPropagator(const Camera& camera, const CoarseSampler& sampler, double memory, bool has_depth = true);

  /// `T_frame_previous` is the predicted motion of the camera since the last frame. The frame needs its coarse depth,
  /// but no features, and must stay valid until the next call.
  void advance(const cv::Mat& grey, const Frame& frame, const Eigen::Isometry3d& T_frame_previous);
  /// Sets the pose of the frame and marks as moving the cells whose evaluated.static_log_odds are below `moving`.
  void set_pose(const std::optional<Eigen::Isometry3d>& T_camera_world, const CoarseView& evaluated, float moving);
  void remember();
  /// Applies the mask of a remembered frame, and forgets that frame and older ones; an empty mask has no other effect.
  /// mask.moving is not read. Instance numbers of the segmentation are replaced by ids (InstanceIds). Returns the mask
  /// with ids, without instances if the frame is not remembered.
  CellMask apply(std::uint64_t frame_index, CellMask mask);

  /// The mask of the last frame, without `moving`; empty before the first segmentation.
  const CellMask& mask() const { return mask_; }
  const PointFollower::Points& points() const { return follower_.points(); }
  /// Raw pixels (8UC1, not 0) of objects that moved when they were last evaluated; empty when there are none. The
  /// reference is valid until the next call.
  cv::Mat moving_pixels() const { return sampler_.pixels_of(labels_.moving); }

 private:
  /// Data of a frame that are required to transfer its labels to a later one.
  struct View {
    std::uint64_t frame_index = 0;
    double timestamp = 0.0;
    CoarseView coarse;
    std::optional<Eigen::Isometry3d> T_camera_world;
    std::vector<std::uint64_t> ids;
    std::vector<float> x, y, depth;
  };

  void take_view(const Frame& frame, View& view) const;
  void take_points(View& view) const;
  void pair_with(const View& view, const CellMask& mask_there);
  /// Replaces the instance numbers of a remembered frame's mask by ids, in the mask and in labels_.
  void name_instances(const View& there, const CellMask& held, CellMask& mask);
  void renew_points(const Frame& frame);
  /// The raw pixel at the centre of a cell; its x is negative outside the image.
  cv::Point raw_pixel(int cell) const {
    const std::int32_t raw = sampler_.raw_pixel(cell);
    return {raw % camera_.width, raw / camera_.width};
  }
  /// Cell with the largest corner strength in a bucket among those for which is_wanted is true; -1 if all are below the
  /// threshold. The bucket is given by its first column and row.
  template <class IsWanted>
  int strongest_corner(const CoarseGrid& grid, int first_column, int first_row, const IsWanted& is_wanted) const;
  void publish();

  Camera camera_;
  const CoarseSampler& sampler_;
  double memory_;
  PointFollower follower_;
  MaskTransfer transfer_;
  InstanceIds ids_;
  const Frame* frame_ = nullptr;  // of the last advance(), until the next
  View current_, previous_;
  std::deque<View> remembered_;
  CellMask labels_, next_labels_;  // confidence without the effect of age
  bool segmented_ = false;         // at least once
  double labels_from_ = 0.0;       // time of the segmented frame [s]
  FollowedPairs pairs_;
  std::vector<std::uint8_t> has_point_;  // by bucket
  CellMask mask_;
};

}  // namespace holdfast
