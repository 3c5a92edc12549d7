// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/coarse_view.hpp"

#include <cmath>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

Eigen::Isometry3d CoarseView::T_view_world(const Eigen::Isometry3d& T_camera_world) const {
  return T_view_camera * T_camera_world;
}

CoarseSampler::CoarseSampler(const Camera& camera) : width_(camera.width), height_(camera.height) {
  Eigen::Vector2d minimum, maximum;
  camera.undistorted_bounds(minimum, maximum);
  grid_.left = static_cast<float>(minimum.x() - 0.5);
  grid_.top = static_cast<float>(minimum.y() - 0.5);
  const auto cells = [](double extent) { return static_cast<int>(std::ceil((extent + 1.0) / CoarseGrid::step)); };
  grid_.columns = cells(maximum.x() - minimum.x());
  grid_.rows = cells(maximum.y() - minimum.y());
  raw_.reserve(static_cast<std::size_t>(grid_.size()));
  for (int row = 0; row < grid_.rows; ++row)
    for (int column = 0; column < grid_.columns; ++column) {
      const Eigen::Vector2d raw = camera.distort({grid_.x_of(column), grid_.y_of(row)});
      const int x = static_cast<int>(std::lround(raw.x())), y = static_cast<int>(std::lround(raw.y()));
      raw_.push_back(x < 0 || y < 0 || x >= width_ || y >= height_ ? -1 : y * width_ + x);
    }
}

void CoarseSampler::sample_depth(const cv::Mat& depth, CoarseView& view) const {
  view.grid = grid_;
  view.T_view_camera.setIdentity();
  view.static_log_odds.clear();
  view.mask.clear();
  view.depth.assign(raw_.size(), 0.0F);
  if (depth.empty()) return;
  HOLDFAST_CHECK(depth.type() == CV_32FC1 && depth.cols == width_ && depth.rows == height_,
                 depth.cols << "x" << depth.rows << ", type " << depth.type());
  const cv::Mat continuous = depth.isContinuous() ? depth : depth.clone();
  const float* values = continuous.ptr<float>();
  // Where depths are missing, mispredicted branches keep the processor from loading ahead by itself.
  constexpr std::size_t ahead = 40;
  for (std::size_t i = 0; i < raw_.size(); ++i) {
    if (i + ahead < raw_.size()) __builtin_prefetch(values + std::max(raw_[i + ahead], 0));
    if (raw_[i] < 0) continue;
    const float value = values[raw_[i]];
    view.depth[i] = is_measured_depth(value) ? value : measured_beside(values, raw_[i]);
  }
}

float CoarseSampler::measured_beside(const float* depth, std::int32_t pixel) const {
  const int x = pixel % width_, y = pixel / width_;
  if (x > 0 && is_measured_depth(depth[pixel - 1])) return depth[pixel - 1];
  if (x + 1 < width_ && is_measured_depth(depth[pixel + 1])) return depth[pixel + 1];
  if (y > 0 && is_measured_depth(depth[pixel - width_])) return depth[pixel - width_];
  if (y + 1 < height_ && is_measured_depth(depth[pixel + width_])) return depth[pixel + width_];
  return 0.0F;
}

void CoarseSampler::sample_labels(const cv::Mat& labels, std::uint8_t outside, std::vector<std::uint8_t>& cells) const {
  HOLDFAST_CHECK(labels.type() == CV_8UC1 && labels.cols == width_ && labels.rows == height_,
                 labels.cols << "x" << labels.rows << ", type " << labels.type());
  cells.resize(raw_.size());
  for (std::size_t i = 0; i < raw_.size(); ++i)
    cells[i] = raw_[i] < 0 ? outside : labels.ptr<std::uint8_t>(raw_[i] / width_)[raw_[i] % width_];
}

cv::Mat CoarseSampler::pixels_of(const std::vector<std::uint8_t>& marked) const {
  constexpr int half = CoarseGrid::step / 2;
  cv::Mat pixels;
  const auto is_marked = [&](std::size_t cell) { return marked[cell] != 0 && raw_[cell] >= 0; };
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (!is_marked(i)) continue;
    if (pixels.empty()) pixels = cv::Mat::zeros(height_, width_, CV_8UC1);
    // The squares of cells beside each other are filled together where they meet in one row of the image.
    const int y = raw_[i] / width_, first = raw_[i] - y * width_;
    int last = first;
    for (; i + 1 < marked.size() && is_marked(i + 1); ++i) {
      const int next = raw_[i + 1] - y * width_;
      if (next < last || next > std::min(last + 2 * half + 1, width_ - 1)) break;
      last = next;
    }
    const int left = std::max(0, first - half), width = std::min(width_ - 1, last + half) - left + 1;
    for (int row = std::max(0, y - half); row <= std::min(height_ - 1, y + half); ++row)
      std::fill_n(pixels.ptr<std::uint8_t>(row) + left, width, std::uint8_t{255});
  }
  return pixels;
}

}  // namespace holdfast
