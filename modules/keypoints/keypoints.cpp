// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/keypoints/keypoints.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <opencv2/core.hpp>

#include "holdfast/core/check.hpp"

namespace holdfast::keypoints {

bool find_keypoints(cv::Feature2D& extractor, const cv::Mat& grey, const cv::Mat& ignore, cv::Mat& mask,
                    std::vector<cv::KeyPoint>& keypoints, cv::Mat& descriptors) {
  HOLDFAST_CHECK(grey.empty() || grey.type() == CV_8UC1, "image type " << grey.type() << ", expected 8UC1");
  HOLDFAST_CHECK(ignore.empty() || (ignore.type() == CV_8UC1 && ignore.size() == grey.size()),
                 "mask " << ignore.cols << " x " << ignore.rows << " type " << ignore.type() << ", image " << grey.cols
                         << " x " << grey.rows);
  constexpr int smallest_image = 32;
  keypoints.clear();
  if (std::min(grey.cols, grey.rows) < smallest_image) return false;
  mask.release();
  if (!ignore.empty()) cv::compare(ignore, 0, mask, cv::CMP_EQ);
  extractor.detectAndCompute(grey, mask, keypoints, descriptors);
  return !keypoints.empty();
}

std::vector<std::uint32_t> strongest_keypoints(const std::vector<cv::KeyPoint>& keypoints, std::size_t count) {
  std::vector<std::uint32_t> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0U);
  if (order.size() <= count) return order;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keypoints[a].response > keypoints[b].response; });
  order.resize(count);
  std::sort(order.begin(), order.end());
  return order;
}

void copy_keypoints(const std::vector<cv::KeyPoint>& keypoints, Features& out) {
  out.resize(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::KeyPoint& keypoint = keypoints[i];
    out.x[i] = keypoint.pt.x;
    out.y[i] = keypoint.pt.y;
    const bool has_angle = keypoint.angle >= 0.0F && keypoint.angle < 360.0F;  // OpenCV writes 360 as well, and -1
    out.angle[i] = has_angle ? keypoint.angle * (std::numbers::pi_v<float> / 180.0F) : 0.0F;
    out.response[i] = keypoint.response;
    out.octave[i] = 0;
  }
}

}  // namespace holdfast::keypoints
