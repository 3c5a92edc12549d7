// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation_picture.hpp"

#include <array>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace holdfast {

namespace {

/// Of Okabe and Ito (2008), blue green red, vermilion first.
constexpr std::array<std::array<int, 3>, 6> label_palette = {
    {{0, 94, 213}, {178, 114, 0}, {115, 158, 0}, {0, 159, 230}, {167, 121, 204}, {233, 180, 86}}};
constexpr int unknown_label = 255;

cv::Scalar label_colour(int label) {
  if (label == unknown_label) return {128, 128, 128};
  const auto& colour = label_palette[static_cast<std::size_t>(label - 1) % label_palette.size()];
  return {static_cast<double>(colour[0]), static_cast<double>(colour[1]), static_cast<double>(colour[2])};
}

}  // namespace

cv::Mat segmentation_picture(const cv::Mat& colour, const Segmentation& segmentation,
                             const std::vector<std::string>& classes) {
  cv::Mat painted = colour.clone();
  for (int label = 1; label <= unknown_label; ++label) {
    const cv::Mat mask = segmentation.labels == label;
    if (cv::countNonZero(mask) > 0) painted.setTo(label_colour(label), mask);
  }
  cv::Mat picture;
  cv::addWeighted(colour, 0.45, painted, 0.55, 0.0, picture);
  for (const Instance& instance : segmentation.found) {
    const cv::Rect box = instance.box;
    char score[16];
    std::snprintf(score, sizeof(score), " %.2f", static_cast<double>(instance.score));
    const std::string text = (instance.label < classes.size() ? classes[instance.label] : std::string()) + score;
    cv::rectangle(picture, box, label_colour(instance.label), 2);
    const cv::Point place(box.x + 3, std::max(14, box.y + 14));
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  }
  return picture;
}

}  // namespace holdfast
