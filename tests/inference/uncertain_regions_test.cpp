// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/uncertain_regions.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {
namespace {

/// Two regions of label 1, which touch nowhere: columns 1 to 3 with one certain pixel, columns 6 and 7 without. Label 2
/// in the last row.
Segmentation two_regions() {
  Segmentation result{cv::Mat::zeros(6, 9, CV_8UC1), cv::Mat(6, 9, CV_8UC1, cv::Scalar(140))};
  result.labels(cv::Range(0, 5), cv::Range(1, 4)).setTo(1);
  result.labels(cv::Range(0, 5), cv::Range(6, 8)).setTo(1);
  result.labels.row(5).setTo(2);
  result.confidence.at<std::uint8_t>(2, 2) = 204;
  return result;
}

TEST(UncertainRegions, OneCertainPixelKeepsItsRegion) {
  const Segmentation before = two_regions();
  Segmentation after = two_regions();
  drop_uncertain_regions(after, 1, 204);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 9; ++x) {
      const bool dropped = y < 5 && x >= 6 && x < 8;
      EXPECT_EQ(after.labels.at<std::uint8_t>(y, x), dropped ? 0 : before.labels.at<std::uint8_t>(y, x))
          << y << ' ' << x;
      EXPECT_EQ(after.confidence.at<std::uint8_t>(y, x), dropped ? 0 : before.confidence.at<std::uint8_t>(y, x));
    }
  drop_uncertain_regions(after, 1, 205);
  EXPECT_EQ(cv::countNonZero(after.labels == 1), 0);
  EXPECT_EQ(cv::countNonZero(after.labels == 2), 9) << "other labels stay";
}

TEST(UncertainRegions, CornersConnect) {
  Segmentation result{cv::Mat::eye(4, 4, CV_8UC1), cv::Mat(4, 4, CV_8UC1, cv::Scalar(100))};
  result.confidence.at<std::uint8_t>(3, 3) = 200;
  drop_uncertain_regions(result, 1, 150);
  EXPECT_EQ(cv::countNonZero(result.labels), 4);
}

TEST(UncertainRegions, WithoutConfidenceNothingIsUncertain) {
  Segmentation result{cv::Mat::ones(4, 4, CV_8UC1), {}};
  drop_uncertain_regions(result, 1, 255);
  EXPECT_EQ(cv::countNonZero(result.labels), 16);
}

}  // namespace
}  // namespace holdfast
