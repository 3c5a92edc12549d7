// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/point_follower.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/depth_noise.hpp"

namespace holdfast {

namespace {

constexpr PointFlowSettings flow_settings{.iterations = 10, .precision = 0.05F, .largest_difference = 25.0F};

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
  std::swap(image_, last_image_);
  image_.build(grey);
  if (points_.size() == 0) return;

  const std::size_t count = points_.size();
  flow_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    flow_.from_x[i] = points_.raw_x[i], flow_.from_y[i] = points_.raw_y[i];
    flow_.to_x[i] = points_.raw_x[i] + step_x_[i], flow_.to_y[i] = points_.raw_y[i] + step_y_[i];
  }
  follow_points(last_image_, image_, flow_settings, flow_);
  for (std::size_t i = 0; i < count; ++i) {
    if (flow_.found[i] == 0) continue;
    step_x_[i] = flow_.to_x[i] - flow_.from_x[i], step_y_[i] = flow_.to_y[i] - flow_.from_y[i];
    points_.raw_x[i] = flow_.to_x[i], points_.raw_y[i] = flow_.to_y[i];
    undistort(frame, flow_.to_x[i], flow_.to_y[i], points_.x[i], points_.y[i]);
    const float depth = depth_at(frame, points_.x[i], points_.y[i]);
    // A point whose depth jumps has slipped off its object.
    if (depth > 0.0F && points_.depth[i] > 0.0F && std::abs(depth - points_.depth[i]) > depth_noise::slid_off(depth))
      flow_.found[i] = 0;
    if (depth > 0.0F) points_.depth[i] = depth;
  }
  compact(flow_.found);
}

void PointFollower::add(const Frame& frame, float raw_x, float raw_y, std::uint8_t label) {
  float x = 0.0F, y = 0.0F;
  undistort(frame, raw_x, raw_y, x, y);
  points_.id.push_back(next_id_++);
  points_.raw_x.push_back(raw_x), points_.raw_y.push_back(raw_y);
  points_.x.push_back(x), points_.y.push_back(y);
  points_.depth.push_back(depth_at(frame, x, y));
  points_.label.push_back(label);
  step_x_.push_back(0.0F), step_y_.push_back(0.0F);
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
    step_x_[kept] = step_x_[i], step_y_[kept] = step_y_[i];
    ++kept;
  }
  points_.id.resize(kept);
  for (std::vector<float>* values :
       {&points_.raw_x, &points_.raw_y, &points_.x, &points_.y, &points_.depth, &step_x_, &step_y_})
    values->resize(kept);
  points_.label.resize(kept);
}

}  // namespace holdfast
