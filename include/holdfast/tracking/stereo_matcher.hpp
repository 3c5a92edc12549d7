// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/pair_errors.hpp"
#include "holdfast/tracking/stereo_settings.hpp"

namespace holdfast {

/// Gives the features of the left image of a rectified pair depth: each is searched for in its row of the right image
/// by its descriptor, each right feature belongs to at most one left feature, and the column is refined by comparing
/// image patches, to a fraction of a pixel by a parabola. After Mur-Artal and Tardos 2017, section III-A, who search
/// along the rows in the same way; here the patches are those of the full image, so that the disparity of coarse
/// features is as precise as that of fine ones, and differ by a constant brightness at most. Keeps its buffers; one
/// thread.
class StereoMatcher {
 public:
  explicit StereoMatcher(const StereoSettings& settings) : settings_(settings) {}

  /// Writes frame.depth [m] and frame.right_x [px], which get one entry for each feature. `left` and `right`: 8UC1 of
  /// the camera's size. The camera must have no distortion. `errors`: of the pair, by which rows and disparities are
  /// corrected.
  void match(const cv::Mat& left, const cv::Mat& right, const Features& right_features, Frame& frame,
             const PairErrors& errors = {});
  /// How much lower the right image shows the features that the last match() gave depth, as far as the keypoints of
  /// both images are the same point.
  const std::vector<RowDifference>& row_differences() const { return row_differences_; }

 private:
  struct Match {
    std::uint32_t left, right;
    float distance;  // of the descriptors
  };
  void sort_by_row(const Features& features, int rows);
  void find_matches(const Frame& frame, const Features& right, float max_disparity, const PairErrors& errors);
  void keep_best_of_each_right_feature(const Features& right);
  /// The disparity [px] of a match as the images show it, and how different the patches are; NaN for one that cannot be
  /// refined.
  float refine(const cv::Mat& left, const cv::Mat& right, cv::Point2f left_at, cv::Point2f right_at, float scale,
               float& difference) const;

  StereoSettings settings_;
  std::vector<std::uint32_t> row_begin_, by_row_;  // right features of each row, by counting sort
  std::vector<std::uint32_t> candidates_;
  std::vector<float> distances_;
  std::vector<Match> matches_;
  std::vector<std::int32_t> match_of_right_;
  std::vector<float> disparity_, difference_, sorted_;
  std::vector<RowDifference> row_differences_;
};

}  // namespace holdfast
