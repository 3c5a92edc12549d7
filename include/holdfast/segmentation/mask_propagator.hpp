// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/carried_mask.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/segmentation/mask_carrying.hpp"
#include "holdfast/segmentation/point_follower.hpp"

namespace holdfast {

/// A segmentation on the cells of a coarse view; background outside the image.
void sample_segmentation(const CoarseSampler& sampler, const Segmentation& segmentation,
                         std::vector<std::uint8_t>& labels, std::vector<std::uint8_t>& confidence);

/// Has a mask for every frame although only few are segmented, and those late. For each frame:
///
///     advance(...)          the points and the mask follow to the frame
///     located(...)          its pose, once known
///     remember(index)       when the frame is going to be segmented
///     apply(index, ...)     when the segmentation of a remembered frame has come: its labels are carried to the frame
///                           of the moment by the points that were followed all the while
///
/// One thread.
class MaskPropagator {
 public:
  /// The sampler must outlive the propagator. `memory` is the time after which a mask counts for half [s].
  MaskPropagator(const Camera& camera, const CoarseSampler& sampler, double memory);

  /// `T_frame_previous` is the camera's motion since the last frame as far as it can be guessed.
  /// The frame's features are not needed yet.
  void advance(const cv::Mat& grey, const Frame& frame, const Eigen::Isometry3d& T_frame_previous);
  /// Takes the pose and what filters said of the cells (frame.coarse.static_log_odds; below `moving` an object moves).
  void located(const std::optional<Eigen::Isometry3d>& T_camera_world, const CoarseView& judged, float moving);
  void remember();
  /// Forgets what was kept for that frame and older ones; an empty segmentation changes no mask.
  void apply(std::uint64_t frame_index, const Segmentation& segmentation);

  /// The mask of the last frame; empty before the first segmentation.
  const CarriedMask& mask() const { return mask_; }
  const PointFollower::Points& points() const { return follower_.points(); }
  /// Marks the raw pixels (8UC1, not 0) of what moved when it was last judged; empty when nothing did. Features there
  /// are a waste.
  const cv::Mat& moving_pixels();

 private:
  /// What must be known of a frame to carry labels away from it.
  struct View {
    std::uint64_t frame_index = 0;
    double timestamp = 0.0;
    CoarseView coarse;
    std::optional<Eigen::Isometry3d> T_camera_world;
    std::vector<std::uint64_t> ids;
    std::vector<float> x, y, depth;
  };

  void take_view(const Frame& frame, View& view) const;
  void pair_with(const View& view, const std::vector<std::uint8_t>& labels_there);
  void renew_points(const Frame& frame);
  void publish();

  Camera camera_;
  const CoarseSampler& sampler_;
  double memory_;
  PointFollower follower_;
  MaskCarrier carrier_;
  const Frame* frame_ = nullptr;  // of the last advance(), until the next
  View current_, previous_;
  std::deque<View> remembered_;
  CellLabels labels_, next_labels_;
  bool segmented_ = false;    // once
  double labels_from_ = 0.0;  // time of the segmented frame [s]
  FollowedPairs pairs_;
  std::vector<int> bucket_strength_;
  std::vector<std::int32_t> bucket_cell_;
  cv::Mat moving_pixels_;
  CarriedMask mask_;
};

}  // namespace holdfast
