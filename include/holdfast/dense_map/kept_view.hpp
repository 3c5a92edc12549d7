// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/dense_map/dense_map_settings.hpp"

namespace holdfast {

/// The kept images of a keyframe, undistorted and subsampled, 5 bytes per pixel; or the coarse depth of a frame between
/// keyframes (CarvingViews).
struct KeptView {
  static constexpr std::uint16_t moves_bit = 0x8000, depth_bits = 0x7FFF;
  static constexpr double depth_unit = 0.0005;  ///< [m]; the maximum depth is 16.38 m

  KeyFrameId keyframe;
  std::uint64_t frame_index = 0;
  double timestamp = 0.0;  ///< [s]
  cv::Mat colour;          ///< 8UC3
  cv::Mat depth;           ///< 16UC1: depth_bits in depth_units, 0 = none; moves_bit for dynamic pixels
  cv::Mat labels = {};     ///< 8UC1: class of each pixel, 255 = unknown; empty = not kept, or not known
  /// Of a frame between keyframes, which only carves free space and has no colour: its camera. Else nullptr.
  std::shared_ptr<const Camera> coarse_camera = nullptr;
  /// Pose of the depth image relative to `keyframe`: of such a frame, or of the keyframe's own, which many sensors take
  /// some milliseconds before or after the colour image.
  Eigen::Isometry3d T_view_keyframe = Eigen::Isometry3d::Identity();

  /// T_world_view when the keyframe has the given pose.
  Eigen::Isometry3d T_world_view(const Eigen::Isometry3d& T_keyframe_world) const {
    return (T_view_keyframe * T_keyframe_world).inverse();
  }
  bool only_carves() const { return coarse_camera != nullptr; }

  bool moves(int x, int y) const { return (depth.at<std::uint16_t>(y, x) & moves_bit) != 0; }
  /// Depth of the visible surface, static or dynamic [m]; 0 = none.
  double depth_at(int x, int y) const { return (depth.at<std::uint16_t>(y, x) & depth_bits) * depth_unit; }
};

/// Whether a label is no part of the static scene: it is unknown (255), or a class of `left_out` (by label).
bool is_left_out(std::uint8_t label, const std::vector<bool>& left_out);

/// Position of the view without which the gap in time is smallest; neither the first nor the last of three or more.
std::size_t densest_view(const std::vector<KeptView>& views);

/// Creates kept views from the images of a camera. Immutable after construction.
class ViewSampler {
 public:
  /// `keeps_labels`: whether views keep the classes of their pixels, one byte more per pixel.
  ViewSampler(const Camera& camera, const DenseMapSettings& settings, bool keeps_labels = false);

  /// The pinhole camera of the kept views.
  const Camera& camera() const { return small_; }
  bool keeps_labels() const { return keeps_labels_; }

  /// Creates the kept view of a keyframe, at coarse.T_view_camera if the source states a SensorFrame::depth_delay.
  /// Dynamic pixels are those whose label (`labels`, 8UC1 of the image's size; coarse.mask if `labels` is empty) is
  /// unknown (255) or a class of `left_out` (by label), cells with negative coarse.static_log_odds, pixels near these
  /// (DenseMapSettings::dilate, edge), and pixels outside the image.
  KeptView sample(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse, const cv::Mat& labels,
                  const std::vector<bool>& left_out) const;

 private:
  cv::Mat sample_labels(const cv::Mat& labels) const;
  void spread(cv::Mat& depth) const;

  Camera raw_, small_;
  int step_, reach_, edge_;
  int margin_;  // [depth units]
  bool keeps_labels_;
  std::vector<std::int32_t> raw_pixel_;  // of each kept pixel, -1 = outside
  std::vector<std::int32_t> cell_;       // of the coarse view, -1 = none
  CoarseGrid grid_;
};

}  // namespace holdfast
