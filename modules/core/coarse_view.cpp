// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/coarse_view.hpp"

#include <cmath>

#include "holdfast/core/error.hpp"

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
  for (std::size_t i = 0; i < raw_.size(); ++i) {
    if (raw_[i] < 0) continue;
    const int x = raw_[i] % width_, y = raw_[i] / width_;
    const auto value_at = [&](int column, int row) {
      if (column < 0 || row < 0 || column >= width_ || row >= height_) return 0.0F;
      const float value = depth.ptr<float>(row)[column];
      return value > 0.0F && std::isfinite(value) ? value : 0.0F;
    };
    float value = value_at(x, y);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (value > 0.0F) break;
      value = value_at(x + dx, y + dy);
    }
    view.depth[i] = value;
  }
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
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i] == 0 || raw_[i] < 0) continue;
    if (pixels.empty()) pixels = cv::Mat::zeros(height_, width_, CV_8UC1);
    const int x = raw_[i] % width_, y = raw_[i] / width_;
    for (int row = std::max(0, y - half); row <= std::min(height_ - 1, y + half); ++row)
      std::fill_n(pixels.ptr<std::uint8_t>(row) + std::max(0, x - half),
                  std::min(width_ - 1, x + half) - std::max(0, x - half) + 1, std::uint8_t{255});
  }
  return pixels;
}

}  // namespace holdfast
