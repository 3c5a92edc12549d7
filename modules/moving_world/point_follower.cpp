// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/point_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace holdfast {

namespace {

constexpr int levels = 2;  // above the half resolution: at the top, a pixel is eight of the image
const cv::Size window(9, 9);

float depth_at(const Frame& frame, float x, float y) {
  const int cell = frame.coarse.grid.cell_of(x, y);
  return cell < 0 || frame.coarse.empty() ? 0.0F : frame.coarse.depth[static_cast<std::size_t>(cell)];
}

void undistort(const Frame& frame, float raw_x, float raw_y, float& x, float& y) {
  if (frame.camera->distortion.is_zero()) {
    x = raw_x, y = raw_y;
    return;
  }
  const Eigen::Vector2d pixel = frame.camera->undistort({raw_x, raw_y});
  x = static_cast<float>(pixel.x()), y = static_cast<float>(pixel.y());
}

}  // namespace

void PointFollower::advance(const cv::Mat& grey, const Frame& frame) {
  cv::resize(grey, half_, cv::Size(grey.cols / 2, grey.rows / 2), 0, 0, cv::INTER_AREA);
  std::swap(pyramid_, previous_pyramid_);
  cv::buildOpticalFlowPyramid(half_, pyramid_, window, levels, true, cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT,
                              false);
  if (points_.size() == 0) return;

  const std::size_t count = points_.size();
  before_.resize(count), after_.resize(count), step_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    before_[i] = {(points_.raw_x[i] - 0.5F) * 0.5F, (points_.raw_y[i] - 0.5F) * 0.5F};
    after_[i] = before_[i] + step_[i];
  }
  cv::calcOpticalFlowPyrLK(previous_pyramid_, pyramid_, before_, after_, found_, error_, window, levels,
                           cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 10, 0.05),
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  for (std::size_t i = 0; i < count; ++i) {
    if (found_[i] == 0) continue;
    constexpr float largest_error = 25.0F;  // mean grey level
    const float raw_x = after_[i].x * 2.0F + 0.5F, raw_y = after_[i].y * 2.0F + 0.5F;
    const bool inside = raw_x >= 0.0F && raw_y >= 0.0F && raw_x <= static_cast<float>(grey.cols - 1) &&
                        raw_y <= static_cast<float>(grey.rows - 1);
    found_[i] = inside && error_[i] < largest_error ? 1 : 0;
    if (found_[i] == 0) continue;
    step_[i] = after_[i] - before_[i];
    points_.raw_x[i] = raw_x, points_.raw_y[i] = raw_y;
    undistort(frame, raw_x, raw_y, points_.x[i], points_.y[i]);
    const float depth = depth_at(frame, points_.x[i], points_.y[i]);
    // A point that jumps in depth slid off its object.
    if (depth > 0.0F && points_.depth[i] > 0.0F && std::abs(depth - points_.depth[i]) > 0.1F + 0.05F * depth)
      found_[i] = 0;
    if (depth > 0.0F) points_.depth[i] = depth;
  }
  compact(found_);
}

void PointFollower::add(const Frame& frame, float raw_x, float raw_y, std::uint8_t label) {
  float x = 0.0F, y = 0.0F;
  undistort(frame, raw_x, raw_y, x, y);
  points_.id.push_back(next_id_++);
  points_.raw_x.push_back(raw_x), points_.raw_y.push_back(raw_y);
  points_.x.push_back(x), points_.y.push_back(y);
  points_.depth.push_back(depth_at(frame, x, y));
  points_.label.push_back(label);
  step_.resize(points_.size() - 1);
  step_.emplace_back(0.0F, 0.0F);
}

void PointFollower::compact(const std::vector<std::uint8_t>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (keep[i] == 0) continue;
    points_.id[kept] = points_.id[i];
    points_.raw_x[kept] = points_.raw_x[i], points_.raw_y[kept] = points_.raw_y[i];
    points_.x[kept] = points_.x[i], points_.y[kept] = points_.y[i];
    points_.depth[kept] = points_.depth[i];
    points_.label[kept] = points_.label[i];
    step_[kept] = step_[i];
    ++kept;
  }
  points_.id.resize(kept);
  for (std::vector<float>* values : {&points_.raw_x, &points_.raw_y, &points_.x, &points_.y, &points_.depth})
    values->resize(kept);
  points_.label.resize(kept);
  step_.resize(kept);
}

}  // namespace holdfast
