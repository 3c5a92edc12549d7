// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "holdfast/interfaces/dense_stereo.hpp"
#include "window_costs.hpp"

namespace cv {
class StereoSGBM;
}

namespace holdfast {

/// Semi-global matching (Hirschmueller 2008, OpenCV's version in three directions) at half the resolution, refined at
/// the full one: each disparity is compared with its neighbours up to two pixels away by sums of absolute
/// differences, at equal brightness of both images, in windows that follow the disparities found, and the minimum is
/// interpolated by two lines of equal slope (Shimizu and Okutomi 2001). Disparities are searched up to the largest that
/// an eighth of the resolution shows, and also beside the left border, where OpenCV's version has none. No disparity
/// where the minimum lies at the end of this range or is not distinct, and where another pixel matches the same pixel
/// of the right image better.
class SemiGlobalStereo final : public DenseStereo {
 public:
  /// `max_disparity`: [px]; larger disparities are not searched.
  SemiGlobalStereo(double max_disparity, int width);

  void match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity) override;

 private:
  /// The number of disparities to be searched at half the resolution.
  int needed_disparities();
  /// OpenCV has no disparity in the first columns, as many as it searches disparities: both images get as many more.
  void match_padded(cv::StereoSGBM& matcher, const cv::Mat& left, const cv::Mat& right, int disparities,
                    cv::Mat& result);
  /// Median difference of the brightness of both images, left minus right, at the matches of half the resolution:
  /// exposures differ.
  int brightness_difference() const;
  void refine(cv::Mat& disparity);
  /// Copies a row of refined_ but for what another pixel hides in the right image.
  void remove_occluded(int columns, float* disparity);

  int disparities_;  ///< largest number at half the resolution
  cv::Ptr<cv::StereoSGBM> matcher_, coarse_matcher_;
  cv::Mat quarter_, coarse_left_, coarse_right_, coarse_disparity_;
  cv::Mat padded_left_, padded_right_, padded_disparity_;
  cv::Mat half_left_, half_right_, half_disparity_;  // the last one 16SC1 [1/16 px]
  cv::Mat right_;                                    // 8UC1, of the mean of the left image
  WindowCosts costs_;
  // Of a row: the disparity at half the resolution, the least sum of differences, the refined disparity, that of the
  // pixel that the right image shows, and the column in the right image; by column of the right image the least sum and
  // the column of the left image that has it.
  std::vector<std::int16_t> found_, least_;
  std::vector<float> refined_, shown_;
  std::vector<int> places_;
  std::vector<std::uint32_t> best_;
};

}  // namespace holdfast
