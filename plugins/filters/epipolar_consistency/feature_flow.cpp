// SPDX-License-Identifier: BSD-3-Clause
#include "feature_flow.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>

namespace holdfast::epipolar_consistency_plugin {

namespace {
constexpr double longest_pause = 0.25;  // s
constexpr int top_level = 2;
constexpr float max_difference = 12.0F;  // grey levels, mean over the window: another surface, or covered
constexpr float max_return = 0.5F;       // px of the half image
const cv::Size window(9, 9);
const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 6, 0.03);

cv::Point2f halved(float x, float y) { return {0.5F * x - 0.25F, 0.5F * y - 0.25F}; }
float doubled(float value) { return 2.0F * value + 0.5F; }
}  // namespace

bool FeatureFlow::can_follow(const cv::Mat& colour) {
  return colour.cols >= 2 * window.width && colour.rows >= 2 * window.height;
}

void FeatureFlow::add_image(const cv::Mat& colour, double timestamp) {
  if (!pyramids_.empty() && !(std::abs(timestamp - timestamp_) <= longest_pause)) pyramids_.clear();
  timestamp_ = timestamp;
  Pyramid pyramid;
  if (pyramids_.size() > gap_) pyramid = std::move(pyramids_.front()), pyramids_.pop_front();
  cv::resize(colour, half_, cv::Size(colour.cols / 2, colour.rows / 2), 0, 0, cv::INTER_AREA);
  if (half_.channels() == 3)
    cv::cvtColor(half_, grey_, cv::COLOR_BGR2GRAY);
  else
    half_.copyTo(grey_);
  cv::buildOpticalFlowPyramid(grey_, pyramid, window, top_level, /*withDerivatives=*/true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, /*tryReuseInputImage=*/false);
  pyramids_.push_back(std::move(pyramid));
}

void FeatureFlow::follow(const Features& features, const std::vector<std::uint32_t>& chosen) {
  now_.resize(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) now_[k] = halved(features.x[chosen[k]], features.y[chosen[k]]);
  before_x.resize(chosen.size()), before_y.resize(chosen.size()), found.assign(chosen.size(), 0);
  if (chosen.empty()) return;
  cv::calcOpticalFlowPyrLK(pyramids_.back(), pyramids_.front(), now_, before_, status_, difference_, window, top_level,
                           stop);
  const cv::Size size = pyramids_.back()[0].size();
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const cv::Point2f& at = before_[k];
    const bool inside = at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(size.width - 1) &&
                        at.y <= static_cast<float>(size.height - 1);
    found[k] = status_[k] != 0 && inside && difference_[k] <= max_difference ? 1 : 0;
    before_x[k] = doubled(at.x), before_y[k] = doubled(at.y);
  }
}

void FeatureFlow::check_back(const std::vector<std::uint32_t>& places) {
  if (places.empty()) return;
  back_from_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) back_from_[i] = before_[places[i]];
  cv::calcOpticalFlowPyrLK(pyramids_.front(), pyramids_.back(), back_from_, back_to_, status_, difference_, window,
                           top_level, stop);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const cv::Point2f apart = back_to_[i] - now_[places[i]];
    if (status_[i] == 0 || std::hypot(apart.x, apart.y) > max_return) found[places[i]] = 0;
  }
}

}  // namespace holdfast::epipolar_consistency_plugin
