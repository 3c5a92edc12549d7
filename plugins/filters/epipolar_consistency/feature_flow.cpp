// SPDX-License-Identifier: BSD-3-Clause
#include "feature_flow.hpp"

#include <cmath>
#include <utility>

namespace holdfast::epipolar_consistency_plugin {

namespace {
constexpr double longest_pause = 0.25;  // s
constexpr float max_return = 1.0F;      // px
// A larger difference: another surface, or covered.
constexpr PointFlowSettings flow_settings{.iterations = 6, .precision = 0.03F, .largest_difference = 12.0F};
}  // namespace

void FeatureFlow::add_image(const cv::Mat& colour, double timestamp) {
  if (!pyramids_.empty() && !(std::abs(timestamp - timestamp_) <= longest_pause)) pyramids_.clear();
  timestamp_ = timestamp;
  ImagePyramid pyramid;
  if (pyramids_.size() > gap_) pyramid = std::move(pyramids_.front()), pyramids_.pop_front();
  pyramid.build(colour);
  pyramids_.push_back(std::move(pyramid));
}

void FeatureFlow::follow(const Features& features, const std::vector<std::uint32_t>& chosen) {
  flow_.resize(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    flow_.from_x[k] = flow_.to_x[k] = features.x[chosen[k]];
    flow_.from_y[k] = flow_.to_y[k] = features.y[chosen[k]];
  }
  follow_points(pyramids_.back(), pyramids_.front(), flow_settings, flow_);
}

void FeatureFlow::check_back(const std::vector<std::uint32_t>& places) {
  back_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    back_.from_x[i] = back_.to_x[i] = flow_.to_x[places[i]];
    back_.from_y[i] = back_.to_y[i] = flow_.to_y[places[i]];
  }
  follow_points(pyramids_.front(), pyramids_.back(), flow_settings, back_);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float apart = std::hypot(back_.to_x[i] - flow_.from_x[places[i]], back_.to_y[i] - flow_.from_y[places[i]]);
    if (back_.found[i] == 0 || apart > max_return) flow_.found[places[i]] = 0;
  }
}

}  // namespace holdfast::epipolar_consistency_plugin
