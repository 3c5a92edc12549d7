// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/pair_errors.hpp"
#include "holdfast/tracking/stereo_settings.hpp"

namespace holdfast {

/// Sparse stereo matching for a rectified pair (Mur-Artal and Tardos 2017, section III-A): each left feature is matched
/// by its descriptor along its row of the right image, each right feature is used once, and the column is refined by
/// patch correlation with a parabola fit. Unlike the paper, patches are taken from the full image, so that coarse
/// features have the same precision as fine ones, and are compared after subtraction of a constant brightness
/// difference. Keeps its buffers; one thread.
class StereoMatcher {
 public:
  explicit StereoMatcher(const StereoSettings& settings) : settings_(settings) {}

  /// Sets frame.depth [m] and frame.right_x [px]. `left` and `right`: 8UC1 of the camera's size. The camera must have
  /// no distortion. `errors`: calibration errors of the pair, for which rows and disparities are corrected.
  void match(const cv::Mat& left, const cv::Mat& right, const Features& right_features, Frame& frame,
             const PairErrors& errors = {});
  /// Row differences of the features matched by the last match(), if the keypoints of both images show the same point.
  const std::vector<RowDifference>& row_differences() const { return row_differences_; }

 private:
  struct Match {
    std::uint32_t left, right;
    float distance;  // of the descriptors
  };
  struct RightFeature {
    float x, y;
    int octave;
    std::uint32_t index;
  };
  void sort_by_row(const Features& features, int rows);
  void find_matches(const Frame& frame, const Features& right, float max_disparity, const PairErrors& errors);
  void keep_best_of_each_right_feature(const Features& right);
  /// Refined disparity [px] of a match and the difference of the patches; NaN if it cannot be refined.
  float refine(const cv::Mat& left, const cv::Mat& right, cv::Point2f left_at, cv::Point2f right_at, float scale,
               float& difference) const;

  StereoSettings settings_;
  std::vector<std::uint32_t> row_begin_;  // of by_row_, by counting sort
  std::vector<RightFeature> by_row_;
  std::vector<std::uint32_t> candidates_;
  std::vector<float> distances_;
  std::vector<Match> matches_;
  std::vector<std::int32_t> match_of_right_;
  std::vector<float> disparity_, difference_, sorted_;
  std::vector<RowDifference> row_differences_;
};

}  // namespace holdfast
